"""The report in words and figures: the verdict is a sentence, numbers have units and plain digits."""

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.leftover import Forces, motion_variables
from swamp_rl.criticism.report.figures import DEGREES, accused_thrusters, labelled, shown_variables
from swamp_rl.criticism.report.page import (
    details,
    gain_rows,
    gained,
    lacking,
    left_over,
    named,
    table,
    told_apart,
)
from swamp_rl.criticism.report.words import (
    cause_rows,
    gain_sentence,
    headline,
    leftover_sentence,
    meaning,
    number_cells,
    rounded,
    spoken,
    trial_words,
    unseen_of,
    wandering_sentence,
    written,
)
from swamp_rl.criticism.result import Cause, Contrast, Diagnosis, Estimate, Gain, Leftover, Paired, Point

pytestmark = pytest.mark.numerical


def diagnosis(verdict: str, **changes: object) -> Diagnosis:
    """One without anything else in it."""
    empty = ("causes", "indistinguishable", "contrasts", "leftover", "candidates", "unseen", "gain")
    values: dict[str, object] = {name: [] for name in empty}
    values |= {"separating_trial": None, "noise": {}, "adequacy": {}, "elapsed_s": 1.0}
    return Diagnosis.model_validate(values | {"verdict": verdict} | changes)


OFFSET = Cause(
    effect="azimuth_offset",
    thruster="bs",
    parameters={"offset": Estimate(value=0.2, standard_error=0.01, unit="rad")},
)
LAG = Cause(
    effect="azimuth_lag",
    parameters={"time_constant": Estimate(value=0.612, standard_error=0.012, unit="s")},
)


def test_labels_are_spoken_with_their_thrusters() -> None:
    assert spoken("azimuth_lag + thruster_gain bs + channel_swap bp ss") == (
        "azimuth lag, thruster gain (bs) and channel swap (bp, ss)"
    )


@pytest.mark.parametrize(
    ("verdict", "changes", "told"),
    [
        ("nothing_wrong", {}, "residuals are measurement noise"),
        ("cause", {"causes": [OFFSET]}, "lacks one effect: azimuth offset (bs)"),
        ("cause", {"causes": [OFFSET, LAG]}, "lacks 2 effects: azimuth offset (bs) and azimuth lag"),
        (
            "indistinguishable",
            {"indistinguishable": [["mass", "linear_drag"]]},
            "to one effect: mass or linear drag",
        ),
        (
            "indistinguishable",
            {"indistinguishable": [["mass", "wind", "current"]]},
            "to one of 3 effects: mass, wind or current",
        ),
        ("unexplained", {}, "not explained by any effect"),
    ],
)
def test_every_verdict_is_a_sentence(verdict: str, changes: dict[str, object], told: str) -> None:
    assert told in headline(diagnosis(verdict, **changes))


def test_a_cause_has_its_interval_in_degrees_beside_what_the_boat_file_has() -> None:
    rows = cause_rows([OFFSET, LAG], load_boat("swamp"))
    assert rows[0][0] == "azimuth offset (bs)"
    assert rows[0][2:] == ("offset", "11.5", "10.3 to 12.6", "degrees", "0")
    assert rows[1][2:] == ("time constant", "0.612", "0.588 to 0.636", "s", "0.1")


def test_a_number_at_a_bound_of_the_fit_has_no_interval() -> None:
    slow = Estimate(value=4.0, standard_error=0.2, unit="s", at_bound=True, limit="at_least")
    turned = Estimate(value=-1.6, standard_error=0.1, unit="rad", at_bound=True, limit="at_most")
    cause = Cause(effect="pump_lag", parameters={"time_constant": slow})
    assert "may be a substitute for another" in meaning(diagnosis("cause", causes=[cause]))
    assert "substitute" not in meaning(diagnosis("cause", causes=[OFFSET, LAG]))
    either = Estimate(value=0.5, standard_error=0.1, unit="1", at_bound=True)
    assert number_cells(slow) == ("4", "at the bound of the fit: at least 4", "s")
    assert number_cells(turned) == ("−91.7", "at the bound of the fit: at most −91.7", "degrees")
    assert number_cells(either)[1] == "at the bound of the fit, no interval"


def test_the_gain_is_in_degrees_with_as_many_digits_as_the_error_and_no_negative_zero() -> None:
    paired = Paired(before=0.1, after=0.05, ci95=(-1e-9, 0.1))
    (row,) = gain_rows(Gain(horizon_s=5.0, restarts=9, blocks="runs", heading_rmse_rad=paired))
    assert row == ("5 (9)", "heading", "5.73", "2.86", "2.86 (0.00 to 5.73)", "degrees")


def test_what_is_left_is_said_with_its_force_and_variable() -> None:
    left = [Leftover(force="yaw", variable="heading", explained=0.62)]
    said = leftover_sentence(diagnosis("unexplained", leftover=left))
    assert "yaw moment as a function of heading" in said and "62%" in said


def test_the_shape_of_a_missing_force_is_shown_beside_what_it_was_told_beside() -> None:
    curve = [Point(at=0.0, force=-1.0, standard_error=0.1), Point(at=0.5, force=0.0, standard_error=0.1)]
    left = [Leftover(force="yaw", variable="yaw rate", explained=0.6, curve=curve, beside=["sway_drag"])]
    shown = left_over(diagnosis("unexplained", leftover=left), {"missing": "aGk="})
    assert "that the boat file with sway drag lacks" in shown and 'base64,aGk="' in shown
    plain = left_over(
        diagnosis("unexplained", leftover=[Leftover(force="yaw", variable="time", explained=1)]), {}
    )
    assert "Estimates from all runs" not in plain


@pytest.mark.parametrize(
    ("variable", "label", "factor"),
    [
        ("yaw rate", "yaw rate [°/s]", DEGREES),
        ("position east", "position east [m]", 1.0),
        ("azimuth bs", "azimuth bs [°]", DEGREES),
        ("throttle main", "throttle main [of full]", 1.0),
    ],
)
def test_what_forces_are_drawn_against_has_its_unit(variable: str, label: str, factor: float) -> None:
    assert labelled(variable) == (label, factor)


@pytest.mark.parametrize(
    ("found", "drawn"), [([], "bp"), ([OFFSET], "bs"), ([LAG], "bp")], ids=["nothing", "bs", "all thrusters"]
)
def test_forces_are_drawn_against_the_thruster_that_is_accused(found: list[Cause], drawn: str) -> None:
    time = np.linspace(0.0, 1.0, 5)
    every = {f"{what} {name}": time for what in ("azimuth", "throttle") for name in ("bs", "bp")}
    every |= {"azimuth bp": 2.0 * time, "throttle bp": 2.0 * time}  # used most
    forces = Forces(np.zeros((5, 5)), np.zeros((5, 5)), np.zeros(5, int), every)
    accused = accused_thrusters(diagnosis("cause", causes=found))
    assert list(shown_variables(trials(), forces, accused)) == [f"throttle {drawn}", f"azimuth {drawn}"]


def test_data_without_noise_are_not_said_to_have_some() -> None:
    text = details(diagnosis("nothing_wrong", noise={"north": 2e-3, "heading": 0.01}), trials())
    assert ">below 0.00200</td>" in text and ">0.573</td>" in text


def test_every_variable_that_a_force_may_go_with_can_be_drawn() -> None:
    for variable in motion_variables(np.zeros(1), np.zeros((1, 6))):
        assert labelled(variable)[0].startswith(variable)


def test_digits_are_plain_and_cells_are_escaped() -> None:
    assert [rounded(v) for v in (1234.5, 0.01234, 0.0, 5.0e-7)] == ["1234", "0.0123", "0", "0.00000"]
    assert "&lt;b&gt;" in table(("a",), [("<b>",)]) and "<b>" in table(("a",), [("<b>",)], raw=True)


def test_what_cannot_be_seen_is_told_by_effect_with_the_thrusters_it_holds_of() -> None:
    pairs = ["bs bp", "bs ss", "bs sp", "bp ss", "bp sp", "ss sp"]
    unseen = ["azimuth_lag", *(f"channel_swap {pair}" for pair in pairs), "thruster_failure bp", "mass"]
    told = unseen_of(diagnosis("cause", unseen=unseen), load_boat("swamp"))
    assert told == "azimuth lag, channel swap, thruster failure (bp), mass"
    some = unseen_of(
        diagnosis("cause", unseen=["channel_swap bs bp", "channel_swap ss sp"]), load_boat("swamp")
    )
    assert some == "channel swap (bs and bp, ss and sp)"


def test_the_page_says_what_was_held_out_and_what_to_record() -> None:
    paired = Paired(before=0.1, after=0.05, ci95=(0.01, 0.1))
    gain = Gain(horizon_s=10.0, restarts=9, blocks="runs", position_rmse_m=paired)
    found = diagnosis(
        "cause", causes=[LAG], gain=[gain], gain_on="same_run", missing_motion=["turns to port"]
    )
    assert "since there is no other: they are optimistic" in gained(found)
    assert "<li>turns to port</li>" in lacking(found, trials())
    best = diagnosis("indistinguishable", causes=[LAG], indistinguishable=[["mass", "azimuth_lag"]])
    assert "The explanation with the lowest χ²" in named(best, trials())


def trials() -> Trials:
    """Of SWAMP, with nothing in them."""
    return Trials(
        load_boat("swamp"), 0.1, (), np.zeros((0, 1, 8)), np.zeros((0, 1, 6)), np.zeros(0, np.int64)
    )


def test_an_unexplained_rest_is_told_with_a_variable_or_said_to_go_with_none() -> None:
    left = [Leftover(force="yaw", variable="heading", explained=0.62)]
    assert "function of heading" in left_over(diagnosis("unexplained", leftover=left), {})
    assert "are given below" in meaning(diagnosis("unexplained", leftover=left))
    assert "No single variable" in left_over(diagnosis("unexplained"), {})
    assert "are given below" not in meaning(diagnosis("unexplained"))
    assert left_over(diagnosis("nothing_wrong"), {}) == ""


@pytest.mark.parametrize(
    ("ci95", "said"), [((0.1, 0.3), ""), ((-0.1, 0.3), "not significant"), ((-0.4, -0.1), "10 s ahead worse")]
)
def test_a_gain_that_is_none_is_called_so(ci95: tuple[float, float], said: str) -> None:
    paired = Paired(before=1.0, after=0.9, ci95=ci95)
    gain = Gain(horizon_s=10.0, restarts=9, blocks="runs", position_rmse_m=paired)
    told = gain_sentence(diagnosis("cause", causes=[LAG], gain=[gain]))
    assert said in told and bool(told) == bool(said)


def test_units_are_written_as_one_does_and_stay_on_one_line() -> None:
    assert [written(unit) for unit in ("1", "m/s2", "N s/m")] == ["", "m/s²", "N\N{NO-BREAK SPACE}s/m"]


def test_errors_that_last_are_a_receivers_or_the_models_own() -> None:
    lasting = {"standard_deviation": 0.5, "time_constant_s": 21.0}
    assert "Gauss-Markov part (standard deviation): north 0.500 m; time constant 21 s" in (
        wandering_sentence(diagnosis("cause", wandering={"north": lasting}))
    )
    told = wandering_sentence(diagnosis("unexplained", wandering={"heading": lasting}))
    assert "correlated in time" in told and "heading 28.6 degrees" in told
    assert wandering_sentence(diagnosis("cause")) == ""


def test_rivals_stand_with_their_numbers() -> None:
    names = ["mass", "azimuth_lag"]
    contrast = Contrast(effects=names, angle=0.1, evidence=-2.0, mutual_refit=1.0, rival=[LAG])
    found = diagnosis("indistinguishable", indistinguishable=[names], contrasts=[contrast])
    told = told_apart(found, trials())
    assert "0.588 to 0.636" in told and "−2.0" in told


def test_a_trial_is_told_as_the_boat_can_sail_it() -> None:
    assert trial_words("spin", load_boat("swamp")).startswith("turning on the spot")
    assert trial_words("spin", load_boat("esso_osaka")).startswith("hard over (35°)")
    assert trial_words("zig-zag, 80 %", load_boat("swamp")) == "zig-zag, 80 %"

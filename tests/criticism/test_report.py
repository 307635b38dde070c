"""The report in words and figures: the verdict is a sentence, numbers have units and plain digits."""

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.residual_force import Forces
from swamp_rl.criticism.nuisance.force_functions import motion_variables
from swamp_rl.criticism.report.evidence import minor_sentence, smoothed_sentence
from swamp_rl.criticism.report.figures import DEGREES, labelled, shown_variables, thrusters_of_causes
from swamp_rl.criticism.report.page import (
    causes_section,
    details,
    gain_rows,
    gain_section,
    identifiability_section,
    limits_section,
    residual_section,
)
from swamp_rl.criticism.report.words import (
    cause_rows,
    effects_listed,
    files_sentence,
    gain_sentence,
    headline,
    in_file_names,
    manoeuvre_words,
    meaning,
    noise_sentence,
    number_cells,
    readable,
    residual_force_sentence,
    separating_sentence,
    written,
)
from swamp_rl.criticism.result import (
    Cause,
    Contrast,
    CurvePoint,
    Diagnosis,
    Estimate,
    Extension,
    Gain,
    HeldOut,
    Paired,
    ResidualForce,
    SmoothedNoise,
)
from swamp_rl.html_page import rounded, table

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


def test_the_terminal_has_the_files_names_and_the_scope_in_words() -> None:
    assert in_file_names("thruster_gain bs + wind by_run") == "thruster_gain bs + wind (another in each run)"


def test_labels_are_readable_and_have_their_thrusters() -> None:
    assert readable("azimuth_lag + thruster_gain bs + channel_swap bp ss") == (
        "azimuth lag, thruster gain (bs) and channel swap (bp, ss)"
    )


@pytest.mark.parametrize(
    ("verdict", "changes", "message"),
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
        ("unexplained", {"causes": [OFFSET]}, "explained in part by azimuth offset (bs)."),
    ],
)
def test_every_verdict_is_a_sentence(verdict: str, changes: dict[str, object], message: str) -> None:
    assert message in headline(diagnosis(verdict, **changes))


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


def test_the_interval_of_an_angle_is_at_most_the_whole_circle() -> None:
    assert number_cells(Estimate(value=0.1, standard_error=1.7, unit="rad"))[1] == "the whole circle"
    assert number_cells(Estimate(value=0.1, standard_error=1.5, unit="rad"))[1] == "−163 to 174"


def test_the_gain_is_in_degrees_with_as_many_digits_as_the_error_and_no_negative_zero() -> None:
    paired = Paired(before=0.1, after=0.05, ci95=(-1e-9, 0.1))
    (row,) = gain_rows(Gain(horizon_s=5.0, restarts=9, blocks="runs", heading_rmse_rad=paired))
    assert row == ("5 (9)", "heading", "5.73", "2.86", "2.86 (0.00 to 5.73)", "degrees")


def test_an_error_far_below_the_one_before_is_not_shown_as_zero() -> None:
    paired = Paired(before=17.1, after=0.0041, ci95=(7.8, 25.6))
    (row,) = gain_rows(Gain(horizon_s=30.0, restarts=9, blocks="runs", position_rmse_m=paired))
    assert row == ("30 (9)", "position", "17.1", "0.0041", "17.1 (7.8 to 25.6)", "m")


def test_the_residual_force_is_reported_with_its_variable() -> None:
    left = [ResidualForce(force="yaw", variable="heading", explained=0.62)]
    message = residual_force_sentence(diagnosis("unexplained", leftover=left))
    assert "yaw moment as a function of heading" in message and "62%" in message


def test_the_function_of_a_residual_force_is_shown_with_its_hypothesis() -> None:
    curve = [
        CurvePoint(at=0.0, force=-1.0, standard_error=0.1),
        CurvePoint(at=0.5, force=0.0, standard_error=0.1),
    ]
    left = [ResidualForce(force="yaw", variable="yaw rate", explained=0.6, curve=curve, beside=["sway_drag"])]
    shown = residual_section(diagnosis("unexplained", leftover=left), {"missing": "aGk="})
    assert "that the boat file with sway drag lacks" in shown and 'base64,aGk="' in shown
    plain = residual_section(
        diagnosis("unexplained", leftover=[ResidualForce(force="yaw", variable="time", explained=1)]), {}
    )
    assert "Estimates from all runs" not in plain


@pytest.mark.parametrize(
    ("boat", "variable", "label", "factor"),
    [
        ("swamp", "yaw rate", "yaw rate [°/s]", DEGREES),
        ("swamp", "position east", "position east [m]", 1.0),
        ("swamp", "azimuth bs", "azimuth bs [°]", DEGREES),
        ("swamp", "throttle bs", "throttle bs [of full]", 1.0),
        ("esso_osaka", "azimuth main", "rudder main [°]", DEGREES),
        ("esso_osaka", "rudder main", "rudder main [°]", DEGREES),
        ("esso_osaka", "throttle main", "propeller main [rps]", 1.0),
    ],
)
def test_what_forces_are_drawn_against_has_its_unit(
    boat: str, variable: str, label: str, factor: float
) -> None:
    assert labelled(variable, load_boat(boat)) == (label, factor)


@pytest.mark.parametrize(
    ("found", "drawn"), [([], "bp"), ([OFFSET], "bs"), ([LAG], "bp")], ids=["nothing", "bs", "all thrusters"]
)
def test_forces_are_drawn_against_the_thruster_of_the_cause(found: list[Cause], drawn: str) -> None:
    time = np.linspace(0.0, 1.0, 5)
    every = {f"{what} {name}": time for what in ("azimuth", "throttle") for name in ("bs", "bp")}
    every |= {"azimuth bp": 2.0 * time, "throttle bp": 2.0 * time}  # used most
    forces = Forces(np.zeros((5, 3)), every)
    preferred = thrusters_of_causes(diagnosis("cause", causes=found))
    assert list(shown_variables(no_runs(), forces, preferred)) == [f"throttle {drawn}", f"azimuth {drawn}"]


def test_data_without_noise_are_not_said_to_have_some() -> None:
    text = details(diagnosis("nothing_wrong", noise={"north": 2e-3, "heading": 0.01}), no_runs())
    assert ">below 0.00200</td>" in text and ">0.573</td>" in text


def test_the_noise_of_the_weights_is_reported_with_both_its_parts() -> None:
    text = details(diagnosis("nothing_wrong", noise={"north": 0.16}), no_runs())
    assert "white measurement noise, estimated from third differences" in text
    assert "the error of the simulator's step in whole runs" in text


def test_every_variable_of_a_force_can_be_drawn() -> None:
    for variable in motion_variables(np.zeros(1), np.zeros((1, 6))):
        assert labelled(variable, load_boat("swamp"))[0].startswith(variable)


def test_digits_are_plain_and_cells_are_escaped() -> None:
    assert [rounded(v) for v in (1234.5, 0.01234, 0.0, 5.0e-7)] == ["1234", "0.0123", "0", "0.00000"]
    assert "&lt;b&gt;" in table(("a",), [("<b>",)]) and "<b>" in table(("a",), [("<b>",)], raw=True)


def test_unidentifiable_effects_are_listed_with_their_thrusters() -> None:
    pairs = ["bs bp", "bs ss", "bs sp", "bp ss", "bp sp", "ss sp"]
    unseen = ["azimuth_lag", *(f"channel_swap {pair}" for pair in pairs), "thruster_failure bp", "mass"]
    message = effects_listed(unseen, load_boat("swamp"))
    assert message == "azimuth lag, channel swap, thruster failure (bp), mass"
    some = effects_listed(["channel_swap bs bp", "channel_swap ss sp"], load_boat("swamp"))
    assert some == "channel swap (bs and bp, ss and sp)"
    weather = ["wind by_run", "wind", "azimuth_offset bs", "thrust_sag by_day"]
    assert effects_listed(weather, load_boat("swamp")) == "wind, azimuth offset (bs), thrust sag"
    every = [f"azimuth_offset {place}" for place in ("ss", "bs", "bp", "sp", "all")]
    assert effects_listed(every, load_boat("swamp")) == "azimuth offset"
    alone = effects_listed(every[:-1], load_boat("swamp"))
    assert alone == "azimuth offset (ss, bs, bp, sp)"  # all together, it is identifiable


def test_a_boat_whose_causes_are_all_minor_is_not_called_without_any() -> None:
    assert "No model error is detectable" in headline(diagnosis("nothing_wrong"))
    assert "No model error matters" in headline(diagnosis("nothing_wrong", minor=[LAG]))


def test_what_the_errors_of_the_boat_file_allow_is_distinguished_from_what_changes_no_prediction() -> None:
    within = LAG.model_copy(update={"within_boat_errors": True})
    both = diagnosis("cause", minor=[LAG, within.model_copy(update={"effect": "mass"})])
    assert minor_sentence(both) == (
        "Significant, but minor: azimuth lag (below the noise, and below 2 % of every prediction error or by "
        "chance). "
        "Within the standard errors of the boat file's fitted numbers: mass."
    )
    alone = diagnosis("nothing_wrong", minor=[within])
    assert "may be an error of the boat file" in headline(alone) and "identify boat" in meaning(alone)


def test_the_page_tells_effects_that_the_data_cannot_show_from_those_below_the_models_error() -> None:
    found = diagnosis("unexplained", unseen=["azimuth_lag"], hidden=["mass", "current"])
    message = limits_section(found, no_runs())
    assert "from these data, whatever the model" in message and "typical size): azimuth lag." in message
    assert "below the error of this model: mass, current." in message
    assert "below the error" not in limits_section(diagnosis("cause", unseen=["mass"]), no_runs())


def test_the_report_counts_the_effects_without_a_number_that_were_fitted() -> None:
    tried = ["channel_swap bs bp", "channel_swap bs ss", "azimuth_reversed all"]
    message = meaning(diagnosis("unexplained", hypotheses=9, discrete=tried))
    assert "9 sets" in message and "the 3 without a number (channel swap, azimuth reversed)" in message
    assert "without a number" not in meaning(diagnosis("unexplained", hypotheses=9))


@pytest.mark.parametrize(
    ("separation", "message"),
    [
        (12.34, "separating manoeuvre: straight ahead, 100 % (12.3 standard errors apart)"),
        (
            0.01,
            "separating manoeuvre: none of those tried (0.0 standard errors apart at most)",
        ),
    ],
)
def test_a_manoeuvre_is_proposed_only_if_it_separates_the_explanations(
    separation: float, message: str
) -> None:
    trial = {"manoeuvre": "straight ahead, 100 %", "separation": separation, "duration_s": 60.0}
    found = diagnosis("indistinguishable", separating_trial=trial)
    assert separating_sentence(found) == message
    assert ("is proposed below" in meaning(found)) == (separation > 1.0)


def test_functions_of_the_residual_force_that_the_data_do_not_separate_are_named_together() -> None:
    first = ResidualForce(force="thrust of ss", variable="throttle ss", explained=0.6, gain=33.0)
    near = ResidualForce(force="thrust of bs", variable="throttle bs", explained=0.7, gain=32.0)
    far = ResidualForce(force="yaw", variable="heading", explained=0.2, gain=17.0)
    message = residual_force_sentence(diagnosis("unexplained", leftover=[first, near, far]))
    assert message.endswith("do not separate it from: thrust of bs against throttle bs.")
    assert "separate" not in residual_force_sentence(diagnosis("unexplained", leftover=[first, far]))


def test_a_smoothed_channel_is_reported_with_both_of_its_noises() -> None:
    north = SmoothedNoise(sample_noise=0.01, standard_deviation=0.06, time_constant_s=0.2)
    yaw_rate = SmoothedNoise(sample_noise=0.001, standard_deviation=0.01, time_constant_s=0.3)
    message = smoothed_sentence(diagnosis("cause", smoothed={"north": north, "yaw_rate": yaw_rate}))
    assert "north 0.01 m, weighted with 0.06 m (time constant 0.2 s)" in message
    assert "yaw rate 0.057 degrees/s, weighted with 0.57 degrees/s" in message
    assert smoothed_sentence(diagnosis("cause")) == ""


def test_the_page_says_what_was_held_out_and_what_to_record() -> None:
    paired = Paired(before=0.1, after=0.05, ci95=(0.01, 0.1))
    gain = Gain(horizon_s=10.0, restarts=9, blocks="runs", position_rmse_m=paired)
    found = diagnosis(
        "cause", causes=[LAG], gain=[gain], gain_on="same_run", missing_motion=["turns to port"]
    )
    assert "since there is no other: they are optimistic" in gain_section(found)
    assert "<li>turns to port</li>" in limits_section(found, no_runs())
    best = diagnosis("indistinguishable", causes=[LAG], indistinguishable=[["mass", "azimuth_lag"]])
    assert "The explanation with the lowest χ²" in causes_section(best, no_runs())


def test_causes_without_a_share_on_held_out_runs_have_no_empty_table() -> None:
    shown = causes_section(diagnosis("cause", causes=[LAG.model_copy(update={"share": []})]), no_runs())
    assert "differs between runs has no share" in shown and "None." not in shown


def no_runs() -> RunSet:
    """Of SWAMP, with nothing in them."""
    return RunSet(
        load_boat("swamp"), 0.1, (), np.zeros((0, 1, 8)), np.zeros((0, 1, 6)), np.zeros(0, np.int64)
    )


def test_the_residual_section_names_a_variable_or_says_that_there_is_none() -> None:
    left = [ResidualForce(force="yaw", variable="heading", explained=0.62)]
    assert "function of heading" in residual_section(diagnosis("unexplained", leftover=left), {})
    assert "are given below" in meaning(diagnosis("unexplained", leftover=left))
    assert "No single variable" in residual_section(diagnosis("unexplained"), {})
    assert "are given below" not in meaning(diagnosis("unexplained"))
    assert residual_section(diagnosis("nothing_wrong"), {}) == ""


@pytest.mark.parametrize(
    ("ci95", "text"), [((0.1, 0.3), ""), ((-0.1, 0.3), "not significant"), ((-0.4, -0.1), "10 s ahead worse")]
)
def test_an_insignificant_gain_is_reported_as_such(ci95: tuple[float, float], text: str) -> None:
    paired = Paired(before=1.0, after=0.9, ci95=ci95)
    gain = Gain(horizon_s=10.0, restarts=9, blocks="runs", position_rmse_m=paired)
    message = gain_sentence(diagnosis("cause", causes=[LAG], gain=[gain]))
    assert text in message and bool(message) == bool(text)


def test_the_error_with_a_missing_force_that_was_written_is_reported_without_a_cause_too() -> None:
    paired = Paired(before=1.0, after=2.0, ci95=(-1.2, -0.8))
    gain = Gain(horizon_s=10.0, restarts=9, blocks="runs", position_rmse_m=paired)
    force = Extension(curves=[], held_out=HeldOut(gain=9.0, low=1.0, level=0.95), written=True)
    message = gain_section(diagnosis("unexplained", extension=force, gain=[gain]))
    assert "1.00 → 2.00 m" in message and "10 s ahead worse" in message


def test_units_are_written_as_one_does_and_stay_on_one_line() -> None:
    assert [written(unit) for unit in ("1", "m/s2", "N s/m")] == ["", "m/s²", "N\N{NO-BREAK SPACE}s/m"]


def test_correlated_errors_are_attributed_to_the_receiver_or_the_model() -> None:
    lasting = {"standard_deviation": 0.5, "time_constant_s": 21.0}
    assert "Gauss-Markov part (standard deviation): north 0.500 m; time constant 21 s" in (
        noise_sentence(diagnosis("cause", wandering={"north": lasting}))
    )
    message = noise_sentence(diagnosis("unexplained", wandering={"heading": lasting}))
    assert "correlated in time" in message and "heading 28.6 degrees" in message
    assert noise_sentence(diagnosis("cause")) == ""


def test_rivals_are_listed_with_their_parameters() -> None:
    names = ["mass", "azimuth_lag"]
    contrast = Contrast(effects=names, angle=0.1, evidence=-2.0, mutual_refit=1.0, rival=[LAG])
    found = diagnosis("indistinguishable", indistinguishable=[names], contrasts=[contrast])
    message = identifiability_section(found, no_runs())
    assert "0.588 to 0.636" in message and "−2.0" in message


def test_a_manoeuvre_is_described_where_its_name_does_not_say_all() -> None:
    assert manoeuvre_words("spin") == "turning on the spot, 60 %"
    assert manoeuvre_words("zig-zag, 80 %") == "zig-zag, 80 %"


def test_it_is_reported_which_file_has_which_cause() -> None:
    wind = Cause(effect="wind", parameters={})
    assert files_sentence(diagnosis("cause", causes=[LAG])).endswith("the boat file with azimuth_lag.")
    both = files_sentence(diagnosis("cause", causes=[LAG, wind]))
    assert both.endswith("with azimuth_lag. What may differ between runs is in conditions.yaml: wind.")
    of_runs = wind.model_copy(update={"groups": {"a": {}}, "scope": "run"})
    each = files_sentence(diagnosis("cause", causes=[of_runs]))
    assert "with no effect added" in each and "conditions/RUN.yaml of each run: wind" in each
    spoilt = LAG.model_copy(update={"carries_over": False})
    assert "no effect added" in files_sentence(diagnosis("cause", causes=[spoilt]))
    force = Extension(curves=[], held_out=HeldOut(gain=9.0, low=1.0, level=0.95), written=True)
    instead = files_sentence(diagnosis("unexplained", causes=[LAG], extension=force))
    assert instead.endswith("the boat file with force_curve.")


def test_the_page_lists_the_next_steps_below_the_residual_force() -> None:
    found = diagnosis("unexplained", next_steps=["record the wind & more"])
    assert "<ol><li>Record the wind &amp; more.</li></ol>" in residual_section(found, {})
    assert "What to do next" not in residual_section(diagnosis("unexplained"), {})

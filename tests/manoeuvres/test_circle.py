"""The figures of a turning circle are those of an exact circle, whatever the water does beneath it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.boat import load_boat
from swamp_rl.manoeuvres.analysis.analyse import analyse_run
from swamp_rl.manoeuvres.analysis.circle import extraordinary
from swamp_rl.manoeuvres.analysis.figure import Result
from swamp_rl.manoeuvres.analysis.imo import criteria, title_for
from swamp_rl.manoeuvres.analysis.pairs import pairs
from swamp_rl.runs import Run
from tests.support.trial_runs import circle_run

pytestmark = pytest.mark.numerical

BOAT = load_boat("swamp")
D, BETA, U = 6.0, 0.2, 0.8


def analysed(run: Run) -> Result:
    return analyse_run(run, BOAT)


def test_an_exact_circle_gives_its_diameter_speed_drift_angle_and_turning_rate() -> None:
    figures = analysed(circle_run(D, BETA)).figures
    assert figures["steady_diameter"].value == pytest.approx(D, rel=1e-3)
    assert figures["steady_speed"].value == pytest.approx(U, rel=1e-3)
    assert figures["drift_angle"].value == pytest.approx(math.degrees(BETA), abs=0.05)
    assert figures["turning_rate"].value == pytest.approx(math.degrees(2 * U / D), rel=1e-3)
    assert figures["speed_loss"].value == pytest.approx(0.0, abs=2e-3)
    assert figures["approach_speed"].value == pytest.approx(U, rel=1e-3)


def test_advance_transfer_and_tactical_diameter_are_those_of_the_circles_geometry() -> None:
    figures = analysed(circle_run(D, 0.0)).figures
    assert figures["advance"].value == pytest.approx(D / 2, abs=0.05)
    assert figures["transfer"].value == pytest.approx(D / 2, abs=0.05)
    assert figures["tactical_diameter"].value == pytest.approx(D, abs=0.05)
    assert len(figures["tactical_diameter"].each) == 3


def test_a_uniform_drift_is_found_and_removed() -> None:
    calm, drifting = analysed(circle_run(D, BETA)), analysed(circle_run(D, BETA, current=(0.12, -0.05)))
    assert drifting.figures["drift_speed"].value == pytest.approx(0.13, abs=1e-3)
    assert drifting.figures["drift_towards"].value == pytest.approx(
        math.degrees(math.atan2(-0.05, 0.12)) % 360, abs=0.5
    )
    for name in (
        "advance",
        "transfer",
        "tactical_diameter",
        "steady_diameter",
        "drift_angle",
        "steady_speed",
    ):
        assert drifting.corrected[name].value == pytest.approx(calm.figures[name].value, abs=0.03), name
    assert abs(drifting.figures["tactical_diameter"].value - D) > 0.2
    assert drifting.corrected["approach_speed"].value == pytest.approx(U, abs=2e-3)


@given(
    st.floats(2.0, 12.0),
    st.floats(0.0, 0.4),
    st.floats(-0.15, 0.15),
    st.floats(-0.15, 0.15),
    st.floats(-3, 3),
)
def test_the_corrected_diameter_is_the_circles_in_any_current(
    diameter: float, beta: float, north: float, east: float, heading: float
) -> None:
    found = analysed(circle_run(diameter, beta, current=(north, east), heading=heading))
    assert found.corrected["steady_diameter"].value == pytest.approx(diameter, rel=5e-3)
    assert found.figures["drift_speed"].value == pytest.approx(math.hypot(north, east), abs=3e-3)


def test_a_mirrored_circle_has_the_same_figures() -> None:
    one = analysed(circle_run(D, BETA, heading=0.0, current=(0.1, 0.05)))
    other = analysed(circle_run(D, BETA, side=-1.0, heading=0.0, current=(0.1, -0.05)))
    for name, figure in one.corrected.items():
        assert other.corrected[name].value == pytest.approx(figure.value, abs=1e-6), name


def test_less_than_a_turn_is_reported_and_gives_the_advance() -> None:
    found = analysed(circle_run(D, 0.0, turns=0.4))
    assert found.figures["advance"].value == pytest.approx(D / 2, abs=0.05)
    assert math.isnan(found.figures["tactical_diameter"].value)
    assert any("no complete turn" in note for note in found.notes)
    assert not found.corrected


def test_one_turn_alone_is_not_corrected_and_says_so() -> None:
    found = analysed(circle_run(D, BETA, turns=1.2))
    assert found.figures["steady_diameter"].value == pytest.approx(D, rel=2e-3)
    assert not found.corrected
    assert any("1.75 turns" in note for note in found.notes)


def noisy(run: Run, seed: int, deviation: float = 0.03) -> Run:
    rng = np.random.default_rng(seed)
    columns = dict(run.columns)
    for name in ("north", "east"):
        columns[name] = columns[name] + deviation * rng.standard_normal(len(run.time))
    return Run(run.name, columns, run.meta)


def test_with_noisy_positions_the_intervals_hold_the_true_ways_about_as_often_as_they_say() -> None:
    run = circle_run(D, BETA, current=(0.12, -0.05))
    truth = analysed(circle_run(D, BETA)).figures
    held = []
    for seed in range(40):
        found = analysed(noisy(run, seed)).corrected
        assert found["steady_diameter"].value == pytest.approx(D, abs=0.03)
        for name in ("advance", "tactical_diameter"):
            held.append(found[name].low <= truth[name].value <= found[name].high)
    # 95 % of 80, by the binomial law within 0.87 to 1 but once in a hundred times.
    assert np.mean(held) >= 0.87


def test_a_short_turn_still_has_an_interval_of_its_drift() -> None:
    found = analysed(noisy(circle_run(D, BETA, turns=1.8, current=(0.12, -0.05)), 0)).figures["drift_speed"]
    assert 0.0 < found.high - found.low < 0.03
    assert found.value == pytest.approx(0.13, abs=0.01)


def test_a_pair_of_circles_names_the_side_that_it_turns_tighter_to() -> None:
    results = [analysed(circle_run(6.6, BETA)), analysed(circle_run(6.0, BETA, side=-1.0))]
    (pair,) = pairs(results, BOAT.length)
    assert pair.wider == pytest.approx(0.6 / 6.3, abs=2e-3)
    assert pair.verdicts["bias"].startswith("to port")


@pytest.mark.parametrize(
    ("angle", "verdicts"), [(35.0, {"advance": True, "tactical diameter": False}), (30.0, {}), (-35.6, {})]
)
def test_the_standards_limits_are_applied_to_circles_at_35_degrees_only(
    angle: float, verdicts: dict[str, bool]
) -> None:
    wide = analysed(circle_run(5.3 * BOAT.length, 0.0))
    wide.setting["angle"] = math.radians(angle)
    assert {c.name: c.passed for c in criteria(wide, BOAT.length)} == verdicts


def test_a_circle_outside_what_boats_do_is_reported_unless_thrusters_turn_farther_than_a_rudder() -> None:
    tight = circle_run(0.6 * BOAT.length, 1.2)
    assert any("drift angle 69 deg, steady diameter 0.60 L" in note for note in analysed(tight).notes)
    assert not any("steady diameter" in note for note in analysed(circle_run(D, BETA)).notes)
    figures = analysed(tight).corrected
    assert not extraordinary(figures, BOAT.length, math.radians(60.0))


def test_the_standards_title_says_for_which_ships_it_is() -> None:
    assert title_for(6.0) == "IMO MSC.137(76), a standard for ships of 100 m and more"
    assert title_for(100.0) == "IMO MSC.137(76)"

"""Runs as others record them: shortened, from rest, with columns missing or badly described."""

import math
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.analysis.analyse import analyse_run
from swamp_rl.manoeuvres.analysis.motion import motion_of
from swamp_rl.manoeuvres.analysis.pairs import pairs
from swamp_rl.manoeuvres.analysis.recognise import recognised
from swamp_rl.manoeuvres.spiral import spiral_angles
from swamp_rl.runs import Run, RunMeta

BOAT = load_boat("swamp")
DT, HELD = 0.1, 40  # s; rows of a step of a spiral
ANGLES = np.array(spiral_angles(0.35))

CIRCLE, MARK = {"kind": "turning-circle"}, {"time": 1.0, "phase": "step", "number": 1, "angle": 0.4}
WRONG_SETTINGS = [
    (CIRCLE | {"angle": 35.0}, "manoeuvre: angle: must be a number from -6.28 to 6.28, not 35"),
    (CIRCLE | {"angle": math.nan}, "manoeuvre: angle: must be a number"),
    (CIRCLE | {"angle": "port"}, "manoeuvre: angle: must be a number"),
    (CIRCLE | {"heading": [0.3]}, "manoeuvre: heading: must be a number"),
    (CIRCLE | {"throttle": 60}, "manoeuvre: throttle: must be a number from -1 to 1, not 60"),
    (CIRCLE | {"turns": math.inf}, "manoeuvre: turns: must be a finite number"),
    (CIRCLE | {"more": [math.nan]}, "manoeuvre: more: must be a number, a text"),
]
WRONG_MARKS = [{"number": math.inf}, {"angle": 35.0}, {"time": math.nan}, {"time": "late"}]


def turning(yaw_rate: Any, surge: Any = 0.8, **result: Any) -> Run:
    """A run with that yaw rate (T,) [rad/s] and surge [m/s], its jets turned by 0.4 rad."""
    rate = np.asarray(yaw_rate, float)
    heading = np.cumsum(rate) * DT
    way = DT * np.broadcast_to(surge, rate.shape) * np.array([np.cos(heading), np.sin(heading)])
    north, east = np.cumsum(way, axis=1)
    columns = {"time": DT * np.arange(len(rate)), "north": north, "east": east, "heading": heading}
    for thruster in BOAT.thrusters:
        angle, level = thruster.command_columns
        columns[str(angle)] = np.full(len(rate), math.copysign(0.4, thruster.x))
        columns[level] = np.full(len(rate), 0.6)
    return Run("r", columns, RunMeta.model_validate(result))


def stepped(kind: str, phase: str, angles: np.ndarray, rates: np.ndarray) -> Run:
    """A run of a spiral's steps, with marks."""
    marks = [
        {"time": DT * HELD * i, "phase": phase, "number": i + 1, "angle": float(angle)}
        for i, angle in enumerate(angles)
    ]
    return turning(np.repeat(rates, HELD), manoeuvre=kind, marks=marks)


@pytest.mark.parametrize("steps", [21, 20, 19, 17])
def test_a_spiral_that_ended_early_shows_the_same_narrow_loop(steps: int) -> None:
    run = stepped("spiral", "step", ANGLES[:steps], 0.5 * ANGLES[:steps])
    result = analyse_run(run, BOAT)
    assert result.figures["loop_height"].value < 0.5
    assert result.verdicts["course_stability"].startswith("stable")


def test_a_spiral_whose_steps_back_are_others_has_no_loop() -> None:
    angles = np.concatenate([ANGLES[:11], [-0.1, 0.0, 0.1]])
    assert "no loop to measure" in analyse_run(stepped("spiral", "step", angles, angles), BOAT).notes[0]


def test_a_spiral_that_turns_to_one_side_throughout_names_no_neutral_angle() -> None:
    verdicts = analyse_run(stepped("spiral", "step", ANGLES, 0.5 * ANGLES + 0.3), BOAT).verdicts
    assert verdicts["bias"] == "to starboard: +17.19 deg/s amidships, neutral angle not reached"
    assert not any("nan" in text for text in verdicts.values())


@pytest.mark.parametrize("seed", range(4))
def test_a_reverse_spiral_of_eight_yaw_rates_has_an_interval(seed: int) -> None:
    rates = np.linspace(0.2, -0.2, 8)
    slope = analyse_run(stepped("reverse-spiral", "hold", rates, rates), BOAT, seed).figures["slope"]
    assert math.isfinite(slope.low)


def test_a_reverse_spiral_to_one_side_has_no_width() -> None:
    rates = np.linspace(0.4, 0.1, 12)
    figures = analyse_run(stepped("reverse-spiral", "hold", rates, rates), BOAT).figures
    assert math.isnan(figures["loop_width"].value)


def test_a_circle_from_rest_has_no_loss_of_speed() -> None:
    under_way = np.arange(900) > 60
    run = turning(0.2 * under_way, 0.8 * under_way)
    for thruster in BOAT.thrusters:
        run.columns[str(thruster.command_columns[0])][:60] = 0.0
    figures = analyse_run(run, BOAT).figures
    assert figures["approach_speed"].value == 0.0
    assert math.isnan(figures["speed_loss"].value)
    assert figures["steady_diameter"].value == pytest.approx(8.0, rel=0.01)


def test_a_thruster_that_was_not_logged_has_no_part_in_the_steering() -> None:
    run = turning(np.full(600, 0.2))
    del run.columns[BOAT.thrusters[-1].command_columns[1]]
    assert motion_of(run, BOAT).angle == pytest.approx(0.4)


def test_a_zig_zag_that_begins_in_a_turn_has_no_initial_turning() -> None:
    marks = [
        {"time": 3.9 + 4.0 * i, "phase": "execute", "number": i + 1, "angle": -0.35 * (-1) ** i}
        for i in range(8)
    ]
    run = turning(np.tile(np.repeat([1.2, -1.2], 20), 10), manoeuvre="zig-zag", marks=marks)
    assert math.isnan(analyse_run(run, BOAT).figures["initial_turning"].value)


@pytest.mark.parametrize(
    ("run", "message"),
    [
        (turning([0.2]), r"run r: has 1 row\(s\)"),
        (turning(np.full(600, 0.2), notes="windy"), "run r: notes must be a list, not 'windy'"),
        (turning(np.full(600, 0.2), manoeuvre="spiral", marks=3), "run r: marks must be a list, not 3"),
        *((turning(np.full(600, 0.2), manoeuvre=result), reported) for result, reported in WRONG_SETTINGS),
        *(
            (turning(np.full(600, 0.2), manoeuvre="spiral", marks=[MARK | wrong]), "run r: marks must be")
            for wrong in WRONG_MARKS
        ),
    ],
)
def test_what_is_no_manoeuvre_is_refused_in_one_line(run: Run, message: str) -> None:
    with pytest.raises(UserError, match=message):
        analyse_run(run, BOAT)


def test_a_stated_manoeuvre_whose_phases_no_mark_names_has_no_figures_and_no_pair() -> None:
    run = turning(np.full(600, 0.2), manoeuvre=CIRCLE | {"angle": 0.4}, marks=[MARK | {"phase": "execute"}])
    result = analyse_run(run, BOAT)
    assert result.notes == ["no phase 'turning' among its marks, which have 'execute': no figures"]
    assert pairs([result, result], BOAT.length) == []


def wandering(turns: float) -> Run:
    """A run with turns at 0.1 rad/s under steering that wanders about 0.4 rad and is never held."""
    run = turning(np.full(int(turns * math.tau / (0.1 * DT)), 0.1))
    share = 1.0 + 0.3 * np.sin(1.7 * run.time) * np.sin(0.31 * run.time)
    columns = {name: v * share if name.startswith("azimuth_") else v for name, v in run.columns.items()}
    return Run(run.name, columns, run.meta)


def test_a_full_circle_under_a_rudder_that_wanders_is_one() -> None:
    result = analyse_run(wandering(1.6), BOAT)
    assert result.kind == "turning-circle"
    assert result.figures["steady_diameter"].value == pytest.approx(2.0 * 0.8 / 0.1, rel=0.05)
    with pytest.raises(UserError, match="no turning circle or zig-zag found"):
        analyse_run(wandering(0.7), BOAT)


def test_a_run_of_several_turning_circles_says_so() -> None:
    order = np.repeat([0.0, 1.0, 0.0, -1.0, 0.0], [50, 400, 200, 300, 50])
    run = turning(0.2 * order)
    for name in [name for name in run.columns if name.startswith("azimuth_")]:
        run.columns[name] = run.columns[name] * order
    (note,) = [one for one in analyse_run(run, BOAT).notes if "turning circles" in one]
    assert note.startswith("the run holds 2 turning circles") and "runs import --map keep" in note
    single = turning(np.full(600, 0.2))
    assert not [one for one in analyse_run(single, BOAT).notes if "turning circles" in one]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_touch_of_steering_before_a_zig_zag_is_no_execute_of_it(side: float) -> None:
    shares = [0.0, 0.7 * side, 0.0, 1.0, -1.0, 1.0, -1.0, 0.0]
    order = math.radians(5.0) * np.repeat(shares, [50, 20, 200, 200, 200, 200, 200, 50])
    run = turning(0.3 * order)
    for name in [name for name in run.columns if name.startswith("azimuth_")]:
        run.columns[name] = np.sign(run.columns[name]) * order
    found = recognised(run.meta, motion_of(run, BOAT), run.name)
    assert found.kind == "zig-zag"
    marks = [(mark.time, mark.angle) for mark in found.of("execute")]
    assert [time for time, _ in marks] == pytest.approx([27.0, 47.0, 67.0, 87.0], abs=0.2)
    assert [angle for _, angle in marks] == pytest.approx([0.0873, -0.0873, 0.0873, -0.0873], abs=1e-3)


def test_an_order_that_is_passed_by_hand_and_taken_back_begins_where_it_is_given() -> None:
    shares = [0.0, 1.0, -1.0, 1.0, -1.8, -1.0, 0.0]
    order = math.radians(5.0) * np.repeat(shares, [50, 200, 200, 200, 30, 170, 50])
    run = turning(0.3 * order)
    for name in [name for name in run.columns if name.startswith("azimuth_")]:
        run.columns[name] = np.sign(run.columns[name]) * order
    found = recognised(run.meta, motion_of(run, BOAT), run.name)
    times = [mark.time for mark in found.of("execute")]
    assert times == pytest.approx([5.0, 25.0, 45.0, 65.0], abs=0.2)

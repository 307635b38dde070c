"""Trials of boats that steer by the difference of fixed thrusters: their angle is that of their throttles."""

import math
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.identification.motion import motion_of
from swamp_rl.identification.yaw_model import by_pseudo_inverse
from swamp_rl.manoeuvres.analysis.analyse import analyse_run
from swamp_rl.manoeuvres.analysis.figure import Result
from swamp_rl.manoeuvres.controller import Order, Trial
from swamp_rl.manoeuvres.execute import execute
from swamp_rl.manoeuvres.record import record_trials, run_of_trial
from swamp_rl.manoeuvres.steering import difference_angle, steering
from swamp_rl.manoeuvres.straight_line_stability import straight_line_stability
from swamp_rl.runs import Run, read_dataset
from tests.support.from_scratch import with_tunnel, written

DEG = math.radians(1.0)


@pytest.fixture
def twin(tmp_path: Path) -> Boat:
    return load_boat(written(tmp_path, "twin"))


def angle_of(boat: Boat, levels: np.ndarray) -> np.ndarray:
    found = difference_angle(zip(boat.thrusters, levels.T, strict=True))
    assert found is not None
    return found


def with_yaw_damping(boat: Boat, n_r: float) -> Boat:
    return boat.model_copy(update={"hull": boat.hull.model_copy(update={"n_r": n_r})})


@pytest.mark.parametrize("astern", [False, True])
@pytest.mark.parametrize("name", ["twin", "crossed", "with a tunnel"])
def test_the_angle_of_an_order_is_found_in_its_throttles(tmp_path: Path, name: str, astern: bool) -> None:
    path = written(tmp_path, "twin" if name == "with a tunnel" else name)
    boat = load_boat(with_tunnel(path) if name == "with a tunnel" else path)
    ordered = np.radians([-90.0, -35.0, -1.0, 0.0, 20.0, 89.0])
    command = steering(boat, "opposed")
    levels = np.array([np.split(command(Order(angle, 0.6, astern)), 2)[1] for angle in ordered])
    assert angle_of(boat, levels) == pytest.approx(ordered)


def test_throttles_that_no_order_gives_have_the_nearest_angle(twin: Boat) -> None:
    assert np.degrees(angle_of(twin, np.array([[0.0, 0.0], [1.0, -1.0], [-1.0, 1.0]]))) == pytest.approx(
        [0.0, 90.0, -90.0]
    )


def test_thrusters_that_turn_the_boat_to_one_side_only_have_no_angle(twin: Boat) -> None:
    assert difference_angle([(twin.thrusters[0], np.ones(2))]) is None


@pytest.mark.parametrize(
    ("trial", "figure"),
    [
        (Trial("turning-circle", 0.6, 35 * DEG, turns=2), "steady_diameter"),
        (Trial("zig-zag", 0.6, 20 * DEG, 20 * DEG), "first_overshoot"),
    ],
)
def test_a_trial_is_analysed_from_its_throttles_alone(
    tmp_path: Path, twin: Boat, trial: Trial, figure: str
) -> None:
    record_trials(tmp_path / "runs", twin, str(tmp_path / "twin.yaml"), [trial])
    (run,) = read_dataset(tmp_path / "runs").runs
    told, found = analyse_run(run, twin), analyse_run(Run(run.name, run.columns), twin)
    assert found.kind == trial.kind
    assert found.setting["angle"] == pytest.approx(trial.angle)
    assert found.figures[figure].value == pytest.approx(told.figures[figure].value, rel=0.03)


def executed(boat: Boat, trial: Trial) -> Run:
    return run_of_trial(execute(boat, [trial])[0], boat, "r", 0)


def reverse_spiral(boat: Boat, **changes: np.ndarray | None) -> Result:
    """The result of a reverse spiral with this boat, columns of its run replaced, or left out by None."""
    run = executed(boat, Trial("reverse-spiral", 0.6, 20 * DEG))
    columns = {name: column for name, column in (run.columns | changes).items() if column is not None}
    return analyse_run(Run(run.name, columns, run.meta), boat)


@pytest.mark.parametrize("n_r", [-0.02, -0.3])
def test_a_reverse_spiral_agrees_with_the_roots_of_the_linear_boat(twin: Boat, n_r: float) -> None:
    boat = with_yaw_damping(twin, n_r)
    verdict = reverse_spiral(boat).verdicts["course_stability"]
    assert verdict.startswith("unstable" if straight_line_stability(boat).growth > 0.0 else "stable")


def test_a_reverse_spiral_without_commands_is_not_judged(twin: Boat) -> None:
    result = reverse_spiral(twin, throttle_port=None, throttle_starboard=None)
    assert result.verdicts == {}
    assert result.notes[-1] == "its commands give no steering angle: no curve through the yaw rates"


def test_the_yaw_model_takes_the_angle_that_the_trial_ordered(twin: Boat) -> None:
    run = executed(twin, Trial("zig-zag", 0.6, 20 * DEG, 20 * DEG))
    motion = motion_of(run, twin)
    assert np.degrees(np.abs(motion.steering[-20:])) == pytest.approx(20.0)  # of the last execute
    assert by_pseudo_inverse(motion, twin.inertia_z)[0].b_r > 0.0

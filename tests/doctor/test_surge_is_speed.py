"""A speed over ground in place of surge is named, and a surge is not taken for it."""

import numpy as np
import pytest

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat
from swamp_rl.runs import Run
from swamp_rl.simulator.replay import replay
from tests.support.doctored import STEP, Columns, driven, faults
from tests.support.new_boats import new_boat


@pytest.fixture(scope="module")
def tender(tmp_path_factory: pytest.TempPathFactory) -> list[Run]:
    """Four runs of 150 s of a boat that turns sharply, with the noise of heading and velocities."""
    boat = new_boat(tmp_path_factory.mktemp("boat"), "outboard", 2.2, thrust=250.0)
    rng, rows, runs = np.random.default_rng(2), 1500, []
    (thruster,) = boat.thrusters
    for number in range(4):
        columns = {name: np.zeros(rows) for name in ("north", "east", "heading", "surge", "sway", "yaw_rate")}
        columns |= {"time": STEP * np.arange(rows)}
        columns[f"throttle_{thruster.name}"] = np.repeat(rng.uniform(0.2, 1.0, 30), 50)
        columns[f"azimuth_{thruster.name}"] = np.repeat(rng.uniform(-0.5, 0.5, 30), 50)
        run = dict(replay(boat, Run(f"run-{number}", columns)).columns)
        for name, error in (("heading", 0.01), ("surge", 0.02), ("sway", 0.02), ("yaw_rate", 0.005)):
            run[name] = run[name] + error * rng.standard_normal(rows)
        runs.append(Run(f"run-{number}", run | {"heading": wrapped(run["heading"])}))
    return runs


def speed_over_ground(run: Run) -> Run:
    return Run(run.name, run.columns | {"surge": np.hypot(run.columns["surge"], run.columns["sway"])})


def with_fixes(run: Run, noise: float, every: int, interpolated: bool = False) -> Run:
    """The run with a receiver of so much more white noise [m] and a fix each `every` rows."""
    rng, rows = np.random.default_rng(9), np.arange(len(run.time))
    columns = dict(run.columns)
    for name in ("north", "east"):
        fixes = columns[name] + noise * rng.standard_normal(len(rows))
        held = fixes[rows // every * every]
        columns[name] = np.interp(rows, rows[::every], fixes[::every]) if interpolated else held
    return Run(run.name, columns)


RECEIVERS = {
    "every row": (0.3, 1, False),
    "5 Hz held": (0.15, 2, False),
    "2 Hz held": (0.3, 5, False),
    "2 Hz interpolated": (0.3, 5, True),
    "1 Hz held": (0.3, 10, False),
}


@pytest.mark.parametrize("receiver", RECEIVERS)
def test_a_surge_beside_a_slow_and_noisy_receiver_is_sound(receiver: str, tender: list[Run]) -> None:
    logged = [with_fixes(run, *RECEIVERS[receiver]) for run in tender]
    assert "surge_is_speed" not in {one.code for one in faults(logged, None)}


@pytest.mark.parametrize("receiver", RECEIVERS)
def test_a_speed_beside_a_slow_and_noisy_receiver_is_named(receiver: str, tender: list[Run]) -> None:
    noise, every, interpolated = RECEIVERS[receiver]
    logged = [speed_over_ground(with_fixes(run, 0.5 * noise, every, interpolated)) for run in tender]
    assert "surge_is_speed" in {one.code for one in faults(logged, None)}


@pytest.mark.parametrize("unit", [1.0, 1.944], ids=["m/s", "kn"])
def test_a_speed_over_ground_in_place_of_surge_is_named_where_a_boat_drifts(unit: float, twin: Boat) -> None:
    turning = driven(twin, 0.6)
    assert faults(turning, twin) == []
    fast = [
        Run(run.name, run.columns | {"surge": unit * np.hypot(run.columns["surge"], run.columns["sway"])})
        for run in turning
    ]
    (found,) = [one for one in faults(fast, twin) if one.code == "surge_is_speed"]
    assert found.figures["share"] == pytest.approx(1.0, abs=0.15)


def test_a_surge_that_contains_more_than_the_speed_does_is_not_taken_for_it(twin: Boat) -> None:
    def more(columns: Columns) -> Columns:
        excess = np.hypot(columns["surge"], columns["sway"]) - columns["surge"]
        return {**columns, "surge": columns["surge"] + 5.0 * excess}

    turning = [Run(run.name, more(dict(run.columns))) for run in driven(twin, 0.6)]
    assert "surge_is_speed" not in {one.code for one in faults(turning, twin)}

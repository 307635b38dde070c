"""From when on a run's simulation no longer depends on where the actuators were at its start."""

import numpy as np

from swamp_rl.boat import Boat, load_boat
from swamp_rl.criticism.model.actuator_history import actuator_history, first_compared

DT, ROWS = 0.1, 300


def slow(rate: float) -> Boat:
    """SWAMP with azimuths that turn at `rate` [rad/s]."""
    boat = load_boat("swamp")
    return boat.model_copy(
        update={
            "thrusters": tuple(t.model_copy(update={"azimuth_rate": rate}) for t in boat.thrusters),
        }
    )


def commands(azimuth: np.ndarray) -> np.ndarray:
    """(1, ROWS, 8) that azimuth for all four thrusters, at full throttle."""
    return np.concatenate([np.tile(azimuth[:, None], 4), np.ones((ROWS, 4))], axis=1)[None]


def alternating(period: int) -> np.ndarray:
    return np.where(np.arange(ROWS) // period % 2, -1.0, 1.0)


def begins(boat: Boat, azimuth: np.ndarray) -> int:
    return int(first_compared(boat, commands(azimuth), np.array([ROWS]), DT)[0])


def test_quick_thrusters_are_compared_from_three_seconds_on() -> None:
    assert begins(load_boat("swamp"), alternating(20)) == 30


def test_slow_thrusters_that_never_arrive_are_compared_from_the_middle_of_the_run() -> None:
    assert begins(slow(0.2), alternating(10)) == ROWS // 2


def test_the_first_time_that_slow_thrusters_arrive_ends_the_transient() -> None:
    azimuth = alternating(10)
    azimuth[100:] = 0.8
    boat = slow(0.4)
    first = begins(boat, azimuth)
    assert 100 < first < 150
    histories = [actuator_history(boat, commands(azimuth), DT, known)[0] for known in (True, False)]
    assert np.abs(histories[0] - histories[1])[first:].max() < 0.011
    assert np.abs(histories[0] - histories[1])[first - 5].max() > 0.01


def test_whole_turns_of_an_azimuth_without_end_are_no_difference() -> None:
    assert begins(load_boat("swamp"), np.full(ROWS, 3.0)) == 30

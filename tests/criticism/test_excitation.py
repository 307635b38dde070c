"""Missing excitation is named: a speed, a side, a heading, a thruster, a second run."""

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.excitation import missing_motion
from swamp_rl.criticism.data.run_set import RunSet

pytestmark = pytest.mark.numerical

BOAT = load_boat("swamp")
TIME = np.arange(0.0, 120.0, 0.1)


def sailed(speed: float, turn: np.ndarray, throttle: np.ndarray, runs: int = 2) -> RunSet:
    """Runs at a speed [m/s] that goes with the throttle (T,), turning at `turn` (T,) [rad/s]."""
    heading = np.cumsum(turn) * 0.1
    pace = speed * throttle
    north, east = np.cumsum(pace * np.cos(heading)) * 0.1, np.cumsum(pace * np.sin(heading)) * 0.1
    measured = np.full((runs, len(TIME), 6), np.nan)
    measured[..., :3] = np.stack([north, east, heading], axis=1)
    angle = np.clip(2.0 * turn, -0.5, 0.5)
    commands = np.stack([angle, angle, -angle, -angle, *(throttle,) * 4], axis=1)
    names = tuple(f"run_{k}" for k in range(runs))
    return RunSet(
        BOAT, 0.1, names, np.repeat(commands[None], runs, axis=0), measured, np.full(runs, len(TIME))
    )


STEPPED = np.where(TIME < 60.0, 0.4, 0.9)
BOTH_WAYS = np.where(TIME % 80.0 < 40.0, 0.2, -0.2)


def test_runs_with_speeds_turns_and_headings_lack_nothing() -> None:
    assert missing_motion(sailed(1.0, BOTH_WAYS, STEPPED)) == []


@pytest.mark.parametrize(
    ("turn", "throttle", "lacks"),
    [
        (
            0.0 * TIME,
            STEPPED,
            ["turns to starboard and to port", "courses in all directions", "steering by bs, bp"],
        ),
        (0.2 + 0.0 * TIME, STEPPED, ["turns to port", "steering by"]),
        (BOTH_WAYS, 0.6 + 0.0 * TIME, ["a second speed", "other thrust levels of bs, bp, ss, sp"]),
    ],
)
def test_straight_one_sided_and_even_runs_say_what_to_sail(
    turn: np.ndarray, throttle: np.ndarray, lacks: list[str]
) -> None:
    found = missing_motion(sailed(1.0, turn, throttle))
    assert len(found) == len(lacks)
    for start, result in zip(lacks, found, strict=True):
        assert result.startswith(start)


def test_two_full_circles_hold_all_courses_however_long_the_straight_runs_are() -> None:
    straight = sailed(1.0, BOTH_WAYS * 0.1, STEPPED, runs=30)
    circles = 4.0 * np.pi / 60.0 * (TIME < 60.0)
    straight.measured[0] = sailed(1.0, circles, STEPPED, runs=1).measured[0]
    assert not any(message.startswith("courses") for message in missing_motion(straight))
    assert any(message.startswith("courses") for message in missing_motion(straight.subset([1, 2])))


def test_a_thruster_that_never_runs_and_a_lonely_run_are_named() -> None:
    run_set = sailed(1.0, BOTH_WAYS, STEPPED, runs=1)
    run_set.commands[..., 6:] = 0.0
    found = missing_motion(run_set)
    assert [message.split(":")[0] for message in found] == ["thrust of ss, sp", "a second run, to hold out"]
    assert len(missing_motion(run_set, held_out=True)) == 1


def test_a_boat_that_lies_still_is_run_anew() -> None:
    assert missing_motion(sailed(0.01, BOTH_WAYS, STEPPED))[0].startswith("way through the water")

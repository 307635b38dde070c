"""The same motion as two runs of a dataset."""

import numpy as np
import pytest

from swamp_rl.boat import Boat
from swamp_rl.runs import Run
from swamp_rl.runs.same_run import same_motion, same_runs
from tests.support.doctored import faults


def again(run: Run, **changed: np.ndarray) -> Run:
    """A run as another import has it: other origin, other first time, numbers rounded as in text."""
    columns = {name: np.array([float(f"{x:.12g}") for x in values]) for name, values in run.columns.items()}
    columns |= {"north": columns["north"] + 31.25, "east": columns["east"] - 8.5, "time": run.time + 4.0}
    return Run("again", columns | changed)


def test_a_run_that_is_there_twice_is_named(sound: list[Run], twin: Boat) -> None:
    (found,) = faults([*sound, again(sound[1])], twin)
    assert (found.code, found.runs) == ("run_twice", (sound[1].name, "again"))
    assert faults(sound, twin) == []


@pytest.mark.parametrize("name", ["heading", "north", "throttle_port"])
def test_runs_that_differ_in_one_channel_are_two(sound: list[Run], name: str) -> None:
    other = again(sound[0])
    assert same_motion(sound[0].columns, other.columns)
    noise = 0.01 * np.random.default_rng(1).standard_normal(len(other.time))
    moved = again(sound[0], **{name: other.columns[name] + (noise if name == "heading" else 50.0 * noise)})
    assert not same_motion(sound[0].columns, moved.columns)


def test_missing_values_are_compared_by_their_places(sound: list[Run]) -> None:
    gap = sound[0].columns["surge"].copy()
    gap[0] = gap[7] = np.nan
    with_gap = again(sound[0], surge=gap)
    assert not same_motion(sound[0].columns, with_gap.columns)
    assert same_runs([with_gap.columns], [sound[0].columns, with_gap.columns]) == [(0, 1)]

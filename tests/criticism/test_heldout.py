"""What is held out, and fits that find no way down."""

import numpy as np
import pytest

from swamp_rl.criticism.candidates import Hypothesis, candidates
from swamp_rl.criticism.heldout import held_together
from swamp_rl.criticism.ladder import ladder_of
from swamp_rl.criticism.noise import noise_levels, weights
from swamp_rl.criticism.score import prospects
from swamp_rl.criticism.windows import Windows
from tests.support.criticism import SECONDS, trials

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


def windows(*counts: int) -> Windows:
    """Runs of so many windows, one after another."""
    run = np.repeat(np.arange(len(counts)), counts)
    first = np.concatenate([50 * np.arange(count) for count in counts])
    empty = np.zeros((len(run), 51, 6))
    return Windows(run, first, np.full(len(run), 50), empty, empty, 0, 51)


def test_enough_runs_are_held_out_whole() -> None:
    assert held_together(windows(2, 2, 2, 2)).tolist() == [0, 0, 1, 1, 2, 2, 3, 3]


def test_of_few_runs_halves_are_held_out_and_of_one_run_each_window() -> None:
    assert held_together(windows(4, 2)).tolist() == [0, 0, 1, 1, 2, 3]
    assert held_together(windows(3)).tolist() == [0, 1, 2]


@pytest.mark.parametrize("moment", [2.5, 6.0])
def test_a_hull_that_turns_by_itself_is_fitted_though_windows_run_away(moment: float) -> None:
    found = trials(
        [{"effect": "hull_asymmetry", "yaw_moment": moment}], velocities=False, name="swamp-thesis"
    )
    ladder = ladder_of(found, weights(found, noise_levels(found)))
    nothing = ladder.fit(0, Hypothesis(), np.zeros(0))
    atom = next(one for one in candidates(found.boat, SECONDS) if one.label == "hull_asymmetry")
    start = prospects(ladder.problems[0], nothing, [atom])[0]
    made = ladder.fit(0, start.hypothesis, start.x, start.states)
    assert ladder.stuck(made, nothing.chi2, start.promised)
    freed = ladder.freed(made)
    assert freed.chi2 < 1.1 * ladder.problems[0].samples
    assert freed.x == pytest.approx([moment], rel=0.01)

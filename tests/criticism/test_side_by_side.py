"""Fits that do not build on each other are made in threads, and kept as if made in turn."""

import numba
import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.selection.continuation import LAST, MIDDLE, Continuation, continuation_of
from swamp_rl.criticism.selection.side_by_side import side_by_side
from tests.support.criticism import SECONDS, simulated_runs

RUNS = simulated_runs([{"effect": "resistance", "scale": 1.3}])
KNOWN = by_label(candidates(RUNS.boat, SECONDS))


def fitted(continuation: Continuation, label: str) -> Fit:
    """The fit of one effect to all windows up to whole runs."""
    hypothesis = Hypothesis((KNOWN[label],))
    for stage in (0, MIDDLE, LAST):
        made = continuation.fit(stage, hypothesis, np.array(KNOWN[label].starts[0]))
    return made


@pytest.mark.parametrize("threads", [1, 3])
def test_fits_side_by_side_are_kept_and_counted_as_those_made_in_turn(
    threads: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    labels = ["resistance", "mass", "yaw_damping"]
    weight = weights(RUNS, noise_levels(RUNS))
    in_turn, beside = continuation_of(RUNS, weight), continuation_of(RUNS, weight)
    for continuation in (in_turn, beside):
        continuation.boat_file(0)
    expected = [fitted(in_turn, label) for label in labels]
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", threads)
    found = side_by_side(beside, fitted, labels)
    for one, other in zip(found, expected, strict=True):
        assert one.hypothesis == other.hypothesis and one.chi2 == other.chi2
        np.testing.assert_array_equal(one.x, other.x)
        assert beside.at(LAST, one) is one
    assert list(beside.fits) == list(in_turn.fits) and list(beside.whole) == list(in_turn.whole)
    assert beside.boat_steps == in_turn.boat_steps
    assert all(problem is beside.problems[LAST] for problem in beside.whole.values())


def test_work_side_by_side_knows_the_fits_before_it_and_none_of_its_neighbours() -> None:
    continuation = continuation_of(RUNS, weights(RUNS, noise_levels(RUNS)))
    nothing = continuation.boat_file(0)

    def known(own: Continuation, label: str) -> tuple[bool, int]:
        before = own.boat_file(0) is nothing, len(own.fits)
        fitted(own, label)
        return before

    assert side_by_side(continuation, known, ["resistance", "mass"]) == [(True, 1)] * 2
    assert len(continuation.fits) == 1 + 2 * 3

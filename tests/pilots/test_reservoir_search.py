"""Cross-validation of a reservoir leaves out whole runs, and finds what the runs ask for."""

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.pilots.reservoir import fit_reservoir, states_of
from swamp_rl.pilots.reservoir_search import (
    SearchedReservoirSettings,
    Unsearched,
    errors_left_out,
    fit_searched_reservoir,
    scores,
)
from tests.support.steering_runs import RUNS, SMALL, wandering

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

FEW = SearchedReservoirSettings(
    units=(10, 40),
    spectral_radius=(0.5,),
    lowest_leak=(0.05, 1.0),
    ridge=(1e-3, 1.0),
    folds=4,
)


def test_the_error_is_that_of_readouts_that_never_saw_the_run() -> None:
    """Against fits with each fold's runs taken away, their rows predicted one by one."""
    _, states, levers = states_of(RUNS, SMALL)
    squares: list[np.ndarray] = []
    for fold in range(4):
        kept = [i for i in range(len(RUNS)) if i % 4 != fold]
        x, y = (np.concatenate([of_run[i] for i in kept]) for of_run in (states, levers))
        mean_x, mean_y = x.mean(axis=0), y.mean(axis=0)
        wide = np.vstack([x - mean_x, np.sqrt(0.3) * np.eye(SMALL.units)])
        weights = np.linalg.lstsq(wide, np.vstack([y - mean_y, np.zeros((SMALL.units, 2))]), rcond=None)[0]
        for i in range(fold, len(RUNS), 4):
            squares.append(np.square((states[i] - mean_x) @ weights + mean_y - levers[i]))
    found = errors_left_out(RUNS, SMALL, (0.3, 100.0), 4)
    assert found[0] == pytest.approx(np.concatenate(squares).mean(), rel=1e-8)
    assert found[1] != pytest.approx(found[0])


def test_a_memory_is_chosen_where_the_levers_follow_the_past() -> None:
    best = scores([wandering(seed, lag=10) for seed in range(12)], FEW)[0].settings
    assert best.leak[0] == 0.05 and best.units == 40


def test_every_combination_is_scored_and_the_least_error_is_learned_from_all_runs() -> None:
    heard: list[float] = []
    found = scores(RUNS, FEW, heard.append)
    assert len(found) == 8 and len({scored.settings for scored in found}) == 8
    assert [scored.error for scored in found] == sorted(scored.error for scored in found)
    assert heard == [0.25, 0.5, 0.75, 1.0]
    pilot, expected = fit_searched_reservoir(RUNS, FEW), fit_reservoir(RUNS, found[0].settings)
    np.testing.assert_array_equal(pilot.weights()["Wout"], expected.weights()["Wout"])


def test_fewer_runs_than_folds_are_refused() -> None:
    with pytest.raises(UserError, match="4 folds need as many runs, not 3"):
        scores(RUNS[:3], FEW)


def test_what_is_not_searched_stays_as_it_was_asked_for() -> None:
    asked = FEW.model_copy(update={"reservoir": Unsearched(reaction=0.2), "seed": 5})
    assert {(s.settings.seed, s.settings.reaction) for s in scores(RUNS, asked)} == {(5, 0.2)}

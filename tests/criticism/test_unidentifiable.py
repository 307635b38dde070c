"""Parameters of a named cause that the runs say nothing about."""

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.inference.estimate import cause_of, causes_of
from swamp_rl.criticism.inference.unidentifiable import with_neutral_values
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.report.words import number_cells
from swamp_rl.criticism.result import Estimate
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.continuation import MIDDLE, continuation_of
from tests.support.criticism import SECONDS, driven, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

DRAG = {"effect": "drag_asymmetry", "astern": 0.5, "port": 1.8}


def estimates(astern: bool) -> tuple[dict[str, Estimate], float]:
    """The estimates of both parameters from runs that go ahead alone, or astern too; and how much chi2 the
    neutral values cost.
    """
    runs = simulated_runs([DRAG])
    if astern:
        commands = np.full_like(runs.commands, 0.8)
        turned = 0.3 * np.sign(np.sin(np.arange(commands.shape[1]) / 40.0))
        commands[..., :4] = np.pi - np.outer(turned, [1, 1, -1, -1])
        runs = driven([DRAG], commands, 0.0, seed=3)
    continuation = continuation_of(runs, weights(runs, noise_levels(runs)))
    hypothesis = Hypothesis((by_label(candidates(runs.boat, SECONDS))["drag_asymmetry"],))
    fitted = continuation.fit(MIDDLE, hypothesis, np.array([1.2, 1.2]))
    winner = with_neutral_values(continuation, Selection(fitted, True, MIDDLE, [], [], [], [])).winner
    assert continuation.at(MIDDLE, winner) is winner  # for whatever asks for it later
    (cause,) = causes_of(continuation.problems[MIDDLE], winner)
    return cause.parameters, winner.chi2 - fitted.chi2


def test_a_drag_astern_of_a_boat_that_never_went_astern_stays_as_in_the_boat_file() -> None:
    found, cost = estimates(astern=False)
    assert found["astern"].value == 1.0 and not found["astern"].identifiable
    assert number_cells(found["astern"]) == ("1", "not determined by these runs", "")
    assert abs(found["port"].value - 1.8) < 4.0 * found["port"].standard_error < 0.4
    assert found["port"].identifiable and abs(cost) < 1e-6


def test_a_drag_astern_is_estimated_from_runs_astern() -> None:
    found, cost = estimates(astern=True)
    assert all(one.identifiable for one in found.values()) and cost == 0.0
    assert abs(found["astern"].value - 0.5) < 4.0 * found["astern"].standard_error < 0.2


def test_an_estimate_of_which_the_standard_error_exceeds_the_range_of_the_fit_has_no_interval() -> None:
    band = by_label(candidates(load_boat("swamp"), SECONDS))["throttle_dead_band ss"]
    for error, is_determined in ((1e21, False), (0.5, True)):
        (found,) = cause_of(band, np.array([0.88]), np.array([[error**2]])).parameters.values()
        assert found.identifiable == is_determined
        assert ("not determined by these runs" in number_cells(found)) != is_determined

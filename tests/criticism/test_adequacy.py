"""The whiteness test with few samples and with diverged simulations."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.inference.force_regression import residual_force_functions
from swamp_rl.criticism.inference.residual_force import residual_forces
from swamp_rl.criticism.likelihood.adequacy import adequacy
from swamp_rl.criticism.likelihood.cross_validation import Confirmation
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit, losses
from swamp_rl.criticism.model.candidates import Hypothesis, candidates
from swamp_rl.criticism.selection.backward_elimination import Selection, without_unconfirmed
from swamp_rl.criticism.selection.continuation import continuation_of
from tests.support.criticism import SECONDS, commands, driven

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


def fitted(every: int, rows: int) -> tuple[Shooting, Fit]:
    """Clean runs cut in windows, of which one sample in `every` of the first `rows` is there."""
    sailed = driven([], np.stack([commands(0), commands(2)]), 0.0, seed=3)
    there = (np.arange(sailed.measured.shape[1]) % every == 0) & (np.arange(sailed.measured.shape[1]) < rows)
    measured = np.where(there[None, :, None], sailed.measured, np.nan)
    sparse = replace(sailed, measured=measured)
    problem = Shooting(sparse, weights(sparse, noise_levels(sailed)), 20.0)
    return problem, fit(problem, Hypothesis(), np.zeros(0), problem.initial_states())


@pytest.mark.parametrize(("every", "rows"), [(1, 400), (4, 400), (7, 400), (7, 60)])
def test_sparse_samples_are_judged_as_dense_ones_are(every: int, rows: int) -> None:
    problem, at = fitted(every, rows)
    assert adequacy(problem, at).adequate
    pushed = replace(at, residual=at.residual + 1.5 * (problem.windows.weight.reshape(at.residual.shape) > 0))
    assert not adequacy(problem, pushed).adequate


def test_a_diverged_simulation_is_not_adequate_and_the_channel_is_named() -> None:
    problem, at = fitted(1, 400)
    residual = at.residual.reshape(*problem.windows.weight.shape).copy()
    residual[0, 80:, 2] = np.nan
    judged = adequacy(problem, replace(at, residual=residual.reshape(at.residual.shape)))
    assert (judged.adequate, judged.channel) == (False, "heading")


def test_an_inadequate_selection_keeps_confirmed_causes_only() -> None:
    sailed = driven([{"effect": "mass", "mass": 75.0}], np.stack([commands(0), commands(2)]), 0.0, seed=3)
    instances = [a for a in candidates(sailed.boat, SECONDS) if a.effect.name in ("mass", "sway_drag")]
    continuation = continuation_of(sailed, weights(sailed, noise_levels(sailed)))
    both = Hypothesis().with_instance(instances[0]).with_instance(instances[1])
    best = continuation.fit(1, both, np.concatenate([instance.starts[0] for instance in both.instances]))
    entries = {"mass": Confirmation(90.0, 40.0, 0.99), "sway_drag": Confirmation(-1.0, -3.0, 0.99)}
    found = Selection(best, False, 1, [], [best], [], [], entries)
    less = without_unconfirmed(continuation, found, instances)
    assert less.winner.hypothesis.label == "mass"
    assert list(less.confirmed) == ["mass"] and less.confirmed["mass"].holds


@pytest.mark.parametrize(("every", "result"), [(10, True), (1000, False)])
def test_residual_forces_need_positions_and_accept_a_slow_receiver(every: int, result: bool) -> None:
    sailed = driven([], np.stack([commands(0), commands(2)]), 0.0, seed=3)
    measured = sailed.measured.copy()
    measured[:, np.arange(measured.shape[1]) % every > 0, :2] = np.nan
    sparse = replace(sailed, measured=measured)
    weight = weights(sparse, noise_levels(sailed))
    forces = residual_forces(sparse, weight, Hypothesis(), np.zeros(0))
    assert (len(forces.force) > 10) == result
    assert residual_force_functions(sparse, weight, [(Hypothesis(), np.zeros(0))]) == []


def test_the_loss_of_a_window_that_diverges_is_infinite() -> None:
    loss = losses(np.array([[3.0, 4.0], [np.nan, 1.0], [np.inf, 1.0], [1e200, 1.0]]))
    assert loss[0] == 25.0
    assert np.isposinf(loss[1:]).all()

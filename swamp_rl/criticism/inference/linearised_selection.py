"""Selection on many twins at once: the criterion of answer and competitors, linearised about them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.windows import window_data
from swamp_rl.criticism.likelihood.cross_validation import folds_of
from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian, state_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import normal_equations
from swamp_rl.criticism.likelihood.output_error import (
    Fit,
    bounded_step,
    fit,
    inverse,
    noise_free,
    prior_penalty,
)
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, joined
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.continuation import Continuation
from swamp_rl.criticism.selection.information_criterion import InformationCriterion
from swamp_rl.criticism.selection.score_test import neutral_start, score_tests_from_neutral
from swamp_rl.criticism.selection.small_effects import is_small

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Competitor:
    """A hypothesis on N twins, to second order.

    information: (W, p, p) of each window, initial states eliminated; gradient: (W, p, N); profile_chi2:
    (W, N) at x (p,).
    """

    hypothesis: Hypothesis
    x: Array
    information: Array
    gradient: Array
    profile_chi2: Array

    @property
    def is_finite(self) -> bool:
        """Whether the boat did not diverge."""
        parts = (self.information, self.gradient, self.profile_chi2)
        return all(bool(np.isfinite(part).all()) for part in parts)

    def chi2(self) -> Array:
        """(N,) least chi2 within the bounds, prior included."""
        mean, precision = self.hypothesis.prior()
        H = self.information.sum(axis=0) + np.diag(precision)
        found = self.profile_chi2.sum(axis=0) + prior_penalty(self.hypothesis, self.x)
        bounds = self.hypothesis.bounds()
        for twin in range(len(found)):
            g = self.gradient[..., twin].sum(axis=0) - precision * (self.x - mean)
            step = bounded_step(H, g, self.x, *bounds)
            found[twin] += float(step @ H @ step - 2.0 * g @ step)
        return found

    def held_out_chi2(self, folds: NDArray[np.int64]) -> Array:
        """(N,) of every fold under the parameters of the others, see `heldout_loss`; folds: (W,)."""
        mean, precision = self.hypothesis.prior()
        found = self.profile_chi2.sum(axis=0)
        for fold in np.unique(folds):
            mine = folds == fold
            H, g = self.information[mine].sum(axis=0), self.gradient[mine].sum(axis=0)
            others = self.information[~mine].sum(axis=0) + np.diag(precision)
            pull = self.gradient[~mine].sum(axis=0) - (precision * (self.x - mean))[:, None]
            step = inverse(others) @ pull
            found += np.einsum("pn,pq,qn->n", step, H, step) - 2.0 * (g * step).sum(axis=0)
        return found


def linearised_answers(
    continuation: Continuation,
    found: Selection,
    noises: Sequence[Array],
    instances: Sequence[EffectInstance],
) -> list[Hypothesis]:
    """The hypothesis that each twin selects. noises: (R, T, 6) of each twin; instances: all candidates."""
    winner = found.winner
    problem = noise_free(continuation.problem(found.stage, winner.hypothesis), winner)
    noise = np.stack([_standardised(problem, one) for one in noises], axis=2)
    at = _fitted(problem, winner.hypothesis, winner.x, winner.states)
    fits = [at, *_competing_fits(problem, continuation, found, at, instances)]
    made = [_competitor(problem, one.hypothesis, one.x, one.states, at, noise) for one in fits]
    made += _with_one_more(problem, at, instances, noise)
    competitors = {one.hypothesis.label: one for one in made if one.is_finite}
    return _selected(competitors, folds_of(problem.windows), continuation.criterion)


def _fitted(problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array) -> Fit:
    return fit(problem, hypothesis, x, states, options().check_steps, fresh=True)


def _standardised(problem: Shooting, noise: Array) -> Array:
    """(W, M) noise (R, T, 6) in the windows, in standard deviations, as the likelihood sees it."""
    win = problem.windows
    noisy = replace(problem.run_set, measured=noise)
    cut, _ = window_data(noisy, problem.weight, win.run, win.first, win.steps, win.pad)
    return problem.standardised(cut)


def _competing_fits(
    problem: Shooting,
    continuation: Continuation,
    found: Selection,
    at: Fit,
    instances: Sequence[EffectInstance],
) -> list[Fit]:
    """Noise-free fits within reach: the answer less an effect or with another, rivals, and what was tried."""
    criterion, winner = continuation.criterion, found.winner
    short = continuation.fits.get((0, winner.hypothesis.label))
    limit = -np.inf if short is None else criterion(short) + options().twin_out_of_reach
    near = [one for one in found.tried if criterion(one) < limit]
    starts = {one.hypothesis.label: one for one in [*near, *found.rivals]}
    made: dict[str, Fit] = {}
    for instance in winner.hypothesis.instances:
        less = winner.hypothesis.without(instance.label)
        if _is_out_of_reach(continuation, winner.hypothesis, less):
            continue
        simpler = made[less.label] = _fitted(problem, *joined(at.parts(but=instance.label)), at.states)
        made |= _replacements(problem, criterion, simpler, criterion(at), instances)
    for label, one in starts.items():
        if label not in made and label != at.hypothesis.label:
            made[label] = _fitted(problem, one.hypothesis, one.x, at.states)
    return list(made.values())


def _is_out_of_reach(continuation: Continuation, whole: Hypothesis, less: Hypothesis) -> bool:
    """Whether the measured runs refuse `less` beside `whole`, at a stage, beyond what noise could change."""
    criterion, fits = continuation.criterion, continuation.fits
    return any(
        criterion(fits[stage, less.label]) > criterion(one) + options().twin_out_of_reach
        for (stage, label), one in fits.items()
        if label == whole.label and (stage, less.label) in fits
    )


def _replacements(
    problem: Shooting,
    criterion: InformationCriterion,
    simpler: Fit,
    best: float,
    instances: Sequence[EffectInstance],
) -> dict[str, Fit]:
    """Fits of `simpler` with one effect more, those within reach of the criterion `best` by score tests."""
    gradual = [one for one in instances if _is_gradual(one)]
    scores = sorted(score_tests_from_neutral(problem, simpler, gradual), key=criterion.expected)
    return {
        one.hypothesis.label: _fitted(problem, one.hypothesis, one.x, one.states)
        for one in scores[: options().twin_fits]
        if criterion.expected(one) < best + options().twin_within_reach
    }


def _is_gradual(instance: EffectInstance) -> bool:
    """Whether an effect grows from its neutral values, as one of an instant or a frequency does not."""
    return is_small(instance) and instance.effect.begin != "spectral"


def _with_one_more(
    problem: Shooting, at: Fit, instances: Sequence[EffectInstance], noise: Array
) -> list[Competitor]:
    """The answer with each further effect, begun from its neutral values; noise: (W, M, N)."""
    kept = {one.label for one in at.hypothesis.instances}
    found = []
    for instance in instances:
        if instance.label in kept or not _is_gradual(instance):
            continue
        own = np.array(neutral_start(instance, problem.boat) * instance.count)
        more, x = joined([*at.parts(), (instance, own)])
        found.append(_competitor(problem, more, x, at.states, at, noise))
    return found


def _competitor(
    problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array, at: Fit, noise: Array
) -> Competitor:
    base = problem.track(hypothesis, x, states)
    by_state = at.states_jacobian
    if not np.array_equal(states, at.states):
        by_state = state_jacobian(problem, hypothesis, x, states, base)
    by_x = parameter_jacobian(problem, hypothesis, x, states, base)
    residual = problem.residuals(base)
    columns = np.concatenate([by_x, residual[..., None] + noise], axis=2)
    normal, size = normal_equations(by_state, columns, np.zeros_like(residual)), hypothesis.size
    squares = np.einsum("wnn->wn", normal.information[:, size:, size:])
    return Competitor(
        hypothesis, x, normal.information[:, :size, :size], normal.information[:, :size, size:], squares
    )


def _selected(
    competitors: Mapping[str, Competitor], folds: NDArray[np.int64], criterion: InformationCriterion
) -> list[Hypothesis]:
    """Of each twin the hypothesis of least criterion, less the effects that held-out runs do not confirm."""
    held_out = {label: one.held_out_chi2(folds) for label, one in competitors.items()}
    values = {label: one.chi2() + criterion.charge(one.hypothesis) for label, one in competitors.items()}
    labels = list(values)
    best = np.argmin([values[label] for label in labels], axis=0)
    return [
        _confirmed(competitors[labels[place]].hypothesis, {k: v[twin] for k, v in held_out.items()})
        for twin, place in enumerate(best)
    ]


def _confirmed(hypothesis: Hypothesis, held_out: Mapping[str, float]) -> Hypothesis:
    """The hypothesis less what does not help on held-out runs, as far as other runs can confirm it."""
    for instance in hypothesis.instances:
        less = hypothesis.without(instance.label)
        known = less.label in held_out and not instance.groups
        if known and held_out[less.label] <= held_out[hypothesis.label]:
            return _confirmed(less, held_out)
    return hypothesis

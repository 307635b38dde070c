"""The force that no named effect explains, as effects `force_curve` of the extended boat.

Functions of the residual force are fitted by output error and selected by chi2 on held-out halves of runs. A
formula replaces the knots where its criterion is no greater. What is written reduces the position error.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.cause_share import Witness, shares_of
from swamp_rl.criticism.inference.estimate import causes_of
from swamp_rl.criticism.inference.force_curves import (
    Function,
    curve_instances,
    formula_instances,
    with_knots_moved,
)
from swamp_rl.criticism.inference.sandwich_covariance import sandwich_covariance
from swamp_rl.criticism.likelihood.cross_validation import (
    Confirmation,
    confirmed_at,
    halves_of,
    numbers_without,
    saturated,
)
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, first_states, fit, fit_states, losses
from swamp_rl.criticism.likelihood.prediction_error import Errors, blocks_of, errors_at
from swamp_rl.criticism.model.candidates import Hypothesis, joined
from swamp_rl.criticism.options import options
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.result import Extension, ForceCurve, HeldOut, ResidualForce, Share
from swamp_rl.criticism.selection.information_criterion import information_criterion
from swamp_rl.effects import LIBRARY, EffectEntry
from swamp_rl.effects.curve import Curve
from swamp_rl.effects.entries import entry_mapping

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ForceExtension:
    """result: for diagnosis.json; less, fit: without the force and with it, on the windows of `problem`."""

    result: Extension
    problem: Shooting
    less: Fit
    fit: Fit

    @property
    def entries(self) -> list[dict[str, Any]]:
        """The curves as a boat file holds them, with their standard errors."""
        effect = LIBRARY["force_curve"]
        return [
            entry_mapping(EffectEntry(effect, thruster, values, curve))
            for curve, thruster, values in _curves(self.problem, self.fit)
        ]


def extend_by_force(
    run_set: RunSet,
    weight: Array,
    base: Fit,
    leftover: Sequence[ResidualForce],
    judged: Witness,
    rng: np.random.Generator,
) -> ForceExtension | None:
    """The functions of the residual force beside the effects of `base` as effects; None where none holds.

    leftover: the functions, and what they were estimated beside. weight: (R, T, 6). judged: runs that the
    prediction error is of.
    """
    problem = Shooting(run_set, weight, options().regression_spans[0])
    named = base.hypothesis if leftover and leftover[0].beside else Hypothesis()
    less = _fitted(problem, named, base.x[: named.size])
    at, waiting = less, curve_instances(run_set, leftover) if leftover else []
    comparisons = max(1, len(waiting))
    before = held_out_losses(problem, at)
    for _ in range(min(options().most_functions, len(waiting))):
        added = [zip(one.instances, one.starts, strict=True) for one in waiting]
        fits = [_fitted(problem, *joined([*at.parts(), *one]), at.states) for one in added]
        held_out = [held_out_losses(problem, one) for one in fits]
        best = int(np.argmin([np.nan_to_num(one.sum(), nan=np.inf) for one in held_out]))
        gain = confirmed_at(before - held_out[best], comparisons)
        if not (gain.gains if at is less else gain.holds):
            break
        at, before = _with_knots_moved(problem, fits[best], held_out[best], waiting[best])
        waiting = [one for one in waiting if one is not waiting[best]]
    if at is less:
        return None
    at = _with_formulas(problem, at, run_set.boat)
    LOG.info("missing force: %s", at.hypothesis.label)
    shares = prediction_shares(problem, less, at, judged, rng)
    gains = held_out_losses(problem, less) - held_out_losses(problem, at)
    result = _extension(problem, at, confirmed_at(gains, comparisons), shares)
    return ForceExtension(result, problem, less, at)


def is_better(shares: Sequence[Share], confirmed: bool = False) -> bool:
    """Whether a position error falls beyond chance and none, nor one of heading, rises on held-out runs.

    confirmed: by chi2, where each error need only not rise: a force that acts in few stretches of the runs
    decreases a root mean square by these alone, whose interval includes zero.
    """
    gains = [one for one in shares if one.quantity == "position_rmse_m"]
    return any(confirmed or one.ci95[0] > 0.0 for one in gains) and all(
        one.ci95[1] > 0.0 and (one.quantity != "position_rmse_m" or one.with_cause <= one.without)
        for one in shares
    )


def held_out_losses(problem: Shooting, at: Fit) -> Array:
    """(W,) saturated chi2 of each window, n ln(1 + chi2 / n), under the parameters fitted to all but the half
    of its run that it is in; only the initial state is refitted.
    """
    loss, fold = at.loss.copy(), halves_of(problem.windows)
    if at.hypothesis.size:
        for number, x in enumerate(numbers_without(at, fold, 2 * len(problem.run_set.lengths))):
            mine = fold == number
            if not mine.any():
                continue
            part, rounds = problem.part(mine), options().first_rounds
            residual = fit_states(part, at.hypothesis, x, at.states[mine], rounds)[2]
            loss[mine] = (residual**2).sum(axis=1)
    return saturated(problem, loss)


def _fitted(problem: Shooting, hypothesis: Hypothesis, x: Array, states: Array | None = None) -> Fit:
    """states: (W, 6) of another fit, or None. They are left out in windows that they fit worse than the
    measured ones do, as where they made up for a force that now acts.
    """
    start = problem.initial_states()
    if states is not None:
        own, given = (losses(problem.residuals(problem.track(hypothesis, x, s))) for s in (start, states))
        start = np.where((given <= own)[:, None], states, start)
    states = first_states(problem, hypothesis, x, start)
    return fit(problem, hypothesis, x, states, options().again_steps, fresh=True)


def _with_knots_moved(problem: Shooting, at: Fit, held_out: Array, function: Function) -> tuple[Fit, Array]:
    """The fit with the knots of a function where its force changes most, and its held-out losses (W,); as
    long as these fall by `regression_gain`. Knots at quantiles do not resolve a step between two of them.
    """
    for label in [one.label for one in function.instances]:
        for _ in range(options().knot_rounds):
            ((instance, values),) = [(one, x) for one, x in at.parts() if one.label == label]
            moved = with_knots_moved(problem.run_set, instance, values)
            if moved is None:
                break
            tried = _fitted(problem, *joined([*at.parts(but=label), moved]), at.states)
            own = held_out_losses(problem, tried)
            if not held_out.sum() - own.sum() > options().regression_gain:
                break
            at, held_out = tried, own
    return at, held_out


def _with_formulas(problem: Shooting, at: Fit, boat: Boat) -> Fit:
    """The fit with formulas in place of knots where the information criterion is then no greater.

    chi2 is divided by its mean a sample where that exceeds one: what the force leaves is no white noise then
    (quasi-likelihood, Burnham and Anderson 2002, 2.5).
    """
    excess = max(1.0, at.chi2 / problem.samples)
    criterion = information_criterion(problem.run_set, float(problem.samples))
    for instance in [one for one in at.hypothesis.instances if one.curve]:
        own = at.hypothesis.columns(instance.label)
        error = np.sqrt(np.maximum(np.diag(sandwich_covariance(problem, at))[own], 1e-30))
        tried = [at]
        for formula, start in formula_instances(boat, instance, at.x[own], error):
            swapped = joined([*at.parts(but=instance.label), (formula, start)])
            tried.append(_fitted(problem, *swapped, at.states))
        at = min(tried, key=lambda one: one.chi2 / excess + criterion.charge(one.hypothesis))
    return at


def prediction_shares(
    problem: Shooting, less: Fit, whole: Fit, judged: Witness, rng: np.random.Generator
) -> list[Share]:
    """Prediction errors without the force and with it, on other runs or on held-out halves of the same."""
    shares = []
    for horizon in options().judged_horizons:
        before, after = (_errors(problem, one, judged, horizon) for one in (less, whole))
        block, _ = blocks_of(before, horizon)
        shares += shares_of(before.error, after.error, block, horizon, rng)
    return shares


def _errors(problem: Shooting, at: Fit, judged: Witness, horizon: float) -> Errors:
    """Of predictions that lie within a fold, under the parameters fitted to the others; `run` is the fold."""
    run_set, weight = judged.run_set, judged.weight
    runs, win = len(run_set.lengths), problem.windows
    if judged.others:
        return errors_at(run_set, weight, horizon, *judged.numbers(problem, at))
    fold = halves_of(win)
    numbers = numbers_without(at, fold, 2 * runs)
    found = []
    for half in range(2):
        low, high = np.full(runs, np.inf), np.full(runs, -np.inf)
        for run in np.unique(win.run):
            mine = fold == 2 * run + half
            if mine.any():
                low[run] = (win.first[mine].min() + win.pad) * run_set.dt
                high[run] = (win.first[mine] + win.steps[mine]).max() * run_set.dt
        errors = errors_at(run_set, weight, horizon, at.hypothesis, numbers[half::2])
        inside = (errors.end <= high[errors.run] + 1e-9) & (errors.end - horizon >= low[errors.run] - 1e-9)
        found.append((errors.error[inside], 2 * errors.run[inside] + half, errors.end[inside]))
    error, run, end = (np.concatenate(column) for column in zip(*found, strict=True))
    return Errors(error, run, end)


def _extension(problem: Shooting, at: Fit, found: Confirmation, shares: list[Share]) -> Extension:
    """The extension for diagnosis.json."""
    curves = [
        ForceCurve(
            component=curve.component,
            covariate=curve.covariate,
            thruster=thruster,
            formula=curve.formula,
            knots=[curve.knots[0], curve.knots[-1]] if curve.formula else list(curve.knots),
            values=curve.listed(values),
            standard_errors=list(curve.standard_errors),
            units=list(curve.units if curve.formula else curve.units[:1]),
        )
        for curve, thruster, values in _curves(problem, at)
    ]
    return Extension(
        curves=curves,
        beside=causes_of(problem, at),
        held_out=HeldOut(gain=found.gain, low=found.low, level=found.level),
        share=shares,
        written=found.gain > 0.0 and is_better(shares, found.holds),
    )


def _curves(problem: Shooting, at: Fit) -> list[tuple[Curve, str | None, dict[str, float]]]:
    """Each curve with its standard errors, its thruster and its values by name."""
    error = np.sqrt(np.maximum(np.diag(sandwich_covariance(problem, at)), 0.0))
    found = []
    for instance, x in at.parts():
        if instance.curve:
            names = instance.curve.value_names
            doubt = dict(zip(names, error[at.hypothesis.columns(instance.label)], strict=True))
            curve = replace(instance.curve, standard_errors=tuple(instance.curve.listed(doubt)))
            values = {name: float(value) for name, value in zip(names, x, strict=True)}
            found.append((curve, instance.selectors[0] if instance.selectors else None, values))
    return found

"""Reconstruction of commands between samples: held, interpolated, or switched at a fitted instant."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import Instants, RunSet
from swamp_rl.criticism.likelihood.adequacy import adequacy
from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import normal_equations
from swamp_rl.criticism.likelihood.output_error import Fit, bounded_step, fit, min_decrease
from swamp_rl.criticism.model.candidates import Hypothesis, joined
from swamp_rl.criticism.nuisance.command_timing import command_changes, interpolated_at
from swamp_rl.criticism.nuisance.switching_times import (
    ShareEquations,
    cost_of_shares,
    departures,
    mean_share,
    moved_shares,
    promised_gain,
    share_equations,
)
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.backward_elimination import Selection, fit_by_continuation, indispensable
from swamp_rl.criticism.selection.continuation import LAST, MIDDLE, Continuation, states_carried

Array = NDArray[np.float64]
Kept = tuple[Hypothesis, Array]
Accepts = Callable[[Continuation, Selection, Continuation, Selection], bool]
Attempt = tuple[RunSet, Kept, Accepts]


def interpolated(run_set: RunSet, share: float) -> RunSet:
    """The runs with every command moved by a share of its change until the next row."""
    change = command_changes(run_set)
    return interpolated_at(run_set, change, np.full(change.shape[:2], share))


def better_reconstruction(continuation: Continuation, at: Fit, logged: RunSet) -> RunSet | None:
    """The runs with reconstructed commands where these lower chi2 on the middle windows clearly, or None.

    Compared at the selected hypothesis, since shifted commands could absorb a missing effect.
    """
    key = at.hypothesis.label, at.x.tobytes()
    if key not in continuation.reconstructed:
        continuation.reconstructed[key] = _better_reconstruction(continuation.problems[MIDDLE], at, logged)
    return continuation.reconstructed[key]


def _better_reconstruction(problem: Shooting, at: Fit, logged: RunSet) -> RunSet | None:
    if at.chi2 > options().reconstruction_hopeless * problem.samples:
        return None
    above_noise = at.chi2 - options().variance_bias * problem.samples
    least = max(options().reconstruction_gain, options().reconstruction_share * above_noise)
    if problem.run_set.fitted_instants:
        return _refined(problem, at, logged, least)
    return _reconstruction(problem, at, logged, least, options().reconstruction_most * problem.samples)


def reconstruction_on_whole_runs(
    continuation: Continuation, at: Fit, logged: RunSet, instead: Fit | None = None
) -> RunSet | None:
    """The runs with reconstructed commands where these lower chi2 of whole runs clearly, or by more than the
    further effects of a fit `instead` of them do, or None. Instants are fitted to the middle windows first,
    and those that are known beside the effects anew; commands in gaps are those that fit best.
    """
    whole = continuation.at(LAST, at)
    problem = continuation.problem(LAST, at.hypothesis)
    if whole.chi2 > options().reconstruction_hopeless * problem.samples:
        return None
    commands = logged.commands.copy()
    for gap in continuation.gaps:
        rows = slice(gap.row, gap.row + gap.rows)
        commands[gap.run, rows] = problem.run_set.commands[gap.run, rows]
    filled = replace(logged, commands=commands)
    if problem.run_set.fitted_instants:
        return _refined(problem, whole, filled, min_decrease(problem, whole.chi2))
    least = options().reconstruction_gain
    if instead is not None:
        gained = continuation.criterion(whole) - continuation.criterion(continuation.at(LAST, instead))
        least = min(least, max(gained, 0.0))
    middle = continuation.problems[MIDDLE]
    share, shared = fit_common_share(middle, continuation.at(MIDDLE, at), logged)
    each, made, _ = fit_switching_times(middle, shared, logged, share)
    states = states_carried(middle, made.states, problem, whole.states)
    begin = each.instants, replace(whole, x=made.x, states=states)
    return _reconstruction(problem, whole, filled, least, math.inf, begin)


def _reconstruction(
    problem: Shooting,
    at: Fit,
    logged: RunSet,
    least: float,
    most: float,
    begin: tuple[Instants | None, Fit] | None = None,
) -> RunSet | None:
    """The runs with commands that lower the chi2 of a fit by `least`, to less than `most`, or None: moved by
    one share of every step, or where that saves more by one of each step.

    begin: instants to begin from, and the fit with them.
    """
    best = None
    share, shared = fit_common_share(problem, at, logged)
    if shared.chi2 < min(at.chi2 - least, most):
        best = interpolated(logged, share)
    known, start = begin or (None, shared)
    if best:  # which they must save in addition
        least = max(least, at.chi2 - shared.chi2 + options().reconstruction_gain)
    wanted = min(at.chi2 - least, most)
    each, made, cost = fit_switching_times(problem, start, logged, share, known, wanted, costs=True)
    return each if made.chi2 < min(at.chi2 - least - cost, most) else best


def _refined(problem: Shooting, at: Fit, logged: RunSet, least: float) -> RunSet | None:
    """The runs with the fitted instants of a problem fitted anew beside the effects of a fit, where that
    lowers its chi2 by `least`, or None.
    """
    known, wanted = problem.run_set.fitted_instants, at.chi2 - least
    each, made, _ = fit_switching_times(problem, at, logged, 0.0, known, wanted)
    return each if made.chi2 < wanted else None


def reconstruction_without_timing(continuation: Continuation, at: Fit, logged: RunSet) -> RunSet | None:
    """The runs with commands reconstructed so that a fit to the middle windows needs no effect that shifts
    the actuators in time, or None. A log that lags behind the commands is equivalent to faster actuators.
    """
    problem = continuation.problems[MIDDLE]
    less, x = without_timing(at)
    if less == at.hypothesis:
        return None
    plain = fit(problem, less, x, at.states, options().again_steps)
    most = continuation.criterion(at) + problem.run_set.instants_cost
    most += options().strong_evidence - continuation.criterion.charge(less)
    share, shared = fit_common_share(problem, plain, logged)
    other = interpolated(logged, share)
    changes = not np.array_equal(other.commands, problem.run_set.commands)
    if changes and shared.chi2 < most and adequacy(problem, shared).adequate:
        return other
    known = problem.run_set.fitted_instants
    each, made, cost = fit_switching_times(problem, shared, logged, share, known, most, costs=True)
    saves = made.chi2 + cost < most
    return each if saves and adequacy(problem, made).adequate else None


def other_commands(
    continuation: Continuation, found: Selection, logged: RunSet, spent: bool
) -> Iterator[Attempt]:
    """Runs with reconstructed commands that are worth another search, the likeliest first; the effects, and
    their parameters (p,), beside which they were found; and what that search must do better than `found`.

    spent: no other search is left, so that the commands must be enough for the effects found.
    """
    at = continuation.at(MIDDLE, found.winner)
    own = at.hypothesis, at.x
    if not found.adequate:
        find = sufficient_reconstruction if spent else better_reconstruction
        yield from _attempt(find(continuation, at, logged), own, is_better)
        return
    refines = continuation.problems[MIDDLE].run_set.fitted_instants and at.hypothesis.instances
    other = better_reconstruction(continuation, at, logged) if refines or not spent else None
    if other:
        yield other, own, is_better
        return
    other = reconstruction_without_timing(continuation, at, logged)
    if other:
        yield other, without_timing(at), is_simpler
        return
    shown = [one for one, _ in at.parts() if indispensable(continuation, found.winner, one.label, LAST)]
    if len(shown) < len(at.hypothesis.instances):
        kept = joined(part for part in at.parts() if part[0] in shown)
        less = fit_by_continuation(continuation, *kept)
        other = reconstruction_on_whole_runs(continuation, less, logged, found.winner)
        yield from _attempt(other or better_reconstruction(continuation, less, logged), kept, is_simpler)
    # instants beside one of the rivals would favour it over the others
    if (found.stage < LAST or refines) and not found.rivals:
        other = reconstruction_on_whole_runs(continuation, at, logged)
        yield from _attempt(other, own, is_noise_on_whole_runs)


def _attempt(other: RunSet | None, kept: Kept, accepts: Accepts) -> Iterator[Attempt]:
    if other is not None:
        yield other, kept, accepts


def without_timing(at: Fit) -> Kept:
    """The effects of a fit that do not shift the actuators in time, and their parameters (p,)."""
    return joined((instance, own) for instance, own in at.parts() if not instance.moves_actuators)


def fit_common_share(problem: Shooting, at: Fit, logged: RunSet) -> tuple[float, Fit]:
    """The share of a step, common to all commands, at least chi2 under a hypothesis, and the fit with it: by
    Gauss-Newton steps in the share, the parameters and the initial states, as long as they promise to save
    what a fit goes on for.
    """
    share, made = 0.0, at if logged.commands is problem.run_set.commands else _refit(problem, logged, at)
    for _ in range(options().common_share_rounds):
        moved, x, states, promised = _share_step(problem, made, logged, share)
        if not promised >= min_decrease(problem, made.chi2):  # or a simulation diverged
            break
        there = _problem(problem, interpolated(logged, moved))
        again = fit(there, made.hypothesis, x, states, options().again_steps)
        if again.chi2 >= made.chi2:
            break
        share, made = moved, again
    return share, made


def _share_step(
    problem: Shooting, at: Fit, logged: RunSet, share: float
) -> tuple[float, Array, Array, float]:
    """Share, parameters (p,) and states (W, 6) after a Gauss-Newton step from a fit with that share of every
    command's change, and the fall of chi2 that it promises.
    """
    by = options().common_share_step
    by = -by if share + by > 1.0 else by
    here, there = (_problem(problem, interpolated(logged, one)) for one in (share, share + by))
    where = at.hypothesis, at.x, at.states
    base = here.track(*where)
    by_share = here.standardised((there.track(*where) - base) / by)
    slopes = np.concatenate([parameter_jacobian(here, *where, base), by_share[..., None]], axis=2)
    normal, size = normal_equations(at.states_jacobian, slopes, at.residual), at.hypothesis.size
    H, g = normal.information.sum(axis=0), normal.gradient.sum(axis=0)
    H[:size, :size] += at.hypothesis.prior_precision
    g[:size] -= at.hypothesis.prior_precision @ (at.x - at.hypothesis.prior()[0])
    low, high = at.hypothesis.bounds()
    now = np.append(at.x, share)
    step = bounded_step(H, g, now, np.append(low, 0.0), np.append(high, 1.0))
    promised = float(2.0 * g @ step - step @ H @ step)
    return float((now + step)[-1]), at.x + step[:-1], at.states + normal.shift(step), promised


def sufficient_reconstruction(continuation: Continuation, at: Fit, logged: RunSet) -> RunSet | None:
    """The runs with reconstructed commands if these alone make a fit to the middle windows adequate."""
    found = sufficiently_reconstructed(continuation, at, logged)
    return found[0] if found else None


def sufficiently_reconstructed(
    continuation: Continuation, at: Fit, logged: RunSet
) -> tuple[RunSet, Fit] | None:
    """As `sufficient_reconstruction`, with the fit to the middle windows."""
    problem = continuation.problems[MIDDLE]
    if adequacy(problem, at).adequate:
        return None
    other = better_reconstruction(continuation, at, logged)
    made = _refit(problem, other, at) if other else at
    return (other, made) if other and adequacy(problem, made).adequate else None


def fit_switching_times(
    problem: Shooting,
    at: Fit,
    logged: RunSet,
    share: float,
    begin: Instants | None = None,
    wanted: float = math.inf,
    costs: bool = False,
) -> tuple[RunSet, Fit, float]:
    """The runs with a fitted share for each larger step, their fit, and their cost (`cost_of_shares`), begun
    from known ones, or from one common share; at: a fit with these. Given up where rounds that all gain as
    much as the last one would not bring chi2 below what is wanted. costs: whether that holds for chi2 and the
    cost together; the normal equations then have to promise as much.
    """
    change = command_changes(logged)
    shares = np.full(change.shape[:2], share)
    if begin:
        large = np.abs(change).max(axis=2) > options().smallest_change
        shares, share = begin.shares, float(begin.shares[large].mean()) if large.any() else share
    best = interpolated_at(logged, change, shares)
    least = _refit(problem, best, at, fresh=True)
    damping, enough = np.zeros(len(shares)), options().reconstruction_gain
    least_damping, factor, tries = options().instants_damping
    equations = list[ShareEquations]()
    for left in reversed(range(options().reconstruction_rounds)):
        equations = share_equations(_problem(problem, best), least, change, shares, share)
        cost = cost_of_shares(equations, shares, share) if costs else 0.0
        if costs and least.chi2 + cost - options().instants_reach * promised_gain(equations) > wanted:
            break
        others = shares if begin else np.full_like(shares, share)
        prior = departures(equations, shares, share)
        for _ in range(tries):
            moved = moved_shares(equations, least, shares, others, damping)
            run_set = interpolated_at(logged, change, moved)
            made = _refit(problem, run_set, least, fresh=True)
            rise = departures(equations, moved, share) - prior
            rise += np.bincount(problem.windows.run, made.loss - least.loss, len(shares))
            gain = least.penalty - made.penalty - float(rise.sum())
            worse = rise > 0.0 if (rise > 0.0).any() else rise <= 0.0
            if gain > 0.0:
                break
            damping = np.where(worse, np.maximum(factor * damping, least_damping), damping)
        if gain > 0.0:
            best, least, shares = run_set, made, moved
            damping = np.where(rise > 0.0, damping, damping / factor)
        share = mean_share(equations, shares, share)
        # after the first round, the gain that is enough is that of a fit
        if gain < enough or least.chi2 + cost - left * gain > wanted:
            break
        enough = min_decrease(problem, least.chi2)
    cost = cost_of_shares(equations, shares, share)
    return replace(best, instants=Instants(change, shares, cost)), least, cost


def _refit(problem: Shooting, run_set: RunSet, at: Fit, fresh: bool = False) -> Fit:
    """The fit repeated on the same windows with other commands."""
    return fit(_problem(problem, run_set), at.hypothesis, at.x, at.states, options().again_steps, fresh)


def _problem(problem: Shooting, run_set: RunSet) -> Shooting:
    made = problem.run_set.with_commands_of(run_set)
    return Shooting(made, problem.weight, problem.seconds, problem.windows)


def is_refuted(before: Continuation, found: Selection, after: Continuation) -> bool:
    """Whether whole runs, each gap with its own best-fitting commands, fit a selected hypothesis that is
    adequate there no better with reconstructed commands: the middle windows have the logged ones in gaps.
    """
    if not (found.adequate and found.stage >= LAST):
        return False
    fit_by_continuation(after, found.winner.hypothesis, found.winner.x)
    return after.criterion(after.at(LAST, found.winner)) >= before.criterion(found.winner)


def is_better(before: Continuation, found: Selection, after: Continuation, again: Selection) -> bool:
    """Whether a selection with reconstructed commands ends clearly better."""
    return again.adequate > found.adequate or (
        again.adequate == found.adequate
        and saved(before, found, after, again) > options().reconstruction_gain
    )


def saved(before: Continuation, found: Selection, after: Continuation, again: Selection) -> float:
    """Fall of the criterion, the cost of the instants included, on the longest windows that both fit."""
    stage = min(found.stage, again.stage)
    reached = [
        continuation.criterion(continuation.at(stage, one.winner)) + continuation.run_set.instants_cost
        for continuation, one in ((before, found), (after, again))
    ]
    return reached[0] - reached[1]


def is_noise_on_whole_runs(
    before: Continuation, found: Selection, after: Continuation, again: Selection
) -> bool:
    """Whether a selection with reconstructed commands leaves noise on whole runs with no more effects."""
    fewest = len(found.winner.hypothesis.instances)
    return again.adequate and again.stage >= LAST and len(again.winner.hypothesis.instances) <= fewest


def is_simpler(before: Continuation, found: Selection, after: Continuation, again: Selection) -> bool:
    """Whether a selection with reconstructed commands explains as much by fewer effects, or clearly more, on
    windows that are no shorter.
    """
    fewer = len(again.winner.hypothesis.instances) < len(found.winner.hypothesis.instances)
    least = -options().strong_evidence if fewer else options().reconstruction_gain
    reaches = again.adequate and again.stage >= found.stage
    return reaches and saved(before, found, after, again) > least

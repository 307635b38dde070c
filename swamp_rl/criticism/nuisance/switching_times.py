"""Switching times: the share of a change of commands that a row before it takes on, of each large one."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import normal_equations
from swamp_rl.criticism.likelihood.output_error import Fit, bounded_step
from swamp_rl.criticism.model.scales import window_lengths
from swamp_rl.criticism.nuisance.command_timing import (
    command_changes,
    command_sensitivity,
    have_ramps,
    shifted_within,
)
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]

SPREAD = 12.0**-0.5  # standard deviation of a uniform distribution between two rows


@dataclass(frozen=True)
class ShareEquations:
    """Normal equations of the shares of n rows of a window, their Gaussian prior included and the initial
    state eliminated: information (n, n), gradient (n,), cross (n, p) with the fit's parameters.
    """

    run: int
    rows: NDArray[np.int64]
    information: Array
    gradient: Array
    cross: Array


def share_equations(
    problem: Shooting, at: Fit, change: Array, shares: Array, mean: float
) -> list[ShareEquations]:
    """Of every window that has rows whose commands change, about a fit to the commands that `shares` (R, T)
    gives; change: (R, T, 2K) until the next row; mean: of the prior.
    """
    found = []
    base = problem.track(at.hypothesis, at.x, at.states)
    by_x = parameter_jacobian(problem, at.hypothesis, at.x, at.states, base)
    for window, rows, slopes in share_slopes(problem, at, change, shares):
        run, n = int(problem.windows.run[window]), len(rows)
        both = np.concatenate([slopes, by_x[window]], axis=1)[None]
        normal = normal_equations(at.states_jacobian[window][None], both, at.residual[window][None])
        information = normal.information[0, :n, :n] + np.eye(n) * SPREAD**-2
        gradient = normal.gradient[0, :n] - (shares[run, rows] - mean) * SPREAD**-2
        found.append(ShareEquations(run, rows, information, gradient, normal.information[0, :n, n:]))
    return found


def moved_shares(
    equations: Sequence[ShareEquations], at: Fit, shares: Array, others: Array, damping: Array
) -> Array:
    """(R, T) shares after a Gauss-Newton step in them and in the fit's parameters, damped by a multiple (R,)
    of each information (Marquardt 1963); others: (R, T) those of rows that are not fitted.
    """
    damped = [one.information + damping[one.run] * np.diag(np.diag(one.information)) for one in equations]
    information = at.normal.information.sum(axis=0) + at.hypothesis.prior_precision
    gradient = np.zeros(at.hypothesis.size)
    for one, H in zip(equations, damped, strict=True):
        solved = np.linalg.solve(H, np.column_stack([one.cross, one.gradient]))
        information = information - one.cross.T @ solved[:, :-1]
        gradient = gradient - one.cross.T @ solved[:, -1]
    step = bounded_step(information, gradient, at.x, *at.hypothesis.bounds())
    moved = others.copy()
    for one, H in zip(equations, damped, strict=True):
        now = shares[one.run, one.rows]
        by = bounded_step(H, one.gradient - one.cross @ step, now, np.zeros(len(now)), np.ones(len(now)))
        moved[one.run, one.rows] = now + by
    return moved


def departures(equations: Sequence[ShareEquations], shares: Array, mean: float) -> Array:
    """(R,) chi2 of the shares (R, T) under their prior about a mean."""
    found = np.zeros(len(shares))
    for one in equations:
        found[one.run] += float((((shares[one.run, one.rows] - mean) / SPREAD) ** 2).sum())
    return found


def promised_gain(equations: Sequence[ShareEquations]) -> float:
    """Fall of chi2, the shares' own under their prior included, by a Gauss-Newton step in them alone."""
    return float(sum(one.gradient @ np.linalg.solve(one.information, one.gradient) for one in equations))


def mean_share(equations: Sequence[ShareEquations], shares: Array, otherwise: float) -> float:
    """Mean of shares (R, T), each weighted by what the data tell of it beside the prior."""
    if not equations:
        return otherwise
    fitted = np.concatenate([shares[one.run, one.rows] for one in equations])
    unknown = np.concatenate([np.diag(np.linalg.inv(one.information)) for one in equations]) * SPREAD**-2
    return float(np.average(fitted, weights=np.clip(1.0 - unknown, 1e-6, 1.0)))


def cost_of_shares(equations: Sequence[ShareEquations], shares: Array, mean: float) -> float:
    """What fitted shares (R, T) cost: they fit as much better as chance unless chi2 falls by more (-2 log
    marginal likelihood, Laplace's approximation).
    """
    volume = sum(float(np.linalg.slogdet(one.information * SPREAD**2)[1]) for one in equations)
    return volume + float(departures(equations, shares, mean).sum())


def unknown_instants(run_set: RunSet) -> tuple[Array, Array, Array]:
    """Change (R, T, 2K) of the commands until the next row where its instant is unknown, 0 elsewhere; share
    (R, T) of it that the row takes on; and the standard deviation of that share: between two rows, and in a
    gap whose command may have changed after any number n of its rows, sqrt(n (n + 2) / 12) of them.
    """
    logged, known = command_changes(run_set), run_set.instants
    change = known.change.copy() if known else np.zeros_like(logged)
    shares = known.shares if known else np.zeros(logged.shape[:2])
    spread = np.full(shares.shape, SPREAD)
    for gap in run_set.filled:
        steps = logged[gap.run, gap.row - 1 : gap.row + gap.rows]
        row = gap.row - 1 + int(np.abs(steps).max(axis=1).argmax())
        change[gap.run, row] = logged[gap.run, row]
        spread[gap.run, row] = SPREAD * np.sqrt(gap.rows * (gap.rows + 2.0))
    return change, shares, spread


def share_slopes(
    problem: Shooting, at: Fit, change: Array, shares: Array
) -> Iterator[tuple[int, NDArray[np.int64], Array]]:
    """Every window with rows whose commands change, these n rows, and the (M, n) derivatives of its weighted
    prediction by their shares; change (R, T, 2K) and shares (R, T) as of `share_equations`.
    """
    ramps = have_ramps(problem.run_set, change)
    for window, run in enumerate(problem.windows.run):
        rows = _fitted_rows(problem, window, change)
        if len(rows):
            slopes = _share_slopes(problem, at, window, rows, change[run], shares[run], ramps[run])
            yield window, rows, slopes


def _fitted_rows(problem: Shooting, window: int, change: Array) -> NDArray[np.int64]:
    """The rows of a window whose commands change most until the next one, as many as are fitted; change:
    (R, T, 2K).
    """
    win, most = problem.windows, options().most_instants
    run, first, steps = int(win.run[window]), int(win.first[window]), int(win.steps[window])
    size = np.abs(change[run, first : first + steps]).max(axis=1)
    long = most * steps * problem.dt / window_lengths(problem.run_set.boat)[-1]
    affordable = options().instants_steps / (steps * problem.run_set.parts)
    count = max(most, int(min(long, affordable)))
    count = min(count, int((size > options().smallest_change).sum()))
    return first + np.sort(np.argsort(-size, kind="stable")[:count])


def _share_slopes(
    problem: Shooting,
    at: Fit,
    window: int,
    rows: NDArray[np.int64],
    change: Array,
    shares: Array,
    ramp: bool,
) -> Array:
    """(M, n) derivative of a window's weighted prediction by the shares (T,) of n rows."""
    parts, each = problem.run_set.parts, np.arange(len(rows))
    now, step = shares[rows], np.full(len(rows), options().share_step)
    within = None
    if parts > 1:
        step[now + step > 1.0] *= -1.0  # beyond its end a row has no part left
        within = np.zeros((len(rows), len(change), parts, change.shape[1]))
        moved = (shifted_within(change[rows], share, parts, ramp) for share in (now + step, now))
        within[each, rows] = np.subtract(*moved)
    changes = np.zeros((len(rows), *change.shape))
    changes[each, rows] = step[:, None] * change[rows]
    slopes = command_sensitivity(problem, at, window, changes, within) / step[:, None]
    return np.moveaxis(slopes, 0, 1)

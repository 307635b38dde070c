"""Sandwich covariance (Huber-White) of the parameters of a fit."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.constants import Z95
from swamp_rl.criticism.inference.boat_errors import boat_file_covariance
from swamp_rl.criticism.likelihood.cross_validation import folds_of, numbers_without
from swamp_rl.criticism.likelihood.finite_differences import moved_together, parameter_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, inverse
from swamp_rl.criticism.nuisance.switching_times import share_slopes, unknown_instants
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


def sandwich_covariance(problem: Shooting, at: Fit) -> Array:
    """(p, p) covariance of x: `covariance_of_data`, and that by errors of the boat file's fitted numbers."""
    return covariance_of_data(problem, at) + boat_file_covariance(problem, at)


def covariance_of_data(problem: Shooting, at: Fit) -> Array:
    """(p, p) sandwich covariance (Huber-White) of x, widened by Student's t for the number of its blocks;
    where weights are the model error's, to the variances between runs, and to the least that errors of the
    model's curves allow (Gauss-Markov theorem), where those are larger.

    What an error of a curve does alike in all runs, no scatter between them shows.
    """
    covariance, freedom = scattered_covariance(problem, at)
    wider = _wider(freedom)
    covariance = np.asarray(covariance * np.outer(wider, wider))
    if problem.correlation_samples == 1.0 or not np.isfinite(covariance).all():
        return covariance
    variances = variances_between_runs(problem, at)
    if problem.least_variances is not None:
        least = problem.least_variances(at)
        variances = np.maximum(variances, np.where(np.isfinite(least), least, 0.0))
    ratio = variances / np.maximum(np.diag(covariance), 1e-300)
    wider = np.sqrt(np.maximum(ratio, 1.0))
    return np.asarray(covariance * np.outer(wider, wider))


def variances_between_runs(problem: Shooting, at: Fit) -> Array:
    """(p,) delete-one-group jackknife variances of x (CR3, Bell and McCaffrey, Bias reduction in standard
    errors for linear regression with multi-stage samples, Survey Methodology 28, 2002), widened by Student's
    t; 0 of what groups of runs have of their own. A group is a fold of the cross-validation.

    An error of the model repeats with the manoeuvre, so that the windows of one run are alike and their
    scatter is too small.
    """
    _, fold = np.unique(folds_of(problem.windows), return_inverse=True)
    count = int(fold.max()) + 1
    if count < 2 or not at.hypothesis.size:
        return np.zeros(at.hypothesis.size)
    away = numbers_without(at, fold, count) - at.x
    wider = _wider(np.full(at.hypothesis.size, count - 1.0))
    common = np.array([not one.groups for one in at.hypothesis.instances for _ in one.specs])
    return np.asarray(np.where(common, wider**2 * (count - 1) / count * (away**2).sum(axis=0), 0.0))


def _wider(freedom: Array) -> Array:
    """Quantiles of Student's t over those of the normal distribution, of an interval's ends."""
    from scipy.special import stdtrit

    return np.asarray(stdtrit(freedom, 1.0 - options().tail) / Z95)


def scattered_covariance(problem: Shooting, at: Fit) -> tuple[Array, Array]:
    """(p, p) inverse Fisher information, less what unknown instants of commands take of it, widened
    where the scores of blocks scatter more than white noise of the estimated variance would; and (p,) degrees
    of freedom of that scatter, infinite where the blocks are too few and nothing is widened.

    A block is `score_stretch` long, or a window where weights are the model error's. The same parameter of
    several groups of runs is widened alike, since a group alone has few blocks; as each group's scores sum to
    zero, each takes a degree of freedom.
    """
    covariance, freedom = at.covariance, np.full(at.hypothesis.size, np.inf)
    if not at.hypothesis.size or not np.isfinite(covariance).all():
        return covariance, freedom
    win = problem.windows
    slopes = sensitivities(problem, at).reshape(win.count, -1, at.hypothesis.size)
    taken = _project_instants_out(problem, at, slopes)
    if taken.any():
        information = at.normal.information.sum(axis=0) + at.hypothesis.prior_precision
        covariance = inverse(information - taken)
    of_rows = slopes.reshape(win.count, win.rows, -1, at.hypothesis.size)
    scores = np.einsum("wtc,wtcp->wtp", at.residual.reshape(win.count, win.rows, -1), of_rows)[:, win.pad :]
    white = problem.correlation_samples == 1.0
    rows = max(1, round(options().score_stretch / problem.dt)) if white else win.rows
    starts = np.arange(0, scores.shape[1], rows)
    blocks = np.add.reduceat(scores, starts, axis=1).reshape(-1, at.hypothesis.size)
    blocks = blocks[(blocks != 0.0).any(axis=1)]
    if len(blocks) < options().fewest_blocks:
        return covariance, freedom
    away = blocks - blocks.mean(axis=0)
    spread = away.T @ away * len(blocks)
    ratio = np.diag(covariance @ spread @ covariance) / np.maximum(np.diag(covariance), 1e-300)
    for columns, instance in moved_together(at.hypothesis):
        freedom[columns] = max(len(blocks) - instance.count, 1)
        ratio[columns] = ratio[columns].mean() / freedom[columns]
    wider = np.sqrt(np.maximum(ratio, 1.0))
    return covariance * np.outer(wider, wider), freedom


def _project_instants_out(problem: Shooting, at: Fit, slopes: Array) -> Array:
    """(p, p) information about the parameters that the unknown instants of commands take, given their prior;
    and project them out of the sensitivities (W, M, p) in place. Zeros where commands are as logged.
    """
    taken = np.zeros((at.hypothesis.size, at.hypothesis.size))
    change, shares, spread = unknown_instants(problem.run_set)
    for window, rows, by_share in share_slopes(problem, at, change, shares):
        by_state, A = at.states_jacobian[window], at.normal.states_information[window]
        free = by_share - by_state @ np.linalg.solve(A, by_state.T @ by_share)
        cross = free.T @ slopes[window]
        prior = np.diag(spread[problem.windows.run[window], rows] ** -2.0)
        solved = np.linalg.solve(free.T @ free + prior, cross)
        taken += cross.T @ solved
        slopes[window] -= free @ solved
    return taken


def sensitivities(problem: Shooting, at: Fit) -> Array:
    """(W M, p) sensitivities of the predictions to the parameters, initial states projected out."""
    base = problem.track(at.hypothesis, at.x, at.states)
    slopes = parameter_jacobian(problem, at.hypothesis, at.x, at.states, base)
    transposed = np.swapaxes(at.states_jacobian, 1, 2)
    A = at.normal.states_information
    off = slopes - at.states_jacobian @ np.linalg.solve(A, transposed @ slopes)
    return off.reshape(-1, at.hypothesis.size)

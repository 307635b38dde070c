"""Regression of the residual force on each variable, by simulation.

A force that is a function of a variable is a weighted sum of short pulses, whose sensitivities are computed
once, about a track that follows the data. Each pair of a force and a variable is judged on held-out runs.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.residual_force import fit_forces, motion_variables
from swamp_rl.criticism.likelihood.force_sensitivity import (
    AXES,
    ForceGrid,
    force_grid,
    force_normal_equations,
)
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting, wrap
from swamp_rl.criticism.model.actuator_history import actuator_history
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.scales import force_scale
from swamp_rl.criticism.nuisance.process_noise import random_forces
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import CurvePoint, ResidualForce
from swamp_rl.criticism.selection.information_criterion import information_criterion
from swamp_rl.criticism.selection.model_selection import OTHERS

Array = NDArray[np.float64]

THRUST, EARTH, PLACE = "thrust of ", "north and east", "position"
AXES_OF = {"surge": (0,), "sway": (1,), "yaw": (2,), "north": (0, 1), "east": (0, 1), EARTH: (0, 1)}


@dataclass(frozen=True)
class ForceLikelihood:
    """chi2 of W windows as a quadratic function of forces f (W, 3 B) in B intervals, initial states
    eliminated: chi2 - 2 gradient f + f information f.

    folds: (W,) folds by run, and by windows in turn; block: rows of an interval; dt: of a row [s]; rows: (W,
    B block) of each variable, by name; directions: (W, B block, 3) surge, sway and yaw of a unit of each
    force, by name; scale: `force_scale` of the boat.
    """

    chi2: float
    information: Array
    gradient: Array
    folds: tuple[NDArray[np.int64], ...]
    block: int
    dt: float
    rows: dict[str, Array]
    directions: dict[str, Array]
    scale: Array


@dataclass(frozen=True)
class Pair:
    """A force as a function of a variable. design: (W, 3 B, K) forces in the intervals by its weights; knots:
    positions of the weights, K in all, those of north before those of east where the force has both.
    """

    force: str
    variable: str
    design: Array
    knots: tuple[Array, ...]


@dataclass(frozen=True)
class MarginalLikelihood:
    """chi2 marginalised over Gauss-Markov forces (process noise): information (W, 3 B, 3 B) and gradient (W,
    3 B) of a deterministic force; power: (3,) variance of the process noise [N2, N2, N2 m2]; left: -2 log
    likelihood but for a constant.
    """

    information: Array
    gradient: Array
    power: Array
    left: float


def force_likelihood(run_set: RunSet, weight: Array, hypothesis: Hypothesis, x: Array) -> ForceLikelihood:
    """Of the windows of runs, under a hypothesis with parameters x (p,); weight: (R, T, 6)."""
    seconds, piece, finer = (
        options().regression_spans if "surge" in run_set.present else options().regression_spans_poses
    )
    problem = Shooting(run_set, weight, seconds, before=run_set.dt)
    if problem.windows.count > options().regression_windows:
        chosen = np.zeros(problem.windows.count, dtype=bool)
        chosen[
            np.linspace(0, problem.windows.count - 1, options().regression_windows).round().astype(int)
        ] = True
        problem = problem.part(chosen)
    coarse = force_grid(problem, piece)
    block = -(-coarse.block // finer)
    coarse = ForceGrid(finer * block, -(-(problem.windows.rows - 1) // (finer * block)), coarse.inertia)
    found = fit_forces(problem, hypothesis, x, coarse)
    fine = ForceGrid(block, finer * coarse.count, coarse.inertia)
    force = np.repeat(found.force, finer, axis=1)
    acceleration = force / fine.inertia
    by_state = problem.state_jacobian(hypothesis, x, found.states, found.track, acceleration, block)
    residual = problem.residuals(found.track)
    normal = force_normal_equations(
        problem, hypothesis, x, found.states, fine, (0, 1, 2), by_state, residual, force
    )
    f = force.reshape(len(force), -1)
    win = problem.windows
    rows, directions = _variables_and_directions(problem, found.track, block * fine.count)
    bent = (normal.information @ f[..., None])[..., 0]
    return ForceLikelihood(
        float(normal.profile_chi2.sum() + (f * (2.0 * normal.gradient + bent)).sum()),
        normal.information,
        normal.gradient + bent,
        (_folds(win.run, win.first), np.arange(win.count) % options().folds),
        block,
        run_set.dt,
        rows,
        directions,
        force_scale(run_set.boat),
    )


def _folds(run: NDArray[np.int64], first: NDArray[np.int64]) -> NDArray[np.int64]:
    """(W,) whole runs where there are several, else stretches of the one."""
    every = np.unique(run)
    if len(every) > 1:
        return np.searchsorted(every, run) % options().folds
    return np.argsort(np.argsort(first)) * min(options().folds, len(first)) // len(first)


def _variables_and_directions(
    problem: Shooting, track: Array, count: int
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Rows of the variables and of the forces' directions, `count` of them from each window's start."""
    run_set, win = problem.run_set, problem.windows
    boat = run_set.boat
    places = np.minimum(np.arange(count), win.steps[:, None])
    at = track[np.arange(win.count)[:, None], places]
    sample = win.first[:, None] + places
    reached = actuator_history(run_set.boat, run_set.commands, run_set.dt)[win.run[:, None], sample]
    rows, heading = motion_variables(np.asarray(sample * run_set.dt), at), at[..., 2]
    zero, one = np.zeros_like(heading), np.ones_like(heading)
    cos, sin = np.cos(heading), np.sin(heading)
    directions = {
        "surge": np.stack([one, zero, zero], axis=-1),
        "sway": np.stack([zero, one, zero], axis=-1),
        "yaw": np.stack([zero, zero, one], axis=-1),
        "north": np.stack([cos, -sin, zero], axis=-1),
        "east": np.stack([sin, cos, zero], axis=-1),
    }
    for k, thruster in enumerate(boat.thrusters):
        angle, level = reached[..., k], reached[..., len(boat.thrusters) + k]
        rows[f"azimuth {thruster.name}"] = wrap(angle)
        rows[f"throttle {thruster.name}"] = level
        turned = np.zeros_like(angle) if thruster.kind == "propeller_rudder" else angle
        ahead, aside = np.cos(turned), np.sin(turned)
        lever = thruster.x * aside - thruster.y * ahead
        directions[f"{THRUST}{thruster.name}"] = np.stack([ahead, aside, lever], axis=-1)
    return {name: values for name, values in rows.items() if np.ptp(values) > 1e-6}, directions


def is_angle(name: str, values: Array) -> bool:
    """Whether a variable is an angle that covers a full turn."""
    return name == "heading" or bool(name.startswith("azimuth") and np.ptp(values) > np.pi)


def knots_of(name: str, values: Array) -> Array:
    """(K,) knots of a function of a variable: at quantiles, or evenly round an angle."""
    if is_angle(name, values):
        return wrap(
            2.0 * np.pi / options().knots_of_angle * np.arange(options().knots_of_angle, dtype=np.float64)
        )
    tail = options().knot_tail
    low, high = np.quantile(values, [tail, 1.0 - tail])
    inner = np.quantile(values, np.linspace(tail, 1.0 - tail, options().knots))
    knots = np.unique(np.concatenate([inner, [low, high]]))
    least = options().knots_apart * max(high - low, 1e-9)
    return np.asarray(knots[np.concatenate([[True], np.diff(knots) > least])])


def functions(name: str, values: Array) -> Array:
    """(..., K) hat functions of a variable, one at each of its knots; their sum is one."""
    knots = knots_of(name, values)
    if is_angle(name, values):
        turn = options().knots_of_angle * (values[..., None] - knots) / (2.0 * np.pi)
        away = np.abs(turn - options().knots_of_angle * np.round(turn / options().knots_of_angle))
        return np.asarray(np.maximum(1.0 - away, 0.0))
    return np.stack([np.interp(values, knots, row) for row in np.eye(len(knots))], axis=-1)


def pairs(found: ForceLikelihood) -> list[Pair]:
    """Every force and every variable, a thruster's thrust only with its own and the boat's; and the
    horizontal force as a function of both position coordinates.
    """
    windows, pieces = len(found.gradient), found.gradient.shape[1] // AXES
    every = {}
    for variable, values in found.rows.items():
        basis = functions(variable, values)
        for force, direction in found.directions.items():
            owner = force.removeprefix(THRUST)
            general = variable.split()[0] not in ("azimuth", "throttle")
            if owner != force and not general and variable.split(" ", 1)[1] != owner:
                continue
            acting = (direction[..., None] * basis[..., None, :]).reshape(
                windows, pieces, found.block, AXES, -1
            )
            every[force, variable] = acting.mean(axis=2).reshape(windows, pieces * AXES, -1)
    parts = [every.get((name, f"{PLACE} {name}")) for name in ("north", "east")]
    if all(part is not None for part in parts):
        every[EARTH, PLACE] = np.concatenate([part for part in parts if part is not None], axis=2)
    knots: dict[str, tuple[Array, ...]] = {v: (knots_of(v, values),) for v, values in found.rows.items()}
    if (EARTH, PLACE) in every:
        knots[PLACE] = knots[f"{PLACE} north"] + knots[f"{PLACE} east"]
    return [Pair(force, variable, design, knots[variable]) for (force, variable), design in every.items()]


def marginal_likelihood(found: ForceLikelihood, known: Array) -> MarginalLikelihood:
    """Beside known forces (W, 3 B); the variance of the process noise at maximum likelihood."""
    H = found.information
    g = found.gradient - (H @ known[..., None])[..., 0]
    made = random_forces(H, g, found.block * found.dt, options().regression_time, found.scale)
    acceleration = (made.prior @ made.force[..., None])[..., 0]
    left = found.chi2 - float((known * (found.gradient + g)).sum()) - made.gain
    return MarginalLikelihood(
        np.asarray(made.prior - made.prior @ made.spread @ made.prior), acceleration, made.power, left
    )


@dataclass(frozen=True)
class HeldOutGain:
    """Fall of chi2 on held-out folds, predicted force (W, 3 B), prior standard deviation [N] of weights."""

    gain: float
    predicted_force: Array
    deviation: float


def held_out_gain(
    pair: Pair, marginal: MarginalLikelihood, folds: Sequence[NDArray[np.int64]], thrust: float
) -> HeldOutGain:
    """The gain of a pair, of several foldings and priors the greatest: a variable that varies in one run only
    is identifiable from the rest of that run. thrust: the boat's [N].
    """
    across = np.swapaxes(pair.design, 1, 2)
    H, g = across @ marginal.information @ pair.design, (across @ marginal.gradient[..., None])[..., 0]
    best = HeldOutGain(-np.inf, np.zeros(marginal.gradient.shape), 0.0)
    for fold, deviation in itertools.product(folds, np.multiply(thrust, options().regression_priors)):
        weights = np.empty(g.shape)
        prior = np.eye(g.shape[1]) / deviation**2
        for part in np.unique(fold):
            others = fold != part
            weights[~others] = np.linalg.solve(H[others].sum(axis=0) + prior, g[others].sum(axis=0))
        gain = float((2.0 * g * weights).sum() - np.einsum("wij,wi,wj->", H, weights, weights))
        if gain > best.gain:
            best = HeldOutGain(gain, (pair.design @ weights[..., None])[..., 0], deviation)
    return best


def curves(pair: Pair, information: Array, gradient: Array, deviation: float) -> list[list[CurvePoint]]:
    """The functions of a pair estimated from all windows, each in the order of its variable; information (W,
    3 B, 3 B) and gradient (W, 3 B): of a force beside the process noise.
    """
    across = np.swapaxes(pair.design, 1, 2)
    H = (across @ information @ pair.design).sum(axis=0)
    covariance = np.linalg.inv(H + np.eye(len(H)) / deviation**2)
    weights = covariance @ (across @ gradient[..., None]).sum(axis=0)[:, 0]
    points = [
        CurvePoint(at=float(at), force=float(force), standard_error=float(np.sqrt(variance)))
        for at, force, variance in zip(np.concatenate(pair.knots), weights, np.diag(covariance), strict=True)
    ]
    ends = np.cumsum([0, *(len(knots) for knots in pair.knots)])
    return [
        sorted(points[low:high], key=lambda one: one.at) for low, high in itertools.pairwise(ends.tolist())
    ]


def select_functions(found: ForceLikelihood) -> tuple[float, list[ResidualForce]]:
    """The -2 log likelihood at the end, see `MarginalLikelihood`, and the functions by forward selection on
    held-out gain, sorted by explained variance. Empty where none is significant.
    """
    every = pairs(found)
    known = np.zeros(found.gradient.shape)
    marginal = first = marginal_likelihood(found, known)
    listed = list[ResidualForce]()
    while len(listed) < options().listed_functions and every:
        judged = [(held_out_gain(pair, marginal, found.folds, float(found.scale[0])), pair) for pair in every]
        judged.sort(key=lambda one: -one[0].gain)
        most, best = judged[0]
        if most.gain < options().regression_gain:
            break
        known = known + most.predicted_force
        marginal = marginal_likelihood(found, known)
        back = marginal.gradient + (marginal.information @ most.predicted_force[..., None])[..., 0]
        least = most.gain - 1e-9 if listed else options().regression_tie * most.gain
        every = [one for one in every if one is not best]
        for one, pair in [one for one in judged if one[0].gain > least]:
            share = power_share(pair, one.predicted_force, marginal, first)
            listed += [
                ResidualForce(force=force, variable=variable, explained=share, gain=one.gain, curve=curve)
                for (force, variable), curve in zip(
                    _labels(pair), curves(pair, marginal.information, back, one.deviation), strict=True
                )
            ]
    apart: dict[tuple[str, str], ResidualForce] = {}
    for function in listed:
        apart.setdefault((function.force, function.variable), function)
    return marginal.left, sorted(
        list(apart.values())[: options().listed_functions], key=lambda one: -one.explained
    )


def power_share(
    pair: Pair, predicted_force: Array, marginal: MarginalLikelihood, first: MarginalLikelihood
) -> float:
    """Share of variance along the pair's axes that its force (W, 3 B) explains beside the process noise."""
    axes = list(AXES_OF.get(pair.force, range(AXES)))
    explained = (predicted_force**2).reshape(-1, AXES).mean(axis=0)[axes] / first.power[axes]
    left = marginal.power[axes] / first.power[axes]
    return float(explained.sum() / (explained + left).sum())


def _labels(pair: Pair) -> list[tuple[str, str]]:
    if pair.force == EARTH:
        return [(name, f"{PLACE} {name}") for name in ("north", "east")]
    return [(pair.force, pair.variable)]


def without_process_noise(run_set: RunSet) -> RunSet:
    """The runs with white noise where all channels have a Gauss-Markov part: the residual force."""
    if run_set.gauss_markov is not None and (run_set.gauss_markov[OTHERS, 0] > 0).any():
        return replace(run_set, gauss_markov=None)
    return run_set


def residual_force_functions(
    run_set: RunSet, weight: Array, every: Sequence[tuple[Hypothesis, Array]]
) -> list[ResidualForce]:
    """The residual force as functions, under the hypothesis at (p,) of least information criterion."""
    run_set = without_process_noise(run_set)
    criterion = information_criterion(run_set, float((weight > 0).sum()))
    results = []
    for hypothesis, x in every:
        left, listed = select_functions(force_likelihood(run_set, weight, hypothesis, x))
        results.append((left + criterion.charge(hypothesis), hypothesis, listed))
    _, hypothesis, listed = min(results, key=lambda one: one[0])
    beside = [instance.label for instance in hypothesis.instances]
    return [one.model_copy(update={"beside": beside}) for one in listed]

"""Which missing force goes with which variable: smooth functions, fitted by rollout.

What short pushes do to every window is rolled out once, about a track that follows the data. A force that is
a smooth function of a variable is a weighted sum of such pushes, so each pair of a force and a variable costs
a few linear equations, and is judged on runs that its weights were not fitted to.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.colour import OTHERS
from swamp_rl.criticism.cost import cost
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.kernel import roll_actuators
from swamp_rl.criticism.leftover import followed, motion_variables
from swamp_rl.criticism.pushes import AXES, Pushes, push_normal, pushes_of
from swamp_rl.criticism.result import Leftover, Point
from swamp_rl.criticism.shooting import Shooting, wrap
from swamp_rl.criticism.unsteady import random_forces
from swamp_rl.simulator import initial_state, parameters
from swamp_rl.simulator.state import ACTUATORS

Array = NDArray[np.float64]

# s of a window, of the pieces in which the track is pushed to follow the data, and how many finer ones go
# into one of those
SPANS, SPANS_WITHOUT_VELOCITY = (10.0, 2.5, 4), (10.0, 5.0, 5)
MOST_WINDOWS = 240  # that are looked at, of longer data some evenly
KNOTS, KNOTS_ROUND = 6, 8  # of a function of a variable, and of an angle
SHRUNK = (1.0, 5.0, 25.0)  # N, standard deviations of its weights beforehand, of which the best is taken
FOLDS = 8  # most parts that runs are held out in, and parts that windows are in turn
LASTING = 4.0  # s that what no function explains hangs together for
WORTH = 15.0  # chi2 on runs held out that a pair must save beside those already listed
ALIKE = 0.7  # share of what the first one saves, from which on another is listed with it
LISTED = 4
THRUST, EARTH, PLACE = "thrust of ", "north and east", "position"
AXES_OF = {"surge": (0,), "sway": (1,), "yaw": (2,), "north": (0, 1), "east": (0, 1), EARTH: (0, 1)}


@dataclass(frozen=True)
class Responses:
    """Chi2 of W windows as a function of forces f (W, 3 B) in B pieces, initial states eliminated: none less
    2 gradient f, plus f information f.

    folds: (W,) which part is held out together: of the runs, and of the windows in turn; block: rows of a
    piece; dt: of a row [s]; rows: (W, B block) of each variable, by name; ways: (W, B block, 3) surge, sway
    and yaw that a unit of each force is, by name.
    """

    none: float
    information: Array
    gradient: Array
    folds: tuple[NDArray[np.int64], ...]
    block: int
    dt: float
    rows: dict[str, Array]
    ways: dict[str, Array]


@dataclass(frozen=True)
class Pair:
    """A force that is a function of a variable. design: (W, 3 B, K) forces in the pieces by its weights;
    knots: where these stand, K in all, those of north before those of east where the force has both.
    """

    force: str
    variable: str
    design: Array
    knots: tuple[Array, ...]


@dataclass(frozen=True)
class Remainder:
    """Chi2 with what remains taken for random forces that last a while: information (W, 3 B, 3 B) and
    gradient (W, 3 B) of a force that is not random; power: (3,) variance of the random ones [N2, N2, N2 m2];
    left: chi2 less what the random ones explain, twice the logarithm of a likelihood.
    """

    information: Array
    gradient: Array
    power: Array
    left: float


def responses(trials: Trials, weight: Array, hypothesis: Hypothesis, x: Array) -> Responses:
    """Of the windows of trials, beside a hypothesis with numbers x (p,); weight: (R, T, 6)."""
    seconds, piece, finer = SPANS if "surge" in trials.present else SPANS_WITHOUT_VELOCITY
    problem = Shooting(trials, weight, seconds, before=trials.dt)
    if problem.windows.count > MOST_WINDOWS:
        chosen = np.zeros(problem.windows.count, dtype=bool)
        chosen[np.linspace(0, problem.windows.count - 1, MOST_WINDOWS).round().astype(int)] = True
        problem = problem.part(chosen)
    coarse = pushes_of(problem, piece)
    block = -(-coarse.block // finer)
    coarse = Pushes(finer * block, -(-(problem.windows.rows - 1) // (finer * block)), coarse.inertia)
    found = followed(problem, hypothesis, x, coarse)
    fine = Pushes(block, finer * coarse.count, coarse.inertia)
    force = np.repeat(found.force, finer, axis=1)
    push = force / fine.inertia
    by_state = problem.state_jacobian(hypothesis, x, found.states, found.track, push, block)
    residual = problem.residuals(found.track)
    normal = push_normal(problem, hypothesis, x, found.states, fine, (0, 1, 2), by_state, residual, force)
    f = force.reshape(len(force), -1)
    win = problem.windows
    rows, ways = _courses(problem, found.track, block * fine.count)
    bent = (normal.information @ f[..., None])[..., 0]
    return Responses(
        float(normal.free.sum() + (f * (2.0 * normal.gradient + bent)).sum()),
        normal.information,
        normal.gradient + bent,
        (_folds(win.run, win.first), np.arange(win.count) % FOLDS),
        block,
        trials.dt,
        rows,
        ways,
    )


def _folds(run: NDArray[np.int64], first: NDArray[np.int64]) -> NDArray[np.int64]:
    """(W,) whole runs where there are several, else stretches of the one."""
    every = np.unique(run)
    if len(every) > 1:
        return np.searchsorted(every, run) % FOLDS
    return np.argsort(np.argsort(first)) * min(FOLDS, len(first)) // len(first)


def _courses(problem: Shooting, track: Array, count: int) -> tuple[dict[str, Array], dict[str, Array]]:
    """Rows of the variables and of the forces' ways, `count` of them from each window's start."""
    trials, win = problem.trials, problem.windows
    boat = trials.boat
    places = np.minimum(np.arange(count), win.steps[:, None])
    at = track[np.arange(win.count)[:, None], places]
    sample = win.first[:, None] + places
    reached = reached_actuators(trials)[win.run[:, None], sample]
    rows, heading = motion_variables(np.asarray(sample * trials.dt), at), at[..., 2]
    zero, one = np.zeros_like(heading), np.ones_like(heading)
    cos, sin = np.cos(heading), np.sin(heading)
    ways = {
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
        ways[f"{THRUST}{thruster.name}"] = np.stack([ahead, aside, lever], axis=-1)
    return {name: values for name, values in rows.items() if np.ptp(values) > 1e-6}, ways


def reached_actuators(trials: Trials) -> Array:
    """(R, T, 2K) azimuths and throttles that the actuators reached in each run, as the boat file has them."""
    runs, samples = trials.commands.shape[:2]
    records = parameters(trials.boat, runs)
    start = initial_state(records, np.zeros((runs, 3)))
    start[:, ACTUATORS:] = trials.commands[:, 0]
    states = np.empty((runs, samples, start.shape[1] - AXES * 2))
    roll_actuators(records, start, trials.commands, np.arange(runs), trials.dt, states)
    return states[..., ACTUATORS - 2 * AXES :]


def is_round(name: str, values: Array) -> bool:
    """Whether a variable is an angle that goes all the way round."""
    return name == "heading" or bool(name.startswith("azimuth") and np.ptp(values) > np.pi)


def knots_of(name: str, values: Array) -> Array:
    """(K,) where a function of a variable has its corners: at quantiles, or evenly round an angle."""
    if is_round(name, values):
        return wrap(2.0 * np.pi / KNOTS_ROUND * np.arange(KNOTS_ROUND, dtype=np.float64))
    low, high = np.quantile(values, [0.02, 0.98])
    knots = np.unique(np.concatenate([np.quantile(values, np.linspace(0.02, 0.98, KNOTS)), [low, high]]))
    return np.asarray(knots[np.concatenate([[True], np.diff(knots) > 1e-3 * max(high - low, 1e-9)])])


def functions(name: str, values: Array) -> Array:
    """(..., K) hat functions of a variable, one at each of its knots, which add up to one."""
    knots = knots_of(name, values)
    if is_round(name, values):
        turn = KNOTS_ROUND * (values[..., None] - knots) / (2.0 * np.pi)
        away = np.abs(turn - KNOTS_ROUND * np.round(turn / KNOTS_ROUND))
        return np.asarray(np.maximum(1.0 - away, 0.0))
    return np.stack([np.interp(values, knots, row) for row in np.eye(len(knots))], axis=-1)


def pairs(found: Responses) -> list[Pair]:
    """Every force against every variable, a thruster's thrust against its own and the boat's alone; and a
    horizontal force against the place, which neither of its parts alone would explain.
    """
    windows, pieces = len(found.gradient), found.gradient.shape[1] // AXES
    every = {}
    for variable, values in found.rows.items():
        basis = functions(variable, values)
        for force, way in found.ways.items():
            owner = force.removeprefix(THRUST)
            general = variable.split()[0] not in ("azimuth", "throttle")
            if owner != force and not general and variable.split(" ", 1)[1] != owner:
                continue
            acting = (way[..., None] * basis[..., None, :]).reshape(windows, pieces, found.block, AXES, -1)
            every[force, variable] = acting.mean(axis=2).reshape(windows, pieces * AXES, -1)
    parts = [every.get((name, f"{PLACE} {name}")) for name in ("north", "east")]
    if all(part is not None for part in parts):
        every[EARTH, PLACE] = np.concatenate([part for part in parts if part is not None], axis=2)
    knots: dict[str, tuple[Array, ...]] = {v: (knots_of(v, values),) for v, values in found.rows.items()}
    if (EARTH, PLACE) in every:
        knots[PLACE] = knots[f"{PLACE} north"] + knots[f"{PLACE} east"]
    return [Pair(force, variable, design, knots[variable]) for (force, variable), design in every.items()]


def remainder(found: Responses, known: Array) -> Remainder:
    """What remains beside forces that are known (W, 3 B); its power at greatest likelihood."""
    H = found.information
    g = found.gradient - (H @ known[..., None])[..., 0]
    made = random_forces(H, g, found.block * found.dt, LASTING)
    push = (made.prior @ made.force[..., None])[..., 0]
    left = found.none - float((known * (found.gradient + g)).sum()) - made.gain
    return Remainder(np.asarray(made.prior - made.prior @ made.spread @ made.prior), push, made.power, left)


@dataclass(frozen=True)
class Saved:
    """Chi2 that a pair saves on parts that its weights were not fitted to, the forces (W, 3 B) that it
    foretells there, and the standard deviation [N] that its weights were given beforehand.
    """

    gain: float
    foretold: Array
    deviation: float


def saved(pair: Pair, rest: Remainder, folds: Sequence[NDArray[np.int64]]) -> Saved:
    """What a pair saves; of several ways to hold parts out the one that shows most: what happens in one run
    alone, such as a throttle that no other asks for, is learnt from the rest of that run.
    """
    across = np.swapaxes(pair.design, 1, 2)
    H, g = across @ rest.information @ pair.design, (across @ rest.gradient[..., None])[..., 0]
    best = Saved(-np.inf, np.zeros(rest.gradient.shape), 0.0)
    for fold, deviation in itertools.product(folds, SHRUNK):
        weights = np.empty(g.shape)
        prior = np.eye(g.shape[1]) / deviation**2
        for part in np.unique(fold):
            others = fold != part
            weights[~others] = np.linalg.solve(H[others].sum(axis=0) + prior, g[others].sum(axis=0))
        gain = float((2.0 * g * weights).sum() - np.einsum("wij,wi,wj->", H, weights, weights))
        if gain > best.gain:
            best = Saved(gain, (pair.design @ weights[..., None])[..., 0], deviation)
    return best


def curves(pair: Pair, information: Array, gradient: Array, deviation: float) -> list[list[Point]]:
    """The functions of a pair as all windows tell them, each in the order of its variable; information
    (W, 3 B, 3 B) and gradient (W, 3 B): of a force, beside what remains once this one is told.
    """
    across = np.swapaxes(pair.design, 1, 2)
    H = (across @ information @ pair.design).sum(axis=0)
    covariance = np.linalg.inv(H + np.eye(len(H)) / deviation**2)
    weights = covariance @ (across @ gradient[..., None]).sum(axis=0)[:, 0]
    points = [
        Point(at=float(at), force=float(force), standard_error=float(np.sqrt(variance)))
        for at, force, variance in zip(np.concatenate(pair.knots), weights, np.diag(covariance), strict=True)
    ]
    ends = np.cumsum([0, *(len(knots) for knots in pair.knots)])
    return [
        sorted(points[low:high], key=lambda one: one.at) for low, high in itertools.pairwise(ends.tolist())
    ]


def pointed(found: Responses) -> tuple[float, list[Leftover]]:
    """What is left in the end, see `Remainder`, and the pairs that explain what is missing: those that save
    most, then further ones, each beside those found before it; told in the order of what they explain. Empty
    where none does.
    """
    every = pairs(found)
    known = np.zeros(found.gradient.shape)
    rest = first = remainder(found, known)
    listed = list[Leftover]()
    while len(listed) < LISTED and every:
        judged = [(saved(pair, rest, found.folds), pair) for pair in every]
        judged.sort(key=lambda one: -one[0].gain)
        most, best = judged[0]
        if most.gain < WORTH:
            break
        known = known + most.foretold
        rest = remainder(found, known)
        back = rest.gradient + (rest.information @ most.foretold[..., None])[..., 0]
        least = most.gain - 1e-9 if listed else ALIKE * most.gain
        every = [one for one in every if one is not best]
        for one, pair in [one for one in judged if one[0].gain > least]:
            share = power_share(pair, one.foretold, rest, first)
            listed += [
                Leftover(force=force, variable=variable, explained=share, curve=curve)
                for (force, variable), curve in zip(
                    _told(pair), curves(pair, rest.information, back, one.deviation), strict=True
                )
            ]
    apart = {(one.force, one.variable): one for one in reversed(listed)}
    return rest.left, sorted(list(reversed(apart.values()))[:LISTED], key=lambda one: -one.explained)


def power_share(pair: Pair, foretold: Array, rest: Remainder, first: Remainder) -> float:
    """Power of the forces (W, 3 B) that a pair foretells, in that and what remains, along the pair's axes."""
    axes = list(AXES_OF.get(pair.force, range(AXES)))
    told = (foretold**2).reshape(-1, AXES).mean(axis=0)[axes] / first.power[axes]
    left = rest.power[axes] / first.power[axes]
    return float(told.sum() / (told + left).sum())


def _told(pair: Pair) -> list[tuple[str, str]]:
    if pair.force == EARTH:
        return [(name, f"{PLACE} {name}") for name in ("north", "east")]
    return [(pair.force, pair.variable)]


def leftovers(trials: Trials, weight: Array, every: Sequence[tuple[Hypothesis, Array]]) -> list[Leftover]:
    """What remains and what it goes with, beside that of some hypotheses with their numbers (p,) which leaves
    least once that is told: a wrong cause bends what is missing, a right one clears it.

    Where errors of all channels were let wander, that was the missing force, so they are not here.
    """
    if trials.slow is not None and (trials.slow[OTHERS, 0] > 0).any():
        trials = replace(trials, slow=None)
    told = []
    for hypothesis, x in every:
        left, listed = pointed(responses(trials, weight, hypothesis, x))
        told.append((left + cost(hypothesis), hypothesis, listed))
    _, hypothesis, listed = min(told, key=lambda one: one[0])
    beside = [atom.label for atom in hypothesis.atoms]
    return [one.model_copy(update={"beside": beside}) for one in listed]

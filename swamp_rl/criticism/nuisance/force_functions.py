"""Forces on the boat as functions of a variable, and chi2 as a quadratic function of forces.

A force that is a function of a variable is a weighted sum of short pulses, whose sensitivities are computed
once, about a track that follows the data.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import turned, within_half_turn
from swamp_rl.criticism.data.command_names import COMMANDS
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian, state_jacobian
from swamp_rl.criticism.likelihood.force_fit import fit_forces
from swamp_rl.criticism.likelihood.force_sensitivity import (
    AXES,
    ForceGrid,
    force_grid,
    force_normal_equations,
)
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.actuator_history import actuator_history
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.scales import force_scale
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]

THRUST, EARTH, PLACE = "thrust of ", "north and east", "position"
EARTH_AXES = "north", "east"


@dataclass(frozen=True)
class ForceLikelihood:
    """chi2 of W windows as a quadratic function of forces f (W, 3 B) in B intervals, initial states
    eliminated: chi2 - 2 gradient f + f information f. Steps of `parameters` of the hypothesis stand before
    the forces in f.

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
    parameters: int = 0


@dataclass(frozen=True)
class Pair:
    """A force as a function of a variable. design: (W, 3 B, K) forces in the intervals by its weights; knots:
    positions of the weights, K in all, those of north before those of east where the force has both.
    """

    force: str
    variable: str
    design: Array
    knots: tuple[Array, ...]


def force_likelihood(
    run_set: RunSet, weight: Array, hypothesis: Hypothesis, x: Array, steps: bool = False
) -> ForceLikelihood:
    """Of the windows of runs, under a hypothesis with parameters x (p,); weight: (R, T, 6); steps: as a
    function of steps of x too.
    """
    seconds, piece, finer = (
        options().regression_spans if "surge" in run_set.present else options().regression_spans_poses
    )
    problem = Shooting(run_set, weight, seconds, before=run_set.dt)
    if problem.windows.count > options().regression_windows:
        every = np.arange(problem.windows.count)
        chosen = np.linspace(0, every[-1], options().regression_windows).round()
        problem = problem.part(np.isin(every, chosen))
    coarse = force_grid(problem, piece)
    block = -(-coarse.block // finer)
    coarse = ForceGrid(finer * block, -(-(problem.windows.rows - 1) // (finer * block)), coarse.inertia)
    found = fit_forces(problem, hypothesis, x, coarse, options().regression_reach)
    fine = ForceGrid(block, finer * coarse.count, coarse.inertia)
    force = np.repeat(found.force, finer, axis=1)
    acceleration = force / fine.inertia
    by_state = state_jacobian(problem, hypothesis, x, found.states, found.track, acceleration, block)
    residual = problem.residuals(found.track)
    where = problem, hypothesis, x, found.states
    beside = None
    if steps:
        beside = parameter_jacobian(problem, *where[1:], found.track, None, acceleration, block)
    normal = force_normal_equations(*where, fine, (0, 1, 2), by_state, residual, force, beside)
    size = hypothesis.size if steps else 0
    f = np.concatenate([np.zeros((len(force), size)), force.reshape(len(force), -1)], axis=1)
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
        size,
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
    directions = {
        "surge": np.stack([one, zero, zero], axis=-1),
        "sway": np.stack([zero, one, zero], axis=-1),
        "yaw": np.stack([zero, zero, one], axis=-1),
        "north": np.stack([*turned(one, zero, -heading), zero], axis=-1),
        "east": np.stack([*turned(zero, one, -heading), zero], axis=-1),
    }
    for k, thruster in enumerate(boat.thrusters):
        angle, level = reached[..., k], reached[..., len(boat.thrusters) + k]
        rows[f"azimuth {thruster.name}"] = within_half_turn(angle)
        rows[f"throttle {thruster.name}"] = level
        pushed = np.zeros_like(angle) if thruster.kind == "propeller_rudder" else angle
        ahead, aside = np.cos(pushed), np.sin(pushed)
        lever = thruster.x * aside - thruster.y * ahead
        directions[f"{THRUST}{thruster.name}"] = np.stack([ahead, aside, lever], axis=-1)
    return {name: values for name, values in rows.items() if np.ptp(values) > 1e-6}, directions


def is_angle(name: str, values: Array) -> bool:
    """Whether a variable is an angle that covers a full turn."""
    return name == "heading" or bool(name.startswith("azimuth") and np.ptp(values) > np.pi)


def knots_of(name: str, values: Array) -> Array:
    """(K,) knots of a function of a variable: at quantiles, or evenly round an angle."""
    if is_angle(name, values):
        return within_half_turn(
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
    """Every force and every variable, a thruster's thrust only with its own and the boat's, and a force along
    an axis of the earth, which does not turn with the thrusters, with none of them; and the horizontal force
    as a function of both position coordinates.
    """
    windows, pieces = len(found.gradient), (found.gradient.shape[1] - found.parameters) // AXES
    every = {}
    for variable, values in found.rows.items():
        basis = functions(variable, values)
        for force, direction in found.directions.items():
            owner = force.removeprefix(THRUST)
            general = variable.split()[0] not in COMMANDS
            if not general and (force in EARTH_AXES or owner not in (force, variable.split(" ", 1)[1])):
                continue
            acting = (direction[..., None] * basis[..., None, :]).reshape(
                windows, pieces, found.block, AXES, -1
            )
            every[force, variable] = acting.mean(axis=2).reshape(windows, pieces * AXES, -1)
    parts = [every.get((name, f"{PLACE} {name}")) for name in EARTH_AXES]
    if all(part is not None for part in parts):
        every[EARTH, PLACE] = np.concatenate([part for part in parts if part is not None], axis=2)
    knots: dict[str, tuple[Array, ...]] = {v: (knots_of(v, values),) for v, values in found.rows.items()}
    if (EARTH, PLACE) in every:
        knots[PLACE] = knots[f"{PLACE} north"] + knots[f"{PLACE} east"]
    return [Pair(force, variable, design, knots[variable]) for (force, variable), design in every.items()]


def motion_variables(time: Array, at: Array) -> dict[str, Array]:
    """Variables that a force may depend on, by name (...): of time (...) [s] and states at (..., 6)."""
    north, east, heading, surge, sway, yaw_rate = np.moveaxis(at, -1, 0)
    return {
        "time": time,
        "position north": north,
        "position east": east,
        "heading": within_half_turn(heading),
        "speed": np.hypot(surge, sway),
        "surge": surge,
        "sway": sway,
        "yaw rate": yaw_rate,
    }

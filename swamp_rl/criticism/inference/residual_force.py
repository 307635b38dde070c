"""Forces missing from the model, constant in short intervals, and the boat's motion there."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.force_sensitivity import (
    AXES,
    ForceGrid,
    force_grid,
    force_normal_equations,
)
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting, wrap
from swamp_rl.criticism.likelihood.output_error import fit_states, next_damping
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Forces:
    """Residual forces in n intervals: force (n, 5) of surge, sway, yaw, north and east [N, N m], error (n, 5)
    their standard errors.

    run: (n,); variables: motion and commands at the middle of the interval, by name (n,).
    """

    force: Array
    error: Array
    run: NDArray[np.int64]
    variables: dict[str, Array]


def residual_forces(run_set: RunSet, weight: Array, hypothesis: Hypothesis, x: Array) -> Forces:
    """Surge and sway force and yaw moment, constant in each interval, that reproduce the measured motion;
    fitted by least squares together with the initial states. x: (p,) of the hypothesis.
    """
    spans = options().force_spans if "surge" in run_set.present else options().force_spans_poses
    seconds, piece = spans
    problem = Shooting(run_set, weight, seconds, before=run_set.dt)
    grid = force_grid(problem, piece)
    made = fit_forces(problem, hypothesis, x, grid)
    track, force, covariance = made.track, made.force, made.covariance
    win = problem.windows
    found = []
    held = (win.weight[..., 0] > 0) & (np.arange(win.rows) >= win.pad)  # less the prior's row
    share = held.sum() / (win.steps + 1).sum()  # the sensor may be slower than the grid
    for w, b in np.ndindex(force.shape[:2]):
        middle = round((b + 0.5) * grid.block)
        seen = held[w, b * grid.block : (b + 1) * grid.block]
        if middle <= win.steps[w] and seen.sum() >= max(1.0, options().force_measured * share * grid.block):
            found.append((w, b, middle))
    w, b, middle = np.array(found, dtype=int).reshape(-1, 3).T
    at, body = track[w, middle], force[w, b]
    cos, sin = np.cos(at[:, 2]), np.sin(at[:, 2])
    earth = [body[:, 0] * cos - body[:, 1] * sin, body[:, 0] * sin + body[:, 1] * cos]
    columns = AXES * b[:, None] + np.arange(AXES)
    error = np.sqrt(np.maximum(covariance[w[:, None], columns, columns], 0.0))
    return Forces(
        np.column_stack([body, *earth]),
        np.column_stack([error, error[:, :2].mean(axis=1), error[:, :2].mean(axis=1)]),
        win.run[w],
        _variables(run_set, at, win.run[w], win.first[w] + middle),
    )


@dataclass(frozen=True)
class ForceFit:
    """Initial states (W, 6), track (W, T, 6), force (W, B, 3) [N, N, N m], its covariance (W, 3 B, 3 B)."""

    states: Array
    track: Array
    force: Array
    covariance: Array


def fit_forces(problem: Shooting, hypothesis: Hypothesis, x: Array, grid: ForceGrid) -> ForceFit:
    """The forces, constant in each interval, at least chi2."""
    states, track, residual = fit_states(
        problem, hypothesis, x, problem.initial_states(), options().force_rounds
    )
    shape = (problem.windows.count, grid.count, AXES)
    reach = options().force_reach * float(np.max(problem.boat_thrust))
    prior = np.tile(1.0 / np.array([reach, reach, reach * problem.boat.length]), grid.count) ** 2
    force = np.zeros(shape)
    damping = np.zeros(shape[0])
    covariance = np.zeros((shape[0], AXES * shape[1], AXES * shape[1]))
    for _ in range(options().force_rounds):
        acting = force.reshape(-1, grid.count, AXES)
        acceleration: Array = acting / grid.inertia
        by_state = problem.state_jacobian(hypothesis, x, states, track, acceleration, grid.block)
        normal = force_normal_equations(
            problem, hypothesis, x, states, grid, (0, 1, 2), by_state, residual, acting, damping=damping
        )
        H = normal.information + np.diag(prior)
        covariance = np.asarray(np.linalg.inv(H))
        H = H + (damping[:, None] * np.einsum("wii->wi", H))[..., None] * np.eye(H.shape[1])
        g = normal.gradient - prior * force.reshape(shape[0], -1)
        step = np.asarray(np.linalg.solve(H, g[..., None])[..., 0])
        shift = normal.shift(step)
        tried: Array = force + step.reshape(shape)
        acceleration = np.asarray(tried / grid.inertia)
        moved = problem.predict(hypothesis, x[None], (states + shift)[None], acceleration, grid.block)[0]
        left = problem.residuals(moved)
        better = (left**2).sum(axis=1) < (residual**2).sum(axis=1)
        states[better] += shift[better]
        force[better], track[better], residual[better] = tried[better], moved[better], left[better]
        damping = next_damping(damping, better, options().force_damping)
    return ForceFit(states, track, force, covariance)


def motion_variables(time: Array, at: Array) -> dict[str, Array]:
    """Variables that a force may depend on, by name (...): of time (...) [s] and states at (..., 6)."""
    north, east, heading, surge, sway, yaw_rate = np.moveaxis(at, -1, 0)
    return {
        "time": time,
        "position north": north,
        "position east": east,
        "heading": wrap(heading),
        "speed": np.hypot(surge, sway),
        "surge": surge,
        "sway": sway,
        "yaw rate": yaw_rate,
    }


def _variables(
    run_set: RunSet, at: Array, runs: NDArray[np.int64], sample: NDArray[np.int64]
) -> dict[str, Array]:
    found = motion_variables(np.asarray(sample * run_set.dt), at)
    names = run_set.boat.thruster_names
    half = max(1, round(1.0 / run_set.dt))
    around = np.clip(sample[:, None] + np.arange(-half, half), 0, run_set.commands.shape[1] - 1)
    commands = run_set.commands[runs[:, None], around].mean(axis=1)
    for k, name in enumerate(names):
        found[f"azimuth {name}"] = commands[:, k]
        found[f"throttle {name}"] = commands[:, len(names) + k]
    return {name: values for name, values in found.items() if len(values) and np.ptp(values) > 1e-6}

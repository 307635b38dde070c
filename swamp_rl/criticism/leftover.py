"""Forces that the model lacks, piece by piece, with what the boat did meanwhile."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import settle
from swamp_rl.criticism.pushes import AXES, Pushes, push_normal, pushes_of
from swamp_rl.criticism.shooting import Shooting, wrap

Array = NDArray[np.float64]

# s of a window with a start of its own, and of the pieces in it that a force is constant in
WINDOW, PIECE = 5.0, 2.5
WINDOW_WITHOUT_VELOCITY, PIECE_WITHOUT_VELOCITY = 10.0, 5.0
SEEN = 0.25  # of the positions that a piece should hold, below which its force is not told
ROUNDS = 6  # steps towards the forces
REACH = 3.0  # standard deviation of a missing force beforehand, in thrusts of the strongest thruster


@dataclass(frozen=True)
class Forces:
    """Missing forces at n instants: force (n, 5) of surge, sway, yaw, north and east [N, N m], error (n, 5)
    their standard errors.

    run: (n,); variables: what the boat did there, by name (n,).
    """

    force: Array
    error: Array
    run: NDArray[np.int64]
    variables: dict[str, Array]


def missing_forces(trials: Trials, weight: Array, hypothesis: Hypothesis, x: Array) -> Forces:
    """Extra surge and sway force and yaw moment, constant in each short piece of every window, that make
    rollouts agree with what was measured; fitted with the windows' initial states, so that neither is a noisy
    signal differentiated nor does the hull's damping hide a part. x: (p,) numbers of the hypothesis.
    """
    seconds, piece = WINDOW, PIECE
    if "surge" not in trials.present:
        seconds, piece = WINDOW_WITHOUT_VELOCITY, PIECE_WITHOUT_VELOCITY
    problem = Shooting(trials, weight, seconds, before=trials.dt)
    pushes = pushes_of(problem, piece)
    made = followed(problem, hypothesis, x, pushes)
    track, force, covariance = made.track, made.force, made.covariance
    win = problem.windows
    found = []
    held = (win.weight[..., 0] > 0) & (np.arange(win.rows) >= win.pad)  # less what the start is guessed to be
    share = held.sum() / (win.steps + 1).sum()  # a receiver may be slower than the grid
    for w, b in np.ndindex(force.shape[:2]):
        middle = round((b + 0.5) * pushes.block)
        seen = held[w, b * pushes.block : (b + 1) * pushes.block]
        if middle <= win.steps[w] and seen.sum() >= max(1.0, SEEN * share * pushes.block):
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
        _variables(trials, at, win.run[w], win.first[w] + middle),
    )


@dataclass(frozen=True)
class Followed:
    """Windows pushed so that they follow the data: states (W, 6) at their starts, track (W, T, 6), force
    (W, B, 3) [N, N, N m] and its covariance (W, 3 B, 3 B).
    """

    states: Array
    track: Array
    force: Array
    covariance: Array


def followed(problem: Shooting, hypothesis: Hypothesis, x: Array, pushes: Pushes) -> Followed:
    """The forces, constant in each piece, that make rollouts agree best with what was measured."""
    states, track, residual = settle(problem, hypothesis, x, problem.guess(), ROUNDS)
    shape = (problem.windows.count, pushes.count, AXES)
    reach = REACH * float(np.max(problem.boat_thrust))
    prior = np.tile(1.0 / np.array([reach, reach, reach * problem.boat.length]), pushes.count) ** 2
    force = np.zeros(shape)
    damping = np.zeros(shape[0])
    covariance = np.zeros((shape[0], AXES * shape[1], AXES * shape[1]))
    for _ in range(ROUNDS):
        acting = force.reshape(-1, pushes.count, AXES)
        push: Array = acting / pushes.inertia
        by_state = problem.state_jacobian(hypothesis, x, states, track, push, pushes.block)
        normal = push_normal(
            problem, hypothesis, x, states, pushes, (0, 1, 2), by_state, residual, acting, damping=damping
        )
        H = normal.information + np.diag(prior)
        covariance = np.asarray(np.linalg.inv(H))
        H = H + (damping[:, None] * np.einsum("wii->wi", H))[..., None] * np.eye(H.shape[1])
        g = normal.gradient - prior * force.reshape(shape[0], -1)
        step = np.asarray(np.linalg.solve(H, g[..., None])[..., 0])
        shift = np.linalg.solve(
            normal.states_information,
            (normal.states_gradient - (normal.cross @ step[..., None])[..., 0])[..., None],
        )[..., 0]
        tried: Array = force + step.reshape(shape)
        push = np.asarray(tried / pushes.inertia)
        moved = problem.predict(hypothesis, x[None], (states + shift)[None], push, pushes.block)[0]
        left = problem.residuals(moved)
        better = (left**2).sum(axis=1) < (residual**2).sum(axis=1)
        states[better] += shift[better]
        force[better], track[better], residual[better] = tried[better], moved[better], left[better]
        damping = np.where(better, np.where(damping < 0.1, 0.0, damping / 10.0), 10.0 * damping + 0.1)
    return Followed(states, track, force, covariance)


def motion_variables(time: Array, at: Array) -> dict[str, Array]:
    """What a force may go with of a boat's motion, by name (...): time (...) [s], states at (..., 6)."""
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
    trials: Trials, at: Array, runs: NDArray[np.int64], sample: NDArray[np.int64]
) -> dict[str, Array]:
    found = motion_variables(np.asarray(sample * trials.dt), at)
    names = trials.boat.thruster_names
    half = max(1, round(1.0 / trials.dt))
    around = np.clip(sample[:, None] + np.arange(-half, half), 0, trials.commands.shape[1] - 1)
    commands = trials.commands[runs[:, None], around].mean(axis=1)
    for k, name in enumerate(names):
        found[f"azimuth {name}"] = commands[:, k]
        found[f"throttle {name}"] = commands[:, len(names) + k]
    return {name: values for name, values in found.items() if len(values) and np.ptp(values) > 1e-6}

"""Forces that the model lacks, and which variable they go with."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import normal_equations, settle
from swamp_rl.criticism.pushes import AXES, Pushes, push_slopes, pushes_of
from swamp_rl.criticism.result import Force, Leftover
from swamp_rl.criticism.shooting import Shooting, wrap

Array = NDArray[np.float64]

# s of a window with a start of its own, and of the pieces in it that a force is constant in
WINDOW, PIECE = 5.0, 2.5
WINDOW_WITHOUT_VELOCITY, PIECE_WITHOUT_VELOCITY = 10.0, 5.0
SEEN = 0.25  # of the positions that a piece should hold, below which its force is not told
BINS = 6
ROUNDS = 6  # steps towards the forces
REACH = 3.0  # standard deviation of a missing force beforehand, in thrusts of the strongest thruster
CLIP = 4.0  # spreads from the median beyond which a force is drawn nearer
SIGNIFICANT = 0.8  # median of force over error, 0.67 where there is none
ALIKE = 0.05  # of variance explained, within which two variables are listed side by side
LISTED = 4
SHOWN = 0.15  # share of a force's variance that a variable must explain, on other runs, to be named
FORCES: tuple[Force, ...] = ("surge", "sway", "yaw", "north", "east")


@dataclass(frozen=True)
class Forces:
    """Missing forces at n instants: force (n, 5) in the order of FORCES [N, N m], error (n, 5) their
    standard errors.

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
    track, force, covariance = _fitted(problem, hypothesis, x, pushes)
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


def _fitted(
    problem: Shooting, hypothesis: Hypothesis, x: Array, pushes: Pushes
) -> tuple[Array, Array, Array]:
    """Track (W, T, 6), forces (W, B, 3) and their covariance (W, 3 B, 3 B)."""
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
        by_force = push_slopes(problem, hypothesis, x, states, pushes, (0, 1, 2), acting)
        normal = normal_equations(by_state, by_force, residual, damping[:, None])
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
    return track, force, covariance


def _variables(
    trials: Trials, at: Array, runs: NDArray[np.int64], sample: NDArray[np.int64]
) -> dict[str, Array]:
    found = {
        "time": sample * trials.dt,
        "position north": at[:, 0],
        "position east": at[:, 1],
        "heading": wrap(at[:, 2]),
        "speed": np.hypot(at[:, 3], at[:, 4]),
        "surge": at[:, 3],
        "sway": at[:, 4],
        "yaw rate": at[:, 5],
    }
    names = trials.boat.thruster_names
    half = max(1, round(1.0 / trials.dt))
    around = np.clip(sample[:, None] + np.arange(-half, half), 0, trials.commands.shape[1] - 1)
    commands = trials.commands[runs[:, None], around].mean(axis=1)
    for k, name in enumerate(names):
        found[f"azimuth {name}"] = commands[:, k]
        found[f"throttle {name}"] = commands[:, len(names) + k]
    return {name: values for name, values in found.items() if len(values) and np.ptp(values) > 1e-6}


def explained(values: Array, force: Array, error: Array, run: NDArray[np.int64]) -> float:
    """Share of a force's power that bins of a variable explain on runs that the bins were not filled from;
    what lies far out counts as if it were nearer.
    """
    edges = np.quantile(values, np.linspace(0, 1, BINS + 1)[1:-1])
    bins = np.searchsorted(edges, values)
    spread = float(np.median(np.abs(force - np.median(force)))) + float(np.median(error))
    force = np.clip(force, np.median(force) - CLIP * spread, np.median(force) + CLIP * spread)
    weight = 1.0 / (error**2 + spread**2)
    left, whole = 0.0, 0.0
    for one in np.unique(run):
        mine = run == one
        for b in np.unique(bins[mine]):
            rest = ~mine & (bins == b)
            mean = float(np.average(force[rest], weights=weight[rest])) if rest.any() else 0.0
            here = mine & (bins == b)
            left += float((weight[here] * (force[here] - mean) ** 2).sum())
            whole += float((weight[here] * force[here] ** 2).sum())
    return 1.0 - left / max(whole, 1e-12)


def leftovers(every: Sequence[Forces]) -> list[Leftover]:
    """Force and variable of what remains, the best explained first, at most `LISTED`, with the variables that
    explain a force about as well as the best one; every: what is missing beside one model and another, as a
    wrong cause bends what is left over.
    """
    found: dict[tuple[Force, str], float] = {}
    for forces in every:
        for c, name in enumerate(FORCES if forces.variables else ()):
            significance = np.median(np.abs(forces.force[:, c]) / np.maximum(forces.error[:, c], 1e-9))
            if significance < SIGNIFICANT:
                continue
            shares = {
                variable: explained(values, forces.force[:, c], forces.error[:, c], forces.run)
                for variable, values in forces.variables.items()
            }
            best = max(shares.values())
            for variable, share in shares.items():
                if share > max(SHOWN, best - ALIKE):
                    found[name, variable] = max(share, found.get((name, variable), 0.0))
    listed = sorted(found.items(), key=lambda one: -one[1])[:LISTED]
    return [Leftover(force=name, variable=variable, explained=share) for (name, variable), share in listed]

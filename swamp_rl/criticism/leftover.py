"""Forces that the model lacks, and which variable they go with."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import normal_equations, settle
from swamp_rl.criticism.result import Force, Leftover
from swamp_rl.criticism.shooting import Shooting, cut, wrap
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]

WINDOW, WINDOW_WITHOUT_VELOCITY = 2.5, 5.0  # s
BINS = 6
ROUNDS = 8  # steps that each window's initial state is given
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
    """What jumps between neighbouring short windows.

    A force that the model lacks makes each window's fitted motion bend the wrong way; the state at the next
    window's start then lies off the last one's end by the missing acceleration times a window's length. No
    noisy signal is differentiated. The hull's own damping over a window hides a part, up to a third, of a
    steady force. x: (p,) numbers of the hypothesis.
    """
    seconds = WINDOW if "surge" in trials.present else WINDOW_WITHOUT_VELOCITY
    problem = Shooting(trials, weight, seconds, cut(trials, weight, seconds, before=0.0))
    states, track, residual = settle(problem, hypothesis, x, problem.guess(), ROUNDS)
    by_state = problem.state_jacobian(hypothesis, x, states, track)
    none = np.zeros((*residual.shape, 0))
    win = problem.windows
    covariance = np.linalg.inv(normal_equations(by_state, none, residual).states_information)
    sd = np.sqrt(np.maximum(np.einsum("wii->wi", covariance), 0.0))
    record = parameters(trials.boat)[0]
    inertia = np.array(
        [
            record["mass"] - record["added_mass_surge"],
            record["mass"] - record["added_mass_sway"],
            record["inertia_z"] - record["added_inertia_yaw"],
        ]
    )
    forces, errors, runs, places = [], [], [], []
    for w in range(win.count - 1):
        if win.run[w] != win.run[w + 1]:
            continue
        end = track[w, win.steps[w]] + (track[w, win.steps[w]] - track[w, win.steps[w] - 1])
        start = track[w + 1, win.pad]
        length = (win.steps[w + 1] - win.pad + 1) * trials.dt
        body = inertia * (start[3:] - end[3:]) / length
        error = inertia * np.hypot(sd[w, 3:], sd[w + 1, 3:]) / length
        cos, sin = np.cos(start[2]), np.sin(start[2])
        forces.append([*body, body[0] * cos - body[1] * sin, body[0] * sin + body[1] * cos])
        errors.append([*error, *np.repeat(error[:2].mean(), 2)])
        runs.append(win.run[w])
        places.append((w + 1, win.first[w + 1] + win.pad))
    at = np.array([track[w, win.pad] for w, _ in places])
    return Forces(np.array(forces), np.array(errors), np.array(runs), _variables(trials, at, runs, places))


def _variables(trials: Trials, at: Array, runs: list[int], places: list[tuple[int, int]]) -> dict[str, Array]:
    sample = np.array([place for _, place in places])
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
    commands = trials.commands[np.array(runs)[:, None], around].mean(axis=1)
    for k, name in enumerate(names):
        found[f"azimuth {name}"] = commands[:, k]
        found[f"throttle {name}"] = commands[:, len(names) + k]
    return {name: values for name, values in found.items() if np.ptp(values) > 1e-6}


def explained(values: Array, force: Array, error: Array, run: NDArray[np.int64]) -> float:
    """Share of a force's power that bins of a variable explain on runs that the bins were not filled from."""
    edges = np.quantile(values, np.linspace(0, 1, BINS + 1)[1:-1])
    bins = np.searchsorted(edges, values)
    weight = 1.0 / (error**2 + np.median(np.abs(force)) ** 2 + 1e-12)
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


def leftovers(forces: Forces) -> list[Leftover]:
    """Force and variable of what remains, the best explained first, one variable for each force."""
    found = []
    for c, name in enumerate(FORCES):
        shares = {
            variable: explained(values, forces.force[:, c], forces.error[:, c], forces.run)
            for variable, values in forces.variables.items()
        }
        best = max(shares, key=lambda variable: shares[variable])
        significance = float(np.mean((forces.force[:, c] / np.maximum(forces.error[:, c], 1e-9)) ** 2))
        if shares[best] > SHOWN and significance > 1.5:
            found.append(Leftover(force=name, variable=best, explained=shares[best]))

    return sorted(found, key=lambda one: -one.explained)

"""Forces missing from the model, constant in short intervals, and the boat's motion there."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.force_fit import fit_forces
from swamp_rl.criticism.likelihood.force_sensitivity import force_grid
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.nuisance.force_functions import motion_variables
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Forces:
    """Residual forces in n intervals: force (n, 3) of surge, sway and yaw [N, N m]; variables: motion and
    commands at the middle of the interval, by name (n,).
    """

    force: Array
    variables: dict[str, Array]


def residual_forces(run_set: RunSet, weight: Array, hypothesis: Hypothesis, x: Array) -> Forces:
    """Surge and sway force and yaw moment, constant in each interval, that reproduce the measured motion;
    fitted by least squares together with the initial states. x: (p,) of the hypothesis.
    """
    spans = options().force_spans if "surge" in run_set.present else options().force_spans_poses
    seconds, piece = spans
    problem = Shooting(run_set, weight, seconds, before=run_set.dt)
    grid = force_grid(problem, piece)
    made = fit_forces(problem, hypothesis, x, grid, options().force_reach)
    win = problem.windows
    found = []
    held = (win.weight[..., 0] > 0) & (np.arange(win.rows) >= win.pad)  # less the prior's row
    share = held.sum() / (win.steps + 1).sum()  # the sensor may be slower than the grid
    for w, b in np.ndindex(made.force.shape[:2]):
        middle = round((b + 0.5) * grid.block)
        seen = held[w, b * grid.block : (b + 1) * grid.block]
        if middle <= win.steps[w] and seen.sum() >= max(1.0, options().force_measured * share * grid.block):
            found.append((w, b, middle))
    w, b, middle = np.array(found, dtype=int).reshape(-1, 3).T
    variables = _variables(run_set, made.track[w, middle], win.run[w], win.first[w] + middle)
    return Forces(made.force[w, b], variables)


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

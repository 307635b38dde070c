"""Mean wind and current of each run, fitted beside the numbers of a boat, and predictions in a current."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat_fit.fit import soft_weights, window_length
from swamp_rl.boat_fit.hypothesis import WEATHER_SD
from swamp_rl.boat_fit.recent_thrust import RecentErrors, errors_with
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import Hypothesis, instances_of
from swamp_rl.effects import LIBRARY

Array = NDArray[np.float64]

STEPS = 6  # Jacobians of a fit of the current
LEVEL = 0.01  # chance that any of the runs has a significant flow where there is none


@dataclass(frozen=True)
class RunFlow:
    """Mean flow [m/s] of a run or a piece of one: north and east components of where a current sets, or of
    where a wind blows from; the standard error of its speed along its direction.
    """

    name: str
    north: float
    east: float
    standard_error: float

    @property
    def speed(self) -> float:
        """[m/s]."""
        return float(np.hypot(self.north, self.east))


def run_flows(
    run_set: RunSet, hypothesis: Hypothesis, x: Array, covariance: Array, of: str = "current"
) -> list[RunFlow]:
    """The winds or currents among x (p,) of these runs, run after run; none where the hypothesis has none."""
    columns = np.flatnonzero(hypothesis.columns(f"{of} by_run"))
    if not len(columns):
        return []
    found = []
    for name, own in zip(run_set.names, columns.reshape(-1, 2), strict=True):
        flow = x[own]
        along = flow / max(float(np.hypot(*flow)), 1e-12)
        error = float(np.sqrt(along @ covariance[np.ix_(own, own)] @ along))
        found.append(RunFlow(name, float(flow[0]), float(flow[1]), error))
    return found


def is_significant(flows: Sequence[RunFlow]) -> bool:
    """Whether the flow of any run is significant: where there is none, a speed whose two components have the
    error s exceeds k s with probability exp(-k^2 / 2) (Rayleigh distribution).
    """
    if not flows:
        return False
    limit = math.sqrt(-2.0 * math.log(LEVEL / len(flows)))
    return any(one.speed > limit * one.standard_error for one in flows)


@np.errstate(over="ignore", invalid="ignore")  # where the boat diverges
def errors_in_current(run_set: RunSet, boat: Boat) -> list[RecentErrors]:
    """Errors of a boat file in the mean current of each run, which is fitted to that run itself."""
    run_set = replace(run_set, boat=boat)
    weight = weights(run_set, noise_levels(run_set))
    (free,) = instances_of(LIBRARY["current"], boat)
    specs = tuple(replace(spec, prior=WEATHER_SD["current"], mean=0.0) for spec in free.specs)
    hypothesis = Hypothesis((replace(free, specs=specs),))
    problem = Shooting(run_set, soft_weights(weight, boat), window_length(boat))
    states, run = problem.initial_states(), problem.windows.run
    flows = [
        fit(problem.part(run == k), hypothesis, np.zeros(2), states[run == k], STEPS).x
        for k in range(len(run_set.lengths))
    ]
    return errors_with(run_set, weight, hypothesis, [np.nan_to_num(one)[None] for one in flows])

"""Error of the integration in whole runs, as a variance of the measurement noise."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.likelihood.finite_differences import state_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.candidates import Hypothesis

Array = NDArray[np.float64]


def discretisation_errors(run_set: RunSet, weight: Array) -> Array:
    """(6,) root of the summed squares of what the simulator's step changes in each channel of whole runs,
    under the boat file, beyond what other initial states would; 0 where nothing was measured, and of runs
    that diverged.

    As a variance of the noise it bounds what any parameter can gain from the integration to chi2 of 1 a
    channel (Cauchy and Schwarz), however its error is correlated. It is a discrepancy of the model (Kennedy
    and O'Hagan, Bayesian calibration of computer models, J. R. Stat. Soc. B 63, 2001). weight: (R, T, 6).
    """
    problem, nothing, x = Shooting(run_set, weight, math.inf), Hypothesis(), np.zeros(0)
    if problem.substeps == problem.jacobian_substeps:
        return np.zeros(len(CHANNELS))
    states, coarse = problem.initial_states(), problem.integrated_in(problem.jacobian_substeps)
    fine = problem.track(nothing, x, states)
    by_state = state_jacobian(problem, nothing, x, states, fine)
    change = problem.standardised(fine - coarse.track(nothing, x, states))  # no residuals: these wrap round
    power = np.zeros(len(CHANNELS))
    for own, slopes in zip(change, by_state, strict=True):
        if np.isfinite(own).all() and np.isfinite(slopes).all():
            left = own - slopes @ np.linalg.lstsq(slopes, own, rcond=None)[0]
            power += (left.reshape(-1, len(CHANNELS)) ** 2).sum(axis=0)
    most = weight.max(axis=(0, 1))
    return np.sqrt(power) / np.where(most > 0.0, most, np.inf)

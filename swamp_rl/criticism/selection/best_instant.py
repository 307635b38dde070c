"""The instant of least chi2 about that of a fit: the likelihood of an instant has local minima."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit_states
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


def best_instant(problem: Shooting, at: Fit, index: int, states: Array) -> float:
    """The instant, parameter `index` of a fit, of least chi2 up to a window's length away, and then up to a
    step of that search away, with the initial states of the windows about it fitted anew for each from
    measured ones (W, 6): those of the fit make up for the present instant.
    """
    length = problem.windows.rows * problem.dt
    low, high = (one[index] for one in at.hypothesis.bounds())
    begins, ends = (problem.dt * (problem.windows.first + n) for n in (0, problem.windows.steps))
    near = (begins < at.x[index] + length) & (ends > at.x[index] - length)
    part, x = problem.part(near), at.x.copy()
    best, found = float((at.residual[near] ** 2).sum()), float(at.x[index])
    for reach in (length, 2.0 * length / (options().instants - 1)):
        for time in np.clip(found + np.linspace(-reach, reach, options().instants), low, high):
            x[index] = time
            _, _, residual = fit_states(part, at.hypothesis, x, states[near], options().fit_steps)
            loss = float((residual**2).sum())
            if loss < best:  # never of NaN, where the boat diverges
                best, found = loss, float(time)
    return found

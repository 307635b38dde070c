"""Mean and spread of parameters that differ between groups of runs: a normal random effect."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.constants import Z95
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]

CHI2_95 = 3.841459  # of one degree of freedom


@dataclass(frozen=True)
class RandomEffect:
    """Groups y_g ~ N(mean, spread^2 diag(scale^2)). mean (q,) with covariance (q, q) of its estimate, widened
    by Student's t for the number of groups; spread, low, high: the estimate and its 95 % interval from the
    profile likelihood, in typical sizes.
    """

    mean: Array
    covariance: Array
    spread: float
    low: float
    high: float


def random_effect(values: Array, covariance: Array, scale: Array) -> RandomEffect:
    """From the estimates of G groups, values (G, q) with covariance (G q, G q), by restricted maximum
    likelihood (Patterson and Thompson 1971); scale: (q,) typical sizes.
    """
    from scipy.optimize import brentq, minimize_scalar

    y = (values / scale).ravel()
    unit = np.tile(1.0 / scale, len(values))
    noise = covariance * np.outer(unit, unit)

    def loss(log_spread: float) -> float:
        return _restricted(y, noise, float(np.exp(log_spread)), len(scale))[0]

    smallest, largest, count = options().spreads
    tried = np.linspace(np.log(smallest), np.log(largest), count)
    losses = np.array([loss(one) for one in tried])
    at = int(np.argmin(losses))
    ends = tried[max(at - 1, 0)], tried[min(at + 1, count - 1)]
    best = float(minimize_scalar(loss, bounds=ends, method="bounded").x) if at > 0 else float(tried[0])
    least = min(loss(best), float(losses[at]))

    def above(log_spread: float) -> float:
        return loss(log_spread) - least - CHI2_95

    low = float(np.exp(brentq(above, tried[0], best))) if above(tried[0]) > 0.0 else 0.0
    high = float(np.exp(brentq(above, best, tried[-1]))) if above(tried[-1]) > 0.0 else largest
    spread = float(np.exp(best)) if at > 0 else 0.0
    _, mean, of_mean = _restricted(y, noise, spread, len(scale))
    if spread > 0.0:
        of_mean = of_mean * widening(len(values), len(scale)) ** 2
    return RandomEffect(mean * scale, of_mean * np.outer(scale, scale), spread, low, high)


def widening(groups: int, size: int) -> float:
    """Student's t over the normal quantile at 95 %, by which the standard error of the mean of so many groups
    of `size` values is widened; 1 for one group.
    """
    from scipy.special import stdtrit

    return float(stdtrit((groups - 1) * size, 1.0 - options().tail)) / Z95 if groups > 1 else 1.0


def _restricted(y: Array, noise: Array, spread: float, size: int) -> tuple[float, Array, Array]:
    """-2 log restricted likelihood of a spread but for a constant, the mean (q,) and its covariance."""
    total = noise + spread**2 * np.eye(len(y))
    design = np.tile(np.eye(size), (len(y) // size, 1))
    solved = np.linalg.solve(total, np.column_stack([design, y]))
    information = design.T @ solved[:, :size]
    mean = np.linalg.solve(information, design.T @ solved[:, size])
    quadratic = float(y @ solved[:, size] - mean @ information @ mean)
    volume = float(np.linalg.slogdet(total)[1] + np.linalg.slogdet(information)[1])
    return quadratic + volume, mean, np.linalg.inv(information)

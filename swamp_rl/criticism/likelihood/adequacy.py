"""Whiteness test of the residuals: white noise of the estimated size has no excess at low frequencies."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import CHANNELS
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit

Array = NDArray[np.float64]

SCALES = (1.0, 4.0)  # s over which residuals are averaged
SIGMA_SLACK = 1.06  # relative bias of a variance estimated from differences
NEARLY = 1.2  # chi2 a sample up to which gaps and initial states may explain the residual
DENSE = 0.6  # share of rows with a sample, below which a sensor is slower than the grid
LIMIT = 5.0  # standard deviations of the excess, over all channels and scales


@dataclass(frozen=True)
class Adequacy:
    """excess: (scales, 6) standard deviations by which the power of averaged residuals exceeds that of white
    noise, minus infinity for too few samples, infinity where a simulation diverged.
    """

    excess: Array

    @property
    def worst(self) -> float:
        """Largest excess."""
        return float(np.max(self.excess))

    @property
    def adequate(self) -> bool:
        """Whether the residual is white noise."""
        return self.worst < LIMIT

    @property
    def channel(self) -> str:
        """Channel of the largest excess."""
        return CHANNELS[int(np.argmax(np.max(self.excess, axis=0)))]


def adequacy(problem: Shooting, at: Fit) -> Adequacy:
    """Of a fit's residuals."""
    pad = problem.windows.pad
    residual = at.residual.reshape(at.residual.shape[0], -1, len(CHANNELS))[:, pad:]
    seen = problem.windows.weight[:, pad:] > 0
    excess = np.full((len(SCALES), len(CHANNELS)), -np.inf)
    share = seen.sum(axis=(0, 1)) / max(1, int((problem.windows.steps - pad + 1).sum()))
    for s, scale in enumerate(SCALES):
        block = max(2, round(scale / problem.dt))
        steps = residual.shape[1] // block * block
        sums = residual[:, :steps].reshape(len(residual), -1, block, len(CHANNELS)).sum(axis=2)
        counts = seen[:, :steps].reshape(len(residual), -1, block, len(CHANNELS)).sum(axis=2)
        for c in range(len(CHANNELS)):
            enough = block // 2 if share[c] > DENSE else max(1, round(0.5 * share[c] * block))
            full = counts[..., c] >= enough
            if full.sum() >= 4:
                excess[s, c] = _excess(sums[..., c][full] ** 2 / counts[..., c][full])
    if (excess == -np.inf).all():  # too few samples for means
        excess[:] = _excess(residual[seen] ** 2)
    return Adequacy(excess)


def _excess(power: Array) -> float:
    """Standard deviations by which squares of standard normal values (n,) exceed their expectation."""
    found = (power.mean() / SIGMA_SLACK - 1.0) * np.sqrt(len(power) / 2.0) if len(power) else 0.0
    return float(found) if np.isfinite(found) else np.inf


def near(problem: Shooting, at: Fit) -> bool:
    """Whether the residual is noise or little more."""
    return at.chi2 < NEARLY * problem.samples or adequacy(problem, at).adequate

"""Whiteness test of the residuals: white noise of the estimated size has no excess at low frequencies."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import CHANNELS
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


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
        return self.worst < options().whiteness_limit

    @property
    def channel(self) -> str:
        """Channel of the largest excess."""
        return CHANNELS[int(np.argmax(np.max(self.excess, axis=0)))]


def adequacy(problem: Shooting, at: Fit) -> Adequacy:
    """Of a fit's residuals."""
    pad = problem.windows.pad
    residual = problem.windows.by_channel(at.residual)
    seen = problem.windows.weight[:, pad:] > 0
    excess = np.full((len(options().whiteness_scales), len(CHANNELS)), -np.inf)
    share = seen.sum(axis=(0, 1)) / max(1, int((problem.windows.steps - pad + 1).sum()))
    for s, scale in enumerate(options().whiteness_scales):
        block = max(2, round(scale / problem.dt))
        steps = residual.shape[1] // block * block
        sums = residual[:, :steps].reshape(len(residual), -1, block, len(CHANNELS)).sum(axis=2)
        counts = seen[:, :steps].reshape(len(residual), -1, block, len(CHANNELS)).sum(axis=2)
        for c in range(len(CHANNELS)):
            enough = block // 2 if share[c] > options().slow_sensor else max(1, round(0.5 * share[c] * block))
            full = counts[..., c] >= enough
            if full.sum() >= options().least_means:
                excess[s, c] = _excess(sums[..., c][full] ** 2 / counts[..., c][full])
    if (excess == -np.inf).all():  # too few samples for means
        excess[:] = _excess(residual[seen] ** 2)
    return Adequacy(excess)


def _excess(power: Array) -> float:
    """Standard deviations by which squares of standard normal values (n,) exceed their expectation."""
    found = (power.mean() / options().variance_bias - 1.0) * np.sqrt(len(power) / 2.0) if len(power) else 0.0
    return float(found) if np.isfinite(found) else np.inf


def near(problem: Shooting, at: Fit) -> bool:
    """Whether the residual is noise or little more."""
    return at.chi2 < options().nearly_noise * problem.samples or adequacy(problem, at).adequate

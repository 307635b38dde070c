"""Whether surge has another scale than the positions, by a few percent: a factor of a unit, or a log."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.doctor.finding import Finding
from swamp_rl.doctor.smooth import Motion

Array = NDArray[np.float64]

LEAST, MOST = 0.01, 0.2
"""Departure of the ratio from 1 that is told: a compass that is 8 degrees off makes 0.01; larger ones are
units."""
CERTAIN = 5.0
"""Standard errors of the ratio that the departure exceeds."""
BLOCK, FEWEST = 10, 10
"""Windows of a stretch with a ratio of its own, and stretches that tell their spread."""
STRAIGHT = 0.1
"""rad: the boat turns by less within a window."""
UNDER_WAY = 0.5
"""Of the 90 % quantile of the surge."""


def surge_scale(motions: Sequence[Motion]) -> list[Finding]:
    """A note where surge is a few percent more or less than the velocity of the positions along the heading,
    by medians over stretches of straight motion, which jumps of the positions do not move."""
    ratios = np.array([ratio for motion in motions for ratio in _ratios(motion)])
    if len(ratios) < FEWEST:
        return []
    ratio = float(np.median(ratios))
    spread = 1.4826 * float(np.median(np.abs(ratios - ratio)))
    error = 1.2533 * spread / np.sqrt(len(ratios))  # of a median
    if not max(LEAST, CERTAIN * error) < abs(ratio - 1.0) < MOST:
        return []
    message = f"is {ratio:.3f} ± {error:.2g} times the speed of the positions along the heading"
    advice = (
        "check the factor of its unit (a knot is 0.514444 m/s), or whether it is through the water, in a "
        f"current; a wrong factor is undone by --map surge=surge/{ratio:.3f}, and likewise of sway"
    )
    figures = {"ratio": ratio, "standard_error": float(error)}
    return [Finding("note", "surge_scale", ("surge",), message, advice, figures=figures)]


def _ratios(motion: Motion) -> list[float]:
    """Surge over the velocity along the heading, the median of each stretch of BLOCK windows."""
    if motion.surge is None:
        return []
    moved = (motion.velocity * np.conj(motion.direction)).real
    fast = np.abs(motion.surge) > UNDER_WAY * float(np.quantile(np.abs(motion.surge), 0.9))
    rows = np.flatnonzero(fast & (np.abs(motion.turning) * motion.window < STRAIGHT))
    size = BLOCK * motion.rows
    parts = np.split(rows, np.arange(size, len(rows), size))
    medians = [float(np.median(moved[part] / motion.surge[part])) for part in parts if len(part) == size]
    return [1.0 / one for one in medians if one > 0.0]

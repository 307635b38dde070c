"""Random numbers that depend only on a seed and a count, so a boat's gusts are the same in any batch."""

import math
from typing import Any

import numpy as np

from swamp_rl.physics.compile import compiled


@compiled
def uniform(seed: Any, count: int) -> float:
    """The count-th number in (0, 1) of the stream `seed` (SplitMix64, Steele, Lea and Flood 2014)."""
    z = np.uint64(seed) + np.uint64(count + 1) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return (float(z >> np.uint64(11)) + 0.5) / 9007199254740992.0


@compiled
def normal_pair(seed: Any, count: int) -> tuple[float, float]:
    """Two independent standard normal numbers (Box and Muller 1958)."""
    radius = math.sqrt(-2.0 * math.log(uniform(seed, 2 * count)))
    angle = 2.0 * math.pi * uniform(seed, 2 * count + 1)
    return radius * math.cos(angle), radius * math.sin(angle)

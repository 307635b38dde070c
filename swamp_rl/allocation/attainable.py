"""What steady force and moment the working jets can hold, and by how much."""

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation.jets import Jets
from swamp_rl.allocation.problem import Program
from swamp_rl.allocation.sectors import Sector, sectors_of

Array = NDArray[np.float64]

UNBOUNDED = 1e3  # multiples of a wanted force beyond which no one asks


def largest_multiple(jets: Jets, wanted: Array) -> float:
    """The largest multiple [1] of `wanted` (3,), force [N] and moment [N m], that the jets can hold.

    1 or more: they can hold it; 0: not even a part of it, for it needs a direction that they do not have.
    Steady: wherever the jets have to turn, they had time to. A cone program, one for each choice of sectors.
    """
    wanted = np.asarray(wanted, dtype=float)
    if not wanted.any():
        return UNBOUNDED
    own = [found for k in range(len(jets.names)) if (found := sectors_of(jets, k, 0.0, math.inf))]
    if not own:
        return 0.0
    return max(_multiple_in(jets, chosen, wanted) for chosen in itertools.product(*own))


def _multiple_in(jets: Jets, chosen: tuple[Sector, ...], wanted: Array) -> float:
    program = Program(jets, chosen)
    program.scale_up(wanted, UNBOUNDED)
    x = program.solved()
    if x is None:
        return 0.0
    reached = max(float(x[-1]), 0.0)
    return reached if reached > 1e-6 else 0.0


def force_region(jets: Jets, directions: int) -> Array:
    """(n, 2) surge and sway force [N], the largest in evenly spread directions without a yaw moment.

    The border of the attainable region's section; 0 where a force of that direction cannot be held at all.
    """
    angles = np.arange(directions) * 2.0 * math.pi / directions
    along = np.stack([np.cos(angles), np.sin(angles), np.zeros(directions)], axis=1)
    return np.array([largest_multiple(jets, one) * one[:2] for one in along])

"""What drives a boat, as guidance asks for it: jets, or propellers with rudders."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation import Allocation, Jets, Propellers, Wish, allocate, jets_of, propellers_of
from swamp_rl.boat import Boat, PropellerRudder
from swamp_rl.guidance.loop import Seen

Drive = Jets | Propellers

MOMENT = 5.0  # weight of a missing moment: a boat that cannot turn loses its path, a slow one only time
WISH = Wish(moment=MOMENT)


def drive_of(boat: Boat) -> Drive:
    """What drives the boat; UserError where it has jets and propellers with rudders together."""
    has_propeller = any(isinstance(thruster, PropellerRudder) for thruster in boat.thrusters)
    return propellers_of(boat) if has_propeller else jets_of(boat)


def allocated(drive: Drive, wanted: NDArray[np.float64], seen: Seen, step: float) -> Allocation:
    """Commands for a wanted surge, sway force [N] and yaw moment [N m] (3,), within the reach of a step [s].

    Where jets cannot give both force and moment, a missing moment counts `MOMENT` times. Propellers with
    rudders take the velocity over ground for that through the water.
    """
    if isinstance(drive, Jets):
        return allocate(drive, wanted, seen.azimuth, step, WISH)
    return drive.allocate(wanted, seen.velocity, seen.azimuth, step)

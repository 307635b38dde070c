"""Thrust allocation: a wanted force and moment shared out among jets or propellers; what they can hold."""

from swamp_rl.allocation.allocate import Allocation, allocate
from swamp_rl.allocation.attainable import force_region, largest_multiple
from swamp_rl.allocation.jets import Jets, jets_of
from swamp_rl.allocation.problem import Wish
from swamp_rl.allocation.propeller_rudder import Propellers, propellers_of

__all__ = [
    "Allocation",
    "Jets",
    "Propellers",
    "Wish",
    "allocate",
    "force_region",
    "jets_of",
    "largest_multiple",
    "propellers_of",
]

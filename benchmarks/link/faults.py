"""The faults of thesis 6.5 on the two computers: who takes over, after what time, what force is left."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.link.computer import PORT, STARBOARD
from benchmarks.link.pair import HULLS, Pair
from swamp_rl.allocation import Jets, largest_multiple
from swamp_rl.boat import Boat
from swamp_rl.link.network import PERFECT, Faults

Array = NDArray[np.float64]

WISH = (6.0, 1.0, 0.3)
"""Surge, sway force [N] and yaw moment [N m] that the console wishes for: within reach of any two jets."""
BEFORE, AFTER = 2.0, 3.0
"""Seconds simulated before and after a fault."""
TOLERANCE = 0.02
"""Share of the wish by which the commands, and the jets, may be off."""
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Fault:
    """A fault: what happens, what the thesis says of it (None: nothing), how it is brought about."""

    name: str
    consequence: str | None
    strike: Callable[[Pair], None]


def _cut(pair: Pair) -> None:
    pair.cut = True


def _lose_gps(hull: int) -> Callable[[Pair], None]:
    return lambda pair: pair.vehicle.blind.add(pair.vehicle.addresses.sensors[hull])


def _break(*names: str) -> Callable[[Pair], None]:
    def strike(pair: Pair) -> None:
        for name in names:
            pair.break_module(name)

    return strike


NONE, SMALL = "no consequence", "small: loss of thrust symmetry"
MEDIUM = "medium: possible loss of thrust symmetry"
TOTAL = "medium: total loss of surge thrust symmetry"
FAULTS = (
    Fault("communication of the starboard hull", NONE, lambda p: p.dead_communications.add(STARBOARD)),
    Fault("communication of the port hull", NONE, lambda p: p.dead_communications.add(PORT)),
    Fault("computer of the starboard hull", NONE, lambda p: p.dead_computers.add(STARBOARD)),
    Fault("computer of the port hull", NONE, lambda p: p.dead_computers.add(PORT)),
    Fault("one thruster", SMALL, _break("bs")),
    Fault("one thruster on each hull, both at the bow", MEDIUM, _break("bs", "bp")),
    Fault("one thruster on each hull, diagonal", MEDIUM, _break("bs", "sp")),
    Fault("two thrusters on one hull", TOTAL, _break("bs", "ss")),
    Fault("battery of the starboard hull", TOTAL, lambda p: p.empty_battery(STARBOARD)),
    Fault("battery of the port hull", TOTAL, lambda p: p.empty_battery(PORT)),
    Fault("wireless link between the hulls", None, _cut),
    Fault("GPS of the starboard hull", None, _lose_gps(STARBOARD)),
    Fault("GPS of the port hull", None, _lose_gps(PORT)),
)
"""The rows of thesis 6.5, for SWAMP's thrusters, and then those that it does not have."""


@dataclass(frozen=True)
class Outcome:
    """What followed a fault.

    commanded: [s] until the commands in force give the wish again with the jets that work, reached: until the
    jets do; 0 where they never ceased to. commander: of each thruster, a hull's name, None of a dead module;
    gps: the hull whose GPS the computer that allocates uses; most: (3,) greatest surge and sway force [N] and
    yaw moment [N m] left, each alone.
    """

    commanded: float
    reached: float
    commander: tuple[str | None, ...]
    gps: str | None
    most: Array


def outcome_of(fault: Fault, boat: Boat, network: Faults = PERFECT, seed: int = 0) -> Outcome:
    """Strike a boat under way with a fault and look at the seconds after it.

    Infinite times where the wish is not met at the end.
    """
    pair = Pair(boat, network, seed)
    pair.wish = WISH
    while pair.time < BEFORE:
        pair.step()
    fault.strike(pair)
    struck, working = pair.time, pair.working()
    commanded = reached = 0.0
    while pair.time < struck + AFTER:
        pair.step()
        if not meets(pair.commanded_force()):
            commanded = pair.time - struck
        if not meets(pair.force()):
            reached = pair.time - struck
    last = AFTER - 0.5
    commanded, reached = (time if time <= last else math.inf for time in (commanded, reached))
    who = tuple(
        HULLS[sender] if works and sender is not None else None
        for sender, works in zip(pair.commanders, working.works.tolist(), strict=True)
    )
    chief = next(one for one in pair.computers if one.number not in pair.dead_computers)
    source = chief.navigates_by(pair.time)
    return Outcome(commanded, reached, who, None if source is None else HULLS[source], most_of(working))


def meets(force: Array) -> bool:
    """Whether a force (3,) is the wish."""
    return bool(np.linalg.norm(force - WISH) <= TOLERANCE * np.linalg.norm(WISH))


def most_of(jets: Jets) -> Array:
    """(3,) greatest surge, sway force [N] and yaw moment [N m] that jets hold, each with the others at 0."""
    return np.array([largest_multiple(jets, np.array(axis)) for axis in AXES])

"""Figures of a flown mission: of the whole, and of each leg."""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.energy.fly import STEP, Flight, above_continuous
from swamp_rl.energy.power import range_left

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LegFigures:
    """One leg. power [W] mean, energy [J] and charge [1] at the end: (packs,); thrusters [W] mean, (K,)."""

    number: int
    asked: float
    duration: float
    distance: float
    power: Array
    energy: Array
    charge: Array
    thrusters: Array

    @property
    def speed(self) -> float:
        """Mean over ground [m/s]."""
        return self.distance / self.duration


def leg_figures(flight: Flight) -> list[LegFigures]:
    """Each leg that was begun."""
    found = []
    for number in dict.fromkeys(flight.leg.tolist()):
        steps = np.flatnonzero(flight.leg == number)
        first, end = int(steps[0]), int(steps[-1]) + 1
        energy = flight.packs.energy[end] - flight.packs.energy[first]
        duration = (end - first) * STEP
        found.append(
            LegFigures(
                number,
                flight.mission.legs[number].speed,
                duration,
                float(flight.way[end] - flight.way[first]),
                energy / duration,
                energy,
                flight.packs.charge[end],
                flight.thrusters[first:end].mean(axis=0),
            )
        )
    return found


def energy_per_metre(flight: Flight) -> float:
    """Energy of all packs over the way made [J/m]."""
    return float(flight.packs.energy[-1].sum() / flight.way[-1])


def outcome(flight: Flight) -> str:
    """How the mission ended: `completed`, `emptied` or `aground`."""
    if flight.aground is not None:
        return "aground"
    return "completed" if flight.emptied is None else "emptied"


def summary(flight: Flight) -> dict[str, Any]:
    """The mission in numbers: SI units, packs in the order of `pack_names`."""
    packs = flight.packs
    way = np.array(flight.way[-1])
    left = float(range_left(flight.boat, packs.energy[-1], way, flight.mission.charge))
    return {
        "time": float(flight.time[-1]),
        "distance": float(flight.way[-1]),
        "energy": packs.energy[-1].tolist(),
        "energy_per_metre": energy_per_metre(flight),
        "charge": packs.charge[-1].tolist(),
        "voltage": packs.voltage[-1].tolist(),
        "current_max": packs.current.max(axis=0).tolist(),
        "seconds_above_continuous_current": above_continuous(flight),
        "range_left": left if math.isfinite(left) else None,
        "emptied": flight.emptied,
        "outcome": outcome(flight),
        "aground": None if flight.aground is None else asdict(flight.aground),
    }

"""Whether, and at which heading, the working thrusters can hold station in current and wind; else why not."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation import Jets, largest_multiple
from swamp_rl.allocation.sectors import sectors_of
from swamp_rl.angles import wrapped_below
from swamp_rl.boat import Boat
from swamp_rl.physics.hull import hull_forces
from swamp_rl.physics.motion import external_forces, water_velocity
from swamp_rl.physics.resistance import towing
from swamp_rl.simulator import parameters, tank

Array = NDArray[np.float64]

RESERVE = 1.1  # multiple of the steady force that must be there: a tenth is left to steer with
GUST = 2.0  # standard deviations of the wind's speed that the boat is to bear
HEADINGS = 72
HALVINGS = 40


@dataclass(frozen=True)
class Holding:
    """One heading's balance: needed (3,) force [N] and moment [N m] in the mean wind.

    margin: how many times it can be had, or, if that is less, what a gust of two deviations asks for.
    unsteady: why the bow does not stay at the heading, where it does not.
    """

    heading: float
    needed: Array
    margin: float
    unsteady: str = ""

    @property
    def holds(self) -> bool:
        """Whether the thrusters can hold it with something left to steer with."""
        return self.margin >= RESERVE and not self.unsteady

    @property
    def reason(self) -> str:
        """One line for the person who must decide."""
        x, y, n = np.round(self.needed, 2) + 0.0  # no minus before nought
        need = f"{x:+.1f} N ahead, {y:+.1f} N to starboard and {n:+.2f} N m are needed"
        at = f"at heading {round(math.degrees(self.heading)) % 360} deg"
        if self.holds and not self.needed.any():
            return f"can hold {at}: no force is needed"
        if self.holds:
            return f"can hold {at}: {need}, the thrusters give {self.margin:.1f} times that"
        if self.unsteady:
            return f"cannot hold {at}: {self.unsteady}"
        if not self.needed.any():
            return "cannot hold: one jet cannot steer without current or wind"
        if self.margin == 0.0:
            return f"cannot hold {at}: {need}, and the thrusters have no force along that line"
        return (
            f"cannot hold {at}: {need}, the thrusters give {self.margin:.2f} times that, {RESERVE:g} is "
            "required"
        )


def steady_force(boat: Boat, heading: float, gust: float = 0.0) -> Array:
    """(3,) what the jets must give for the boat to lie still over ground at `heading` [rad], at time 0.

    The opposite of what current, wind and steady pushes of the boat's effects do to it; gust: how many
    standard deviations the wind blows harder than its mean.
    """
    return steady_force_of(parameters(boat)[0], tank(boat), heading, gust)


def steady_force_of(p: Any, curves: Array, heading: float, gust: float = 0.0) -> Array:
    """As `steady_force`, of a parameter record p and its towing-tank curves."""
    time = 0.0
    cos, sin = math.cos(heading), math.sin(heading)
    north, east = water_velocity(time, p)
    u, v = -(north * cos + east * sin), -(east * cos - north * sin)
    hull = hull_forces(u, v, 0.0, p, curves, towing(p, curves))
    speed, comes_from = float(p["wind_speed"] + gust * p["gust_speed_std"]), float(p["wind_from"])
    wind = speed * math.cos(comes_from), speed * math.sin(comes_from)
    outside = external_forces(cos, sin, 0.0, 0.0, time, wind, p)
    return -(np.array(hull) + np.array(outside))


def in_flow(jets: Jets, speed: float) -> Jets:
    """The jets with what is left of their greatest thrust where they push against water at `speed` [m/s].

    1 − c_a V √(ρ A / T), thesis eq. 5.2, taken for every direction: those that push with the flow lose less.
    """
    p = jets.record[0]
    loss = (
        np.array(p["advance_loss"])
        * speed
        * np.sqrt(float(p["water_density"]) * np.array(p["nozzle_area"]) / np.maximum(jets.thrust_max, 1e-9))
    )
    left = np.maximum(1.0 - loss, 1e-3)
    return replace(jets, thrust_max=left * jets.thrust_max, astern_max=left * jets.astern_max)


def in_current(boat: Boat, jets: Jets) -> Jets:
    """The jets in the boat's current while it lies still over ground, as `in_flow`."""
    return in_flow(jets, math.hypot(*water_velocity(0.0, parameters(boat)[0])))


def holding_at(boat: Boat, jets: Jets, heading: float) -> Holding:
    """The balance at one heading [rad]."""
    needed, gusty = (steady_force(boat, heading, gust) for gust in (0.0, GUST))
    slowed = in_current(boat, jets)
    margin = largest_multiple(slowed, needed)
    if not np.array_equal(gusty, needed):
        margin = min(margin, largest_multiple(slowed, gusty))
    return Holding(heading, needed, margin)


def best_holding(boat: Boat, jets: Jets) -> Holding:
    """The heading with the greatest margin.

    One jet alone can only hold where the force that is needed passes through its own place: such headings are
    found as roots, the others by trying every five degrees.
    """
    tried = np.arange(HEADINGS) * 2.0 * math.pi / HEADINGS
    if int(jets.works.sum()) != 1:
        return max((holding_at(boat, jets, float(heading)) for heading in tried), key=lambda one: one.margin)
    k = int(np.flatnonzero(jets.works)[0])
    found = [_through(boat, jets, k, heading) for heading in _roots(boat, jets, k, tried)]
    none = Holding(0.0, steady_force(boat, 0.0), 0.0)
    return max(found, key=lambda one: one.margin, default=none)


def moment_left(boat: Boat, jets: Jets, k: int, heading: float) -> float:
    """Moment [N m] that is missing at `heading` when jet k alone gives the force that is needed."""
    x, y, n = steady_force(boat, heading)
    return float(n - (jets.x[k] * y - jets.y[k] * x))


def _roots(boat: Boat, jets: Jets, k: int, tried: Array) -> list[float]:
    """Headings [rad] at which jet k alone is in balance, by bisection between those tried."""
    left = [moment_left(boat, jets, k, float(heading)) for heading in tried]
    found = []
    for i, heading in enumerate(tried):
        low, high = float(heading), float(heading) + 2.0 * math.pi / len(tried)
        if left[i] == 0.0 or left[i] * left[(i + 1) % len(tried)] >= 0.0:
            continue
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if moment_left(boat, jets, k, middle) * left[i] > 0.0:
                low = middle
            else:
                high = middle
        found.append(0.5 * (low + high))
    return found


def _through(boat: Boat, jets: Jets, k: int, heading: float) -> Holding:
    needed = steady_force(boat, heading)
    direction = math.atan2(needed[1], needed[0]) - float(jets.offset[k])
    if not any(
        sector.whole or abs(wrapped_below(direction - 0.5 * (sector.low + sector.high))) <= 0.5 * sector.width
        for sector in sectors_of(jets, k, 0.0, math.inf)
        if not sector.astern
    ):
        return Holding(heading, needed, 0.0)
    most = max(math.hypot(*steady_force(boat, heading, gust)[:2]) for gust in (0.0, GUST))
    return Holding(heading, needed, float(in_current(boat, jets).thrust_max[k]) / max(most, 1e-9))

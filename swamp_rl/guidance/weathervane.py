"""Station keeping without a sway force: the bow in the weather, as at anchor.

Fixed jets, and propellers with rudders, push ahead and turn. Where current and wind push the boat straight
astern, that is enough: a displacement to the side is taken back by turning the bow, so that the thrust and
the weather both push across.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation import Jets, Propellers, largest_multiple
from swamp_rl.angles import turned
from swamp_rl.boat import Boat
from swamp_rl.constants import SWAMP_LENGTH
from swamp_rl.guidance.drive import Drive
from swamp_rl.guidance.following import LOOKAHEAD, steered, turning_to
from swamp_rl.guidance.holding import (
    GUST,
    HALVINGS,
    HEADINGS,
    RESERVE,
    Holding,
    in_flow,
    steady_force,
    steady_force_of,
)
from swamp_rl.guidance.loop import Seen
from swamp_rl.guidance.servo import VelocityServo
from swamp_rl.guidance.station import POSITION_GAIN, SPEED_LIMIT
from swamp_rl.simulator import parameters, tank

Array = NDArray[np.float64]

INTEGRAL = 0.05  # 1/s, of the displacement to the side, of a boat as long as SWAMP
FARTHEST = 1.0  # rad that the bow leaves the weather by at most
TURNED = math.radians(5.0)  # that the weather turns the bow by, from where it must come back
STILL = 1e-9  # m/s, the rounding of a current from abeam


def pushes_sideways(drive: Drive) -> bool:
    """Whether a sway force can be had without a moment."""
    return (
        isinstance(drive, Jets)
        and min(largest_multiple(drive, np.array([0.0, side, 0.0])) for side in (1.0, -1.0)) > 0.0
    )


def margin_of(drive: Drive, needed: Array, velocity: Array) -> float:
    """How many times [1] surge force and yaw moment of `needed` (3,) can be had at a velocity (3,) through
    the water; the sway force is left to the weather."""
    along = needed * np.array([1.0, 0.0, 1.0])
    if isinstance(drive, Jets):
        return largest_multiple(in_flow(drive, math.hypot(*velocity[:2])), along)
    return drive.largest_multiple(along, velocity)


def velocity_through_water(p: Any, heading: float) -> Array:
    """(3,) surge, sway [m/s], yaw rate of a boat at rest over ground in the current of its record p."""
    ahead, starboard = turned(float(p["current_north"]), float(p["current_east"]), -heading)
    return np.array([-ahead, -starboard, 0.0])


def unsteadiness(drive: Drive, p: Any, curves: Array, heading: float) -> str:
    """Why a boat of record p and towing-tank curves does not keep its bow at a heading [rad]; else nothing.

    A rudder needs water from ahead or the propeller's slipstream, which a current from astern takes away.
    Turned by `TURNED`, the boat must attain the moment that balances the weather there, and a tenth more.
    """
    if isinstance(drive, Propellers) and velocity_through_water(p, heading)[0] < -STILL:
        return "the current comes from astern, where rudder and hull do not keep a heading"
    for off in (heading - TURNED, heading + TURNED):
        flow = velocity_through_water(p, off)
        for gust in (0.0, GUST):
            if margin_of(drive, steady_force_of(p, curves, off, gust), flow) < RESERVE:
                return f"the thrusters cannot turn the bow back from {math.degrees(TURNED):.0f} deg beside it"
    return ""


def weather_heading(boat: Boat, drive: Drive) -> Holding | None:
    """The heading at which current and wind push the boat straight astern, with the greatest margin.

    boat: with the current and wind that are believed in its effects. One that the bow keeps comes before
    one that it does not; None where there is none.
    """
    found = [_balance(boat, drive, heading) for heading in _ahead_roots(boat)]
    return max(found, key=lambda one: (one.holds, one.margin), default=None)


def _ahead_roots(boat: Boat) -> list[float]:
    """Headings [rad] at which no sway force is needed and the surge force is ahead, by bisection."""
    tried = np.arange(HEADINGS) * 2.0 * math.pi / HEADINGS + 1e-3
    sway = [float(steady_force(boat, float(heading))[1]) for heading in tried]
    roots = []
    for i, heading in enumerate(tried):
        if sway[i] * sway[(i + 1) % HEADINGS] >= 0.0:
            continue
        low, high = float(heading), float(heading) + 2.0 * math.pi / HEADINGS
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if steady_force(boat, middle)[1] * sway[i] > 0.0 else (low, middle)
        if steady_force(boat, low)[0] > 0.0:
            roots.append(low)
    return roots


def _balance(boat: Boat, drive: Drive, heading: float) -> Holding:
    p, curves = parameters(boat)[0], tank(boat)
    flow = velocity_through_water(p, heading)
    calm, gusty = (steady_force_of(p, curves, heading, gust) for gust in (0.0, GUST))
    margin = min(margin_of(drive, calm, flow), margin_of(drive, gusty, flow))
    why = unsteadiness(drive, p, curves, heading) if margin >= RESERVE else ""
    return Holding(heading, calm, margin, why)


@dataclass
class WeathervaneKeeper:
    """Holds a place [m] with the bow at `heading` [rad], where the weather pushes the boat astern.

    Surge speed over ground by the distance along that line; the bow leaves the weather by atan(e / Δ) for the
    distance e to its side, and by its integral. length [m]: of the boat.
    """

    drive: Drive
    servo: VelocityServo
    place: tuple[float, float]
    heading: float
    length: float = SWAMP_LENGTH
    memory: float = 0.0

    def act(self, seen: Seen, dt: float) -> Array:
        """(2K,) azimuths or rudder angles [rad], then throttles [1] or revolutions [rps]."""
        scale = self.length / SWAMP_LENGTH
        north, east = self.place[0] - seen.north, self.place[1] - seen.east
        ahead, starboard = turned(north, east, -self.heading)
        limit = SPEED_LIMIT * scale**0.5
        speed = min(max(POSITION_GAIN / scale**0.5 * ahead, -limit), limit)
        aside = starboard / (LOOKAHEAD * scale)
        self.memory = min(max(self.memory + INTEGRAL / scale**0.5 * dt * aside, -FARTHEST), FARTHEST)
        off = min(max(math.atan(aside) + self.memory, -FARTHEST), FARTHEST)
        turning = turning_to(self.heading + off, seen.heading, scale)
        return steered(self.drive, self.servo, speed, turning, seen, dt)

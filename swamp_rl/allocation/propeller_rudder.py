"""Thrust allocation to propellers with rudders, whose forces depend on the boat's speed: surge and yaw."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation.allocate import Allocation
from swamp_rl.boat import Boat, PropellerRudder
from swamp_rl.errors import UserError
from swamp_rl.physics.compile import compiled
from swamp_rl.physics.propulsion import propeller_with_rudder
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]
HALVINGS = 40
SHARES = (0.01, 0.1, 1.0)  # of a wanted force, from which its largest multiple is sought
MOST = 50.0  # multiples of a wanted force beyond which no one asks
WITHIN = 1e-5  # of a wanted force, within which it counts as achieved
LEAST = 1e-6  # of the thrust at rest: a smaller force counts as achieved within WITHIN of this one


@compiled
def rudder_for(
    yaw: float, n: float, low: float, high: float, u: float, v: float, r: float, k: int, p: Any
) -> float:
    """Rudder angle [rad] in [low, high] at which propeller k at n [rps] gives a yaw moment [N m].

    The end of the range that comes nearest where none does. By bisection: the moment is monotonic in the
    angle up to the stall that the model does not have; u, v [m/s], r [rad/s] through the water.
    """
    at_low = propeller_with_rudder(low, n, u, v, r, k, p)[2]
    at_high = propeller_with_rudder(high, n, u, v, r, k, p)[2]
    rising = at_high >= at_low  # else the water comes from astern
    if yaw <= min(at_low, at_high):
        return low if rising else high
    if yaw >= max(at_low, at_high):
        return high if rising else low
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if (propeller_with_rudder(middle, n, u, v, r, k, p)[2] < yaw) == rising:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@compiled
def commands_for(
    surge: float, yaw: float, low: float, high: float, u: float, v: float, r: float, k: int, p: Any
) -> tuple[float, float]:
    """Rudder angle [rad] and revolutions [rps] of propeller k for a surge force [N] and a yaw moment [N m].

    Bisection on the revolutions, the rudder laid for the yaw moment at each (`rudder_for`). The surge force
    comes first: what the rudder cannot give at those revolutions is missing in yaw.
    """
    slow, fast = -p.revolutions_max_astern[k], p.revolutions_max[k]
    for _ in range(HALVINGS):
        n = 0.5 * (slow + fast)
        angle = rudder_for(yaw, n, low, high, u, v, r, k, p)
        if propeller_with_rudder(angle, n, u, v, r, k, p)[0] < surge:
            slow = n
        else:
            fast = n
    n = 0.5 * (slow + fast)
    return rudder_for(yaw, n, low, high, u, v, r, k, p), n


@dataclass(frozen=True)
class Propellers:
    """K propellers with their rudders, in the order of the boat file; lever [m]: of a moment, for its size as
    a force; thrust [N]: of all together at rest; record: (1,) parameters of the boat.
    """

    names: tuple[str, ...]
    lever: float
    thrust: float
    record: NDArray[Any]

    def allocate(self, wanted: Array, velocity: Array, rudder: Array, step: float = math.inf) -> Allocation:
        """Rudder angles [rad] and revolutions [rps] for a surge force [N] and a yaw moment [N m].

        wanted: (3,), of which the sway force is not allocated; velocity: (3,) surge, sway [m/s], yaw rate
        [rad/s] through the water; rudder: (K,) where they are now [rad]; step: time [s] they have to turn.
        Each propeller gives an equal part. `achieved` (3,) holds the sway force that comes along.
        """
        p, count = self.record[0], len(self.names)
        u, v, r = velocity.tolist()
        angle, level = np.zeros(count), np.zeros(count)
        achieved, forces = np.zeros(3), np.zeros((count, 2))
        for k in range(count):
            reach = float(p["azimuth_rate"][k]) * step
            low = max(float(p["azimuth_min"][k]), float(rudder[k]) - reach)
            high = min(float(p["azimuth_max"][k]), float(rudder[k]) + reach)
            share = wanted / count
            angle[k], level[k] = commands_for(float(share[0]), float(share[2]), low, high, u, v, r, k, p)
            given = propeller_with_rudder(angle[k], level[k], u, v, r, k, p)
            forces[k], achieved = given[:2], achieved + np.array(given)
        missing = (achieved - wanted)[[0, 2]] / np.array([1.0, self.lever])
        size = float(np.hypot(wanted[0], wanted[2] / self.lever))
        met = bool(np.hypot(*missing) <= WITHIN * max(size, LEAST * self.thrust))
        return Allocation(angle, level, forces, wanted, achieved, met)

    def largest_multiple(self, wanted: Array, velocity: Array) -> float:
        """The largest multiple [1], MOST at most, of `wanted` (3,) of which surge and yaw can be had.

        velocity: (3,) through the water [m/s, rad/s]. 0 where neither a hundredth of it, a tenth nor the
        whole can be had: in a flow from the side the rudder has a moment by itself, and little of a force
        may be out of reach where all of it is not. The sway force is left out.
        """
        rest = np.zeros(len(self.names))

        def had(multiple: float) -> bool:
            return self.allocate(multiple * wanted, velocity, rest).attainable

        low = next((share for share in SHARES if had(share)), 0.0)
        if not low:
            return 0.0
        high = MOST
        for _ in range(HALVINGS // 2):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if had(middle) else (low, middle)
        return low


def propellers_of(boat: Boat) -> Propellers:
    """The boat's propellers with rudders and its own effects; UserError where it has a jet besides."""
    for thruster in boat.thrusters:
        if not isinstance(thruster, PropellerRudder):
            raise UserError(
                f"boat {boat.name}: thrusters.{thruster.name} is not a propeller with a rudder; allocation "
                "serves boats with jets alone or with such propellers alone"
            )
    record = parameters(boat)
    fastest = record[0]["revolutions_max"].tolist()
    at_rest = (propeller_with_rudder(0.0, n, 0.0, 0.0, 0.0, k, record[0])[0] for k, n in enumerate(fastest))
    return Propellers(boat.thruster_names, 0.5 * boat.length, sum(map(abs, at_rest)), record)

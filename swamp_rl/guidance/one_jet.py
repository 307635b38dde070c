"""Station keeping with the last working jet: two forces for three degrees of freedom.

One jet cannot choose the heading: there the boat lies where the moment of current and wind and that of its
jet cancel. About that heading the boat is steered by optimal control of the linear model (LQR), with the
position's integral, so that a current a little other than believed only shifts the heading.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation import Jets, allocate
from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.guidance.holding import Holding
from swamp_rl.guidance.loop import Seen
from swamp_rl.physics.force_curve import JET
from swamp_rl.physics.motion import constants_of, rates, water_velocity
from swamp_rl.physics.thrusters import put_output
from swamp_rl.simulator import parameters, tank

Array = NDArray[np.float64]

# What an error costs beside a newton: position [m], heading [rad], velocities, and the position's integral.
STATE_COST = np.array([4.0, 4.0, 4.0, 4.0, 4.0, 2.0, 0.02, 0.02])
FORCE_COST = np.array([1.0, 1.0])
DIFFERENCE = 1e-5
INTEGRAL_LIMIT = 30.0  # m s


def linear_model(boat: Boat, jets: Jets, k: int, balance: Holding) -> tuple[Array, Array]:
    """A (6, 6) and B (6, 2) about the balance: pose and velocity over ground by jet k's force [N]."""
    record, curves = parameters(boat)[0], tank(boat)
    point = np.array([0.0, 0.0, balance.heading, 0.0, 0.0, 0.0, *balance.needed[:2]])

    def rate(x: Array) -> Array:
        forces = np.zeros((1, len(jets.names), JET))
        put_output(x[6], x[7], forces, 0, k, record)
        return _rates_over_ground(x[:6], forces, record, curves)

    columns = [(rate(point + d) - rate(point - d)) / (2 * DIFFERENCE) for d in DIFFERENCE * np.eye(8)]
    slopes = np.array(columns).T
    return slopes[:, :6], slopes[:, 6:]


def _rates_over_ground(x: Array, forces: Array, record: Any, curves: Array) -> Array:
    """(6,) time derivatives of pose and velocity over ground; the current turns in the boat's frame."""
    north, east = water_velocity(0.0, record)
    cos, sin = math.cos(x[2]), math.sin(x[2])
    along, across = north * cos + east * sin, east * cos - north * sin
    motion = (x[0], x[1], x[2], x[3] - along, x[4] - across, x[5])
    blows, comes_from = float(record["wind_speed"]), float(record["wind_from"])
    wind = blows * math.cos(comes_from), blows * math.sin(comes_from)
    held = wind, constants_of(record, curves)
    moved = np.array([*rates(motion, forces, 0, 0.0, (north, east), held, record, curves)], dtype=float)
    moved[3:5] += x[5] * np.array([across, -along])
    return moved


def gains(A: Array, B: Array) -> Array:
    """(2, 8) LQR gains on pose, velocity and the integral of the position."""
    from scipy.linalg import solve_continuous_are

    A_long = np.zeros((8, 8))
    A_long[:6, :6] = A
    A_long[6, 0] = A_long[7, 1] = 1.0
    B_long = np.vstack([B, np.zeros((2, 2))])
    P = solve_continuous_are(A_long, B_long, np.diag(STATE_COST), np.diag(FORCE_COST))
    return np.asarray((B_long.T @ P) / FORCE_COST[:, None])


class OneJetKeeper:
    """Holds a place [m] with jet k alone, the bow where the balance has it.

    boat: with the current and wind that are believed in its effects. UserError where the balance cannot be
    held.
    """

    def __init__(self, boat: Boat, jets: Jets, place: tuple[float, float], balance: Holding) -> None:
        if not balance.holds:
            raise UserError(f"{balance.reason}; give it a second jet, or another place")
        self.jets = jets
        self.place = place
        self.balance = balance
        self.k = int(np.flatnonzero(jets.works)[0])
        self.gains = gains(*linear_model(boat, jets, self.k, balance))
        self.integral = np.zeros(2)

    def act(self, seen: Seen, dt: float) -> Array:
        """(2K,) azimuths [rad] then throttles [1]."""
        away = np.array([seen.north, seen.east]) - self.place
        turned = wrapped(seen.heading - self.balance.heading)
        x = np.concatenate([away, [turned], seen.velocity, self.integral])
        force = self.balance.needed[:2] - self.gains @ x
        moment = self.jets.x[self.k] * force[1] - self.jets.y[self.k] * force[0]
        found = allocate(self.jets, np.array([*force, moment]), seen.azimuth, dt)
        self.integral = np.clip(self.integral + dt * away, -INTEGRAL_LIMIT, INTEGRAL_LIMIT)
        return found.commands

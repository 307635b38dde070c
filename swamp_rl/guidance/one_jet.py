"""Station keeping with the last working jet: two forces for three degrees of freedom.

One jet cannot choose the heading: there the boat lies where the moment of current and wind and that of its
jet cancel. About that heading the boat is steered by optimal control of the linear model (LQR), with the
position's integral, so that a current a little other than believed only shifts the heading. Forces commanded
are those of the jet at rest; the balance takes account of what it loses in the flow.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation import Jets, allocate
from swamp_rl.angles import turned, wrapped
from swamp_rl.boat import Boat
from swamp_rl.constants import SWAMP_LENGTH
from swamp_rl.errors import UserError
from swamp_rl.guidance.holding import Holding
from swamp_rl.guidance.loop import Seen
from swamp_rl.physics.force_curve import JET
from swamp_rl.physics.motion import constants_of, rates, water_velocity
from swamp_rl.physics.thrusters import loss_in_flow, put_output, slowness_of
from swamp_rl.simulator import parameters, tank

Array = NDArray[np.float64]

# Cost of position [m], heading [rad], velocities and the position's integral, and of the force over the mass
# [m/s2]; of a boat as long as SWAMP, others by Froude's law.
STATE_COST = np.array([4.0, 4.0, 4.0, 4.0, 4.0, 2.0, 0.02, 0.02])
STATE_POWERS = np.array([1.0, 1.0, 0.0, 0.5, 0.5, -0.5, 1.5, 1.5])  # of the length, by which states scale
ACCELERATION_COST = 58.0**2  # 1 / N2 at SWAMP's mass
DIFFERENCE = 1e-5
INTEGRAL_SHARE = 0.4  # of the jet's greatest thrust, that the integral asks for at most
HALVINGS = 40


def force_at_rest(boat: Boat, jets: Jets, k: int, balance: Holding) -> Array:
    """(2,) force [N] that jet k gives at rest where in the flow of the balance it gives what is needed.

    Bisection: the force in the flow rises with that at rest; within the jet's greatest thrust.
    """
    record, (x, y) = parameters(boat)[0], balance.needed[:2]
    u, v = (-one for one in turned(*water_velocity(0.0, record), -balance.heading))
    thrust = math.hypot(x, y)
    low, high = 0.0, float(jets.thrust_max[k]) / thrust
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        slowness = slowness_of(middle * thrust, k, record)
        left = loss_in_flow(x, y, thrust, slowness, u, v, 0.0, k, record)
        low, high = (middle, high) if middle * left < 1.0 else (low, middle)
    return 0.5 * (low + high) * np.array([x, y])


def linear_model(boat: Boat, jets: Jets, k: int, heading: float, force: Array) -> tuple[Array, Array]:
    """A (6, 6) and B (6, 2) at rest over ground at `heading` [rad]: pose and velocity over ground by jet k's
    force at rest, about `force` (2,) [N]."""
    record, curves = parameters(boat)[0], tank(boat)
    point = np.array([0.0, 0.0, heading, 0.0, 0.0, 0.0, *force])

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


def gains(A: Array, B: Array, length: float, mass: float) -> Array:
    """(2, 8) LQR gains on pose, velocity and the integral of the position, of a boat of a length [m] and a
    mass [kg]."""
    from scipy.linalg import solve_continuous_are

    A_long = np.zeros((8, 8))
    A_long[:6, :6] = A
    A_long[6, 0] = A_long[7, 1] = 1.0
    B_long = np.vstack([B, np.zeros((2, 2))])
    state_cost = STATE_COST / (length / SWAMP_LENGTH) ** (2.0 * STATE_POWERS)
    force_cost = ACCELERATION_COST / mass**2
    P = solve_continuous_are(A_long, B_long, np.diag(state_cost), force_cost * np.eye(2))
    return np.asarray((B_long.T @ P) / force_cost)


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
        self.force = force_at_rest(boat, jets, self.k, balance)
        model = linear_model(boat, jets, self.k, balance.heading, self.force)
        self.gains = gains(*model, boat.length, boat.mass)
        largest = np.abs(self.gains[:, 6:]).max()
        self.limit = INTEGRAL_SHARE * float(jets.thrust_max[self.k]) / largest  # m s
        self.integral = np.zeros(2)

    def act(self, seen: Seen, dt: float) -> Array:
        """(2K,) azimuths [rad] then throttles [1]."""
        away = np.array([seen.north, seen.east]) - self.place
        off = wrapped(seen.heading - self.balance.heading)
        x = np.concatenate([away, [off], seen.velocity, self.integral])
        force = self.force - self.gains @ x
        moment = self.jets.x[self.k] * force[1] - self.jets.y[self.k] * force[0]
        found = allocate(self.jets, np.array([*force, moment]), seen.azimuth, dt)
        self.integral = np.clip(self.integral + dt * away, -self.limit, self.limit)
        return found.commands

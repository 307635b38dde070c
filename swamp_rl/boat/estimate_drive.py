"""Estimates of what drives a boat and of the resistance that it meets at its top speed."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from swamp_rl.boat.defaults import assumed
from swamp_rl.boat.estimate_hull import fullness
from swamp_rl.constants import GRAVITY

STEEPNESS = 0.9  # of R / W = 0.9 Fn³, through the deepest curve of SWAMP's towing tank
GIVEN_SD, ESTIMATED_SD = 0.2, 0.5  # of a thrust that is given, and of one by STEEPNESS
FASTEST = 1.0  # Froude number that is not exceeded where no top speed is given
ASTERN = 0.6  # thrust astern over thrust ahead
SCREW_LOSS, JET_LOSS = 0.5, 0.6  # share of the bollard thrust lost at the top speed
LAG = 0.3  # of the thrust, over √(L/g)
TURN_RATE = 0.4  # of an azimuth thruster, times √(L/g)
STEER_RATE = 0.5  # of an outboard, a nozzle or a rudder, times √(L/g)
STEER = math.radians(30.0)  # most that an outboard or a nozzle turns
RUDDER = math.radians(35.0)
ADVANCE = 0.4  # J of the propeller at the top speed
LEAST_ADVANCE = 0.3  # where J of 0.4 has no room below 0.7 of the draught
K_T = (0.3278, -0.3323, -0.156)  # of a propeller with P/D = 0.72
PITCH = 0.7151
WIDEST_SCREW = 0.7  # diameter over draught, of a propeller within the depth of the hull
WIDEST_BELOW = 0.5  # diameter over breadth, of one that reaches below the hull
ABREAST = 0.35  # of the breadth: distance of thrusters from the centre line of one hull
CORNERS = (
    ("bow_port", 1.0, -1.0),
    ("bow_starboard", 1.0, 1.0),
    ("stern_port", -1.0, -1.0),
    ("stern_starboard", -1.0, 1.0),
)
"""Names of thrusters with their ends (bow 1) and sides (starboard 1)."""
AZIMUTHS = {"azimuth": (("bow", 1.0, 0.0), ("stern", -1.0, 0.0)), "four-azimuths": CORNERS}
"""The thrusters that turn all the way, by kind."""
FIXED = {
    "twin-fixed": (0.45, 0.0, (("port", -1.0, -1.0), ("starboard", -1.0, 1.0))),
    "four-fixed": (0.4, math.radians(45.0), CORNERS),
}
"""The fixed thrusters by kind: distance from midship over length, angle to the centre line, at the bow
towards it, and places."""
OSAKA = "as the Esso Osaka model, Miyauchi et al. 2022"
YOSHIMURA = "Yoshimura and Masumoto 2012"
MOMENTUM = "momentum theory: a jet of constant speed"
OURS = "ours, usual of small craft"
OF_SPEED = "by R = 0.9 m g Fn³ at the top speed, SWAMP's tank"


class Sizes(NamedTuple):
    """length, breadth, draught [m], mass [kg], block coefficient [1], water density [kg/m3] of a boat.

    thrust [N]: of all thrusters together, full ahead at rest; speed [m/s] that it reaches then.
    demihull [m]: breadth of each of two hulls, the breadth of the boat where it has one. thrust_given:
    whether the thrust is no estimate.
    """

    length: float
    breadth: float
    draught: float
    mass: float
    block: float
    water_density: float
    thrust: float
    speed: float
    demihull: float
    thrust_given: bool = True

    @property
    def thrust_sd(self) -> float:
        """Standard deviation of the thrust's prior, a share of it."""
        return GIVEN_SD if self.thrust_given else ESTIMATED_SD

    @property
    def spacing(self) -> float:
        """Distance [m] of the centre planes of two hulls, 0 of one."""
        return self.breadth - self.demihull

    @property
    def abreast(self) -> float:
        """Distance [m] of thrusters from the centre line: on the centre planes of two hulls."""
        return 0.5 * self.spacing or ABREAST * self.breadth

    @property
    def passing(self) -> float:
        """√(L/g) [s], the time by which Froude's law scales."""
        return math.sqrt(self.length / GRAVITY)


def loss_at_speed(kind: str) -> float:
    """Share [1] of the bollard thrust that a kind of drive has lost at the boat's top speed."""
    if kind == "propeller-rudder":
        return 1.0 - _open_water(ADVANCE) / K_T[0]
    return JET_LOSS if kind == "waterjet" else SCREW_LOSS


def speed_of_thrust(length: float, mass: float, thrust: float) -> float:
    """Speed [m/s] at which R = 0.9 m g Fn³ equals a thrust [N], at a Froude number of 1 at most."""
    froude = min((thrust / (STEEPNESS * mass * GRAVITY)) ** (1.0 / 3.0), FASTEST)
    return froude * math.sqrt(GRAVITY * length)


def resistance_at(length: float, mass: float, speed: float) -> float:
    """R = 0.9 m g Fn³ [N] at a speed [m/s]."""
    return STEEPNESS * mass * GRAVITY * (speed / math.sqrt(GRAVITY * length)) ** 3


def resistance_section(kind: str, sizes: Sizes, source: str) -> dict[str, Any]:
    """Section `resistance`: X'_0 = −R / (½ρLdU²) where R is what is left of the thrust at the top speed U.

    source: where U comes from. Astern half as much again.
    """
    left = (1.0 - loss_at_speed(kind)) * sizes.thrust
    if kind == "propeller-rudder":
        left = _thrust_at_speed(sizes)
    ahead = left / (0.5 * sizes.water_density * sizes.length * sizes.draught * sizes.speed**2)
    origin = f"what is left of the thrust at the top speed, {source}"
    return {
        "x_0_ahead": assumed(-ahead, "1", origin, 0.4 * ahead),
        "x_0_astern": assumed(-1.5 * ahead, "1", "ours, 1.5 times x_0_ahead", 0.6 * ahead),
    }


def thrusters_of(kind: str, sizes: Sizes) -> list[dict[str, Any]]:
    """Sections of `thrusters` of a kind of drive, each with an equal part of the thrust."""
    length = sizes.length
    if kind in FIXED:
        reach, angle, places = FIXED[kind]
        return [
            _pushing(
                sizes,
                kind,
                name,
                1.0 / len(places),
                (end * reach * length, side * sizes.abreast),
                _fixed(-end * side * angle),
                ASTERN,
                math.cos(angle),
            )
            for name, end, side in places
        ]
    if kind in AZIMUTHS:
        turning = {"kind": "azimuth", **_servo(TURN_RATE, sizes)}
        share = 1.0 / len(AZIMUTHS[kind])
        return [
            _pushing(sizes, kind, name, share, (end * 0.4 * length, side * sizes.abreast), turning, 0.0)
            for name, end, side in AZIMUTHS[kind]
        ]
    if kind == "propeller-rudder":
        return [_propeller_rudder(sizes)]
    ends = {
        "azimuth_min": assumed(-STEER, "rad", OURS, 0.1),
        "azimuth_max": assumed(STEER, "rad", OURS, 0.1),
    }
    steered = {"kind": "azimuth", **ends, **_servo(STEER_RATE, sizes)}
    name = "jet" if kind == "waterjet" else "outboard"
    return [_pushing(sizes, kind, name, 1.0, (-0.5 * length, 0.0), steered, ASTERN)]


def _fixed(angle: float) -> dict[str, Any]:
    source = f"{OURS}, {math.degrees(abs(angle)):g} deg" if angle else "straight ahead"
    own = assumed(angle + 0.0, "rad", source)  # no minus zero
    return {"kind": "fixed", "azimuth_min": own, "azimuth_max": own}


def _servo(rate: float, sizes: Sizes) -> dict[str, Any]:
    speed, lag = rate / sizes.passing, 0.1 * sizes.passing
    return {
        "azimuth_rate": assumed(speed, "rad/s", f"{OURS}, {rate:g} over √(L/g)", 0.7 * speed),
        "azimuth_time_constant": assumed(lag, "s", f"{OURS}, 0.1 √(L/g)", lag),
    }


def _pushing(
    sizes: Sizes,
    kind: str,
    name: str,
    share: float,
    place: tuple[float, float],
    turning: Mapping[str, Any],
    astern: float,
    ahead: float = 1.0,
) -> dict[str, Any]:
    """A jet or a screw without rudder: thrust p |p| at rest, which falls linearly with the boat's speed.

    T = T_0 (1 − V_a/V_o): a jet of constant speed V_o = √(T_0 / (ρ A)), with A such that `loss_at_speed` is
    lost at the top speed. ahead: part of its thrust that pushes ahead, of which `share` is a share, and of
    the speed that it meets.
    """
    share /= ahead
    full, lag = share * sizes.thrust, LAG * sizes.passing
    outflow = sizes.speed * ahead / loss_at_speed(kind)
    area = full / (sizes.water_density * outflow**2)
    given = "given" if sizes.thrust_given else OF_SPEED
    return {
        "name": name,
        **turning,
        "x": assumed(place[0], "m", "ours, where such drives are", 0.05 * sizes.length),
        "y": assumed(place[1], "m", "ours, where such drives are", 0.05 * sizes.breadth),
        "pump_time_constant": assumed(lag, "s", f"{OURS}, 0.3 √(L/g)", lag),
        "thrust_linear": assumed(0.0, "N", "thrust by the square of the throttle", 0.3 * full),
        "thrust_quadratic": assumed(full, "N", f"{given}, {share:.3g} of the thrust", sizes.thrust_sd * full),
        "astern_linear": assumed(0.0, "N", "thrust by the square of the throttle", 0.3 * astern * full),
        "astern_quadratic": assumed(astern * full, "N", f"{OURS}, {astern:g} of ahead", 0.3 * astern * full),
        "dead_band": assumed(0.0, "1", "none known", 0.05),
        "nozzle_area": assumed(area, "m2", f"{MOMENTUM}, {loss_at_speed(kind):g} lost at speed", 0.5 * area),
        "advance_loss": assumed(1.0, "1", MOMENTUM, 0.3),
    }


def _open_water(advance: float) -> float:
    """K_T [1] at the advance ratio J."""
    return K_T[0] + K_T[1] * advance + K_T[2] * advance**2


def _wake(sizes: Sizes) -> tuple[float, float]:
    """Wake fraction 0.5 C_B − 0.05 (Taylor), not below 0, and thrust deduction 0.7 of it (Weingart) [1]."""
    wake = max(0.5 * sizes.block - 0.05, 0.0)
    return wake, 0.7 * wake


def _screw(sizes: Sizes) -> tuple[float, float]:
    """Diameter D [m] and greatest revolutions n [rps].

    (1 − t) ρ n² D⁴ K_T(0) = T at rest, and J = U (1 − w)/(n D) = 0.4 at the top speed. Where D would then be
    beyond 0.7 d, it is 0.7 d, but at least that of J = 0.3, up to B/2: screws of shallow hulls reach below
    them. J = 0.3 is a slip of 0.58 at P/D = 0.72, that of a boat of 5 knots by 1.4 / kn^0.57 (Gerr,
    Propeller Handbook 1989); faster ones have less.
    """
    wake, deduction = _wake(sizes)
    root = math.sqrt(sizes.thrust / ((1.0 - deduction) * sizes.water_density * K_T[0]))  # n D²
    best, least = (root * advance / (sizes.speed * (1.0 - wake)) for advance in (ADVANCE, LEAST_ADVANCE))
    below = min(least, WIDEST_BELOW * sizes.breadth)
    diameter = min(best, max(WIDEST_SCREW * sizes.draught, below))
    return diameter, root / diameter**2


def _thrust_at_speed(sizes: Sizes) -> float:
    """(1 − t) ρ n² D⁴ K_T(J) [N] at the top speed."""
    wake, deduction = _wake(sizes)
    diameter, revolutions = _screw(sizes)
    advance = sizes.speed * (1.0 - wake) / (revolutions * diameter)
    return (1.0 - deduction) * sizes.water_density * revolutions**2 * diameter**4 * _open_water(advance)


def _propeller_rudder(sizes: Sizes) -> dict[str, Any]:
    diameter, revolutions = _screw(sizes)
    origin = "gives the thrust at rest" + ("" if sizes.thrust_given else f", {OF_SPEED}")
    rate, lag = STEER_RATE / sizes.passing, LAG * sizes.passing
    return {
        "name": "main",
        "kind": "propeller_rudder",
        "rudder_max": assumed(RUDDER, "rad", "usual, 35 deg"),
        "rudder_rate": assumed(rate, "rad/s", f"{OURS}, 0.5 over √(L/g)", 0.7 * rate),
        "rudder_time_constant": assumed(lag / 3.0, "s", f"{OURS}, 0.1 √(L/g)", lag / 3.0),
        "revolutions_max": assumed(revolutions, "rps", origin, 0.5 * sizes.thrust_sd * revolutions),
        "revolutions_max_astern": assumed(
            0.8 * revolutions, "rps", f"{OURS}, 0.8 of ahead", 0.2 * revolutions
        ),
        "revolutions_time_constant": assumed(lag, "s", f"{OURS}, 0.3 √(L/g)", lag),
        "dead_band": assumed(0.0, "1", "none known", 0.05),
        "propeller": _propeller(sizes, diameter),
        "rudder": _rudder(sizes),
    }


def _propeller(sizes: Sizes, diameter: float) -> dict[str, Any]:
    wake, deduction = _wake(sizes)
    return {
        "diameter": assumed(
            diameter,
            "m",
            "J of 0.4 at the top speed; 0.7 of the draught, or J of 0.3, at most",
            0.2 * diameter,
        ),
        "pitch_ratio": assumed(PITCH, "1", OSAKA, 0.15),
        "thrust_deduction": assumed(deduction, "1", "0.7 of the wake, Weingart", 0.05),
        "wake_zero": assumed(wake, "1", "0.5 C_B - 0.05, Taylor", 0.1),
        "wake_tau": assumed(0.0, "1", "ours, the same in a turn", 0.5),
        "wake_c_p": assumed(0.0, "1", "ours, the same in a turn", 0.3),
        "x_wake": assumed(-0.5, "1", "at the stern", 0.05),
        "k_t": assumed(list(K_T), "1", OSAKA, [0.05, 0.05, 0.05]),
        "astern_thrust": assumed([-0.251, -0.175, 0.33, -0.233], "1", OSAKA, 0.05),
        "side_force": assumed([0.0] * 8, "1", "none: which way it turns is not known", 0.005),
        "yaw_moment": assumed([0.0] * 8, "1", "none: which way it turns is not known", 0.002),
        "side_share": assumed(0.0, "1", "none: which way it turns is not known"),
    }


def _rudder(sizes: Sizes) -> dict[str, Any]:
    """DNV's least area L d (1 + 25 (B/L)²)/100; the interaction by Yoshimura and Masumoto's regressions."""
    f = fullness(sizes.block, sizes.length, sizes.demihull)
    area = sizes.length * sizes.draught * (1.0 + 25.0 * (sizes.breadth / sizes.length) ** 2) / 100.0
    gamma, epsilon = 2.06 * f + 0.14, 2.26 - 1.82 * (1.0 - _wake(sizes)[0])
    return {
        "x": assumed(-0.5 * sizes.length, "m", "at the stern", 0.03 * sizes.length),
        "area": assumed(area, "m2", "DNV's least area, L d (1 + 25 (B/L)²) / 100", 0.4 * area),
        "aspect_ratio": assumed(1.5, "1", OURS, 0.3),
        "thrust_deduction": assumed(0.39, "1", YOSHIMURA, 0.1),
        "a_h": assumed(3.6 * f, "1", f"{YOSHIMURA}, 3.6 C_B B/L", 0.2),
        "x_h": assumed(-0.4, "1", YOSHIMURA, 0.1),
        "flow_lever": assumed(-0.9, "1", YOSHIMURA, 0.2),
        "drift_slope": assumed(0.0, "1/rad", "ours, the same in drift"),
        "gamma_p": assumed(gamma, "1", f"{YOSHIMURA}, 2.06 C_B B/L + 0.14", 0.15),
        "gamma_n": assumed(gamma, "1", f"{YOSHIMURA}, 2.06 C_B B/L + 0.14", 0.15),
        "epsilon": assumed(epsilon, "1", f"{YOSHIMURA}, 2.26 - 1.82 (1 - w)", 0.3),
        "k_x": assumed(0.55, "1", f"{YOSHIMURA}, κ ε", 0.15),
        "k_x_astern": assumed(0.275, "1", "ours, half of k_x", 0.15),
        "c_pr": assumed(-0.176, "1", OSAKA, 0.1),
    }

"""Forces that no other effect names: functions of one variable of the motion or of a thruster.

A boat has up to CURVES of them, each a row of the record's field `force_curves`: its component, variable,
thruster and formula by their places in the tuples below, the number of its knots, the knots, the values.
A row whose component is 0, and all rows after it, are empty.
"""

import math
from typing import Any

from swamp_rl.physics.compile import compiled

CURVES, KNOTS = 4, 9
COMPONENT, COVARIATE, THRUSTER, FORMULA, COUNT, FIRST_KNOT = range(6)
FIRST_VALUE = FIRST_KNOT + KNOTS
WIDTH = FIRST_VALUE + KNOTS

COMPONENTS = ("none", "surge", "sway", "yaw", "north", "east", "thrust")
COVARIATES = (
    "time",
    "position_north",
    "position_east",
    "heading",
    "speed",
    "surge",
    "sway",
    "yaw_rate",
    "azimuth",
    "throttle",
)
FORMULAS = ("between_knots", "proportional", "square", "cube", "dead_zone", "outside_radius", "sine")
ANGLE_OF_THRUSTER, LEVEL_OF_THRUSTER, THRUST, SLOWNESS, JET = 2, 3, 4, 5, 6  # columns of `jets`, their number


@compiled
def covariate_value(
    motion: Any, u_ground: float, v_ground: float, time: float, jets: Any, moment: int, row: int, p: Any
) -> float:
    """The variable [SI, rad] that curve `row` is a function of; angles within a half turn of 0."""
    which = int(p.force_curves[row, COVARIATE])
    thruster = int(p.force_curves[row, THRUSTER])
    if which == 0:
        return time
    if which <= 2:
        return motion[0] if which == 1 else motion[1]
    if which == 4:
        return math.sqrt(u_ground * u_ground + v_ground * v_ground)
    if which == 5:
        return u_ground
    if which == 6:
        return v_ground
    if which == 7:
        return motion[5]
    if which == 9:
        return jets[moment, thruster, LEVEL_OF_THRUSTER]
    angle = motion[2] if which == 3 else jets[moment, thruster, ANGLE_OF_THRUSTER]
    angle -= 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)
    return min(max(angle, -math.pi), math.pi)


@compiled
def curve_value(x: float, row: int, p: Any) -> float:
    """Force [N] or moment [N m] of curve `row` at x; zero outside the first and the last knot.

    Linear between the knots, or of the coefficients a, b: a x; a |x| x; a x³; a sign(x) max(|x| − b, 0);
    a sign(x) where |x| > b; a sin(x − b).
    """
    count = int(p.force_curves[row, COUNT])
    if x < p.force_curves[row, FIRST_KNOT] or x > p.force_curves[row, FIRST_KNOT + count - 1]:
        return 0.0
    formula = int(p.force_curves[row, FORMULA])
    a, b = p.force_curves[row, FIRST_VALUE], p.force_curves[row, FIRST_VALUE + 1]
    if formula == 1:
        return a * x
    if formula == 2:
        return a * abs(x) * x
    if formula == 3:
        return a * x * x * x
    if formula == 4:
        return a * math.copysign(max(abs(x) - b, 0.0), x)
    if formula == 5:
        return math.copysign(a, a * x) if abs(x) > b else 0.0
    if formula == 6:
        return a * math.sin(x - b)
    right = 1
    while right < count - 1 and x > p.force_curves[row, FIRST_KNOT + right]:
        right += 1
    low, high = p.force_curves[row, FIRST_KNOT + right - 1], p.force_curves[row, FIRST_KNOT + right]
    before, after = p.force_curves[row, FIRST_VALUE + right - 1], p.force_curves[row, FIRST_VALUE + right]
    return before + (after - before) * (x - low) / (high - low)


@compiled(threaded=True)
def curve_forces(
    motion: Any, u_ground: float, v_ground: float, time: float, jets: Any, moment: int, p: Any
) -> tuple[float, float, float]:
    """Surge, sway force [N] and yaw moment [N m] of all curves at `time` [s].

    motion: as of `swamp_rl.physics.motion`; u_ground, v_ground [m/s] over ground, which the curves' speed,
    surge and sway are; jets[moment]: (K, JET), azimuths [rad] and levels [1] in two of its columns. A thrust
    acts along its thruster's azimuth; north and east forces act at midship.
    """
    cos, sin = math.cos(motion[2]), math.sin(motion[2])
    surge, sway, yaw = 0.0, 0.0, 0.0
    for row in range(CURVES):
        component = int(p.force_curves[row, COMPONENT])
        if component == 0:
            break
        x = covariate_value(motion, u_ground, v_ground, time, jets, moment, row, p)
        force = curve_value(x, row, p)
        if component == 1:
            surge += force
        elif component == 2:
            sway += force
        elif component == 3:
            yaw += force
        elif component == 4:
            surge, sway = surge + force * cos, sway - force * sin
        elif component == 5:
            surge, sway = surge + force * sin, sway + force * cos
        else:
            k = int(p.force_curves[row, THRUSTER])
            angle = jets[moment, k, ANGLE_OF_THRUSTER] + p.azimuth_offset[k]
            ahead, aside = force * math.cos(angle), force * math.sin(angle)
            surge, sway = surge + ahead, sway + aside
            yaw += p.thruster_x[k] * aside - p.thruster_y[k] * ahead
    return surge, sway, yaw

"""Forces of all that drives the boat: jets, propellers with rudders, thrusters with a propeller or a table.

Only the records of boats with a propeller or a table have its fields, so which functions serve a boat is
decided when they are compiled: a boat with jets alone runs the very code of `swamp_rl.physics.thrusters`.
"""

import math
from typing import Any

from swamp_rl.physics.compile import by_field, compiled
from swamp_rl.physics.foil import FOIL, all_foils
from swamp_rl.physics.propeller import propeller_forces, wake_factor
from swamp_rl.physics.rudder import inflow_across, inflow_ahead, rudder_forces
from swamp_rl.physics.screw import crossflow_left, flow_at, race_of, thrust_at
from swamp_rl.physics.thrusters import (
    beyond_dead_band,
    efficiency,
    jet_force,
    jet_forces,
    loss_in_flow,
    loss_under_way,
    slowness_of,
    thrust_share,
)

RUDDER = "propeller_diameter"  # the record's field of propellers with rudders
MARK = "drive"  # the record's field, of a boat that has other than jets: one of the next three
OF_JET, OF_SCREW, OF_RUDDER = 0.0, 1.0, 2.0
Three = tuple[float, float, float]


@compiled
def propeller_with_rudder(angle: float, n: float, u: float, v: float, r: float, k: int, p: Any) -> Three:
    """Surge, sway force [N] and yaw moment [N m] at rudder angle [rad] and n [rps]."""
    most = p.revolutions_max[k] if n >= 0.0 else p.revolutions_max_astern[k]
    share = abs(n) / most if most > 0.0 else 0.0
    gain = p.thrust_scale * p.thruster_gain[k] * efficiency(share, k, p)
    wake = wake_factor(u, v, r, k, p)
    x_propeller, y_propeller, n_propeller, thrust = propeller_forces(n, u, wake, k, p)
    u_rudder = inflow_ahead(n, u, wake, gain * thrust, k, p)
    x_rudder, y_rudder, n_rudder = rudder_forces(angle, u_rudder, inflow_across(u, v, r, k, p), k, p)
    side = p.propeller_side_share[k] * x_propeller
    return (
        gain * x_propeller + x_rudder,
        gain * (y_propeller + side) + y_rudder,
        gain * (n_propeller + p.thruster_x[k] * side) + n_rudder,
    )


@compiled
def no_rudder(angle: float, n: float, u: float, v: float, r: float, k: int, p: Any) -> Three:
    """Of a boat without a propeller with a rudder."""
    return 0.0, 0.0, 0.0


@compiled
def screw_forces(outputs: Any, moment: int, k: int, u: float, v: float, r: float, p: Any) -> Three:
    """Surge, sway force [N] and yaw moment [N m] of thruster k, one with a propeller or a table.

    outputs[moment]: (K, 2) by `actuator_output`. T = share · T(p, V_a) · k_f along the thrust, and of a
    propeller that interacts with another a share of T across it; V_a with the race that it stands in.
    """
    angle, throttle = outputs[moment, k, 0], outputs[moment, k, 1]
    along, across = flow_at(angle, u, v, r, k, p)
    ahead = int(p.wash_of[k])
    if ahead >= 0:
        level = outputs[moment, ahead, 1]
        inflow = flow_at(outputs[moment, ahead, 0], u, v, r, ahead, p)[0]
        pushed = thrust_share(level, ahead, p) * thrust_at(level, inflow, ahead, p)
        along += p.wash_share[k] * race_of(pushed, inflow, p.nozzle_area[ahead], p)
    thrust = thrust_share(throttle, k, p) * thrust_at(throttle, along, k, p)
    thrust *= crossflow_left(thrust, across, k, p)
    cos, sin, side = math.cos(angle), math.sin(angle), p.screw_side[k]
    x_force, y_force = thrust * (cos - side * sin), thrust * (sin + side * cos)
    if p.advance_loss[k] != 0.0 or p.crossflow_loss != 0.0:
        whole = math.sqrt(x_force * x_force + y_force * y_force)
        left = loss_in_flow(x_force, y_force, whole, slowness_of(whole, k, p), u, v, r, k, p)
        x_force, y_force = left * x_force, left * y_force
    return x_force, y_force, p.thruster_x[k] * y_force - p.thruster_y[k] * x_force


@compiled
def no_screw(outputs: Any, moment: int, k: int, u: float, v: float, r: float, p: Any) -> Three:
    """Of a boat without a thruster that has a propeller or a table."""
    return 0.0, 0.0, 0.0


rudder_if_any = by_field(RUDDER, propeller_with_rudder, no_rudder)
screw_if_any = by_field("wash_of", screw_forces, no_screw)


@compiled
def worn_jet(x_force: float, y_force: float, share: float, k: int, p: Any) -> tuple[float, float]:
    """The force of jet k that gives only that share [1] of its thrust."""
    return share * x_force, share * y_force


@compiled
def worn_either(first: float, second: float, share: float, k: int, p: Any) -> tuple[float, float]:
    """As `worn`, for a boat that has other than jets: a propeller turns slower by the root of its share."""
    if p.drive[k] != OF_JET:
        return first, second * math.sqrt(share)
    return worn_jet(first, second, share, k, p)


@compiled
def output_of_either(angle: float, level: float, k: int, p: Any) -> tuple[float, float]:
    """As `actuator_output`, for a boat that has other than jets."""
    if p.drive[k] == OF_JET:
        return jet_force(angle, level, k, p)
    most = p.level_max[k] if level >= 0.0 else -p.level_min[k]
    return angle + p.azimuth_offset[k], beyond_dead_band(level, most, k, p)


@compiled
def forces_of_both(outputs: Any, moment: int, u: float, v: float, r: float, p: Any) -> Three:
    """As `propulsion_forces`, for a boat that has other than jets."""
    surge, sway, yaw = 0.0, 0.0, 0.0
    for k in range(outputs.shape[1]):
        first, second = outputs[moment, k, 0], outputs[moment, k, 1]
        if p.drive[k] == OF_RUDDER:
            x_force, y_force, z_moment = rudder_if_any(first, second, u, v, r, k, p)
        elif p.drive[k] == OF_SCREW:
            x_force, y_force, z_moment = screw_if_any(outputs, moment, k, u, v, r, p)
        else:
            left = loss_under_way(outputs, moment, u, v, r, k, p)
            x_force, y_force = left * first, left * second
            z_moment = p.thruster_x[k] * y_force - p.thruster_y[k] * x_force
        surge, sway, yaw = surge + x_force, sway + y_force, yaw + z_moment
    return surge, sway, yaw


@compiled
def jet_limits(k: int, p: Any) -> tuple[float, float]:
    """Lowest and highest throttle [1] of jet k."""
    reverses = p.astern_linear[k] > 0.0 or p.astern_quadratic[k] > 0.0
    return -1.0 if reverses else 0.0, 1.0


@compiled
def limits_of_either(k: int, p: Any) -> tuple[float, float]:
    """As `throttle_limits`, for a boat that has other than jets."""
    return (p.level_min[k], p.level_max[k]) if p.drive[k] != OF_JET else jet_limits(k, p)


# Lowest and highest command of thruster k: throttle [1], or revolutions [rps] of a propeller with a rudder.
throttle_limits = by_field(MARK, limits_of_either, jet_limits)

# What thruster k hands on to `propulsion_forces`: a jet's force [N] along x and y, or, where the force
# depends on the boat's own speed, the angle [rad] and the revolutions [rps] or the throttle [1].
actuator_output = by_field(MARK, output_of_either, jet_force)

# An output of thruster k that gives only a share [1] of its thrust.
worn = by_field(MARK, worn_either, worn_jet)

forces_of_drives = by_field(MARK, forces_of_both, jet_forces)


@compiled
def forces_of_thrust(outputs: Any, moment: int, u: float, v: float, r: float, p: Any) -> Three:
    """As `propulsion_forces`, without foils."""
    return forces_of_drives(outputs, moment, u, v, r, p)


@compiled
def forces_with_foils(outputs: Any, moment: int, u: float, v: float, r: float, p: Any) -> Three:
    """As `propulsion_forces`, for a boat that has a thruster with a foil."""
    x_thrust, y_thrust, n_thrust = forces_of_thrust(outputs, moment, u, v, r, p)
    x_foils, y_foils, n_foils = all_foils(outputs, moment, u, v, r, p)
    return x_thrust + x_foils, y_thrust + y_foils, n_thrust + n_foils


# Total surge, sway force [N] and yaw moment [N m]; outputs[moment]: (K, JET) by `put_output`, with the angles
# of the thrusters where these have foils.
propulsion_forces = by_field(FOIL, forces_with_foils, forces_of_thrust)

"""Forces of all that drives the boat, jets or propellers with rudders.

Only the records of boats with a propeller have its fields, so which functions serve a boat is decided when
they are compiled: a boat with jets alone runs the very code of `swamp_rl.physics.thrusters`.
"""

import math
from typing import Any

from swamp_rl.physics.compile import by_field, compiled
from swamp_rl.physics.propeller import propeller_forces, wake_factor
from swamp_rl.physics.rudder import inflow_across, inflow_ahead, rudder_forces
from swamp_rl.physics.thrusters import beyond_dead_band, efficiency, jet_force, jet_forces, loss_under_way

MARK = "propeller_diameter"  # 0 for the jets of a boat that has both


@compiled
def propeller_with_rudder(
    angle: float, n: float, u: float, v: float, r: float, k: int, p: Any
) -> tuple[float, float, float]:
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
def worn_jet(x_force: float, y_force: float, share: float, k: int, p: Any) -> tuple[float, float]:
    """The force of jet k that gives only that share [1] of its thrust."""
    return share * x_force, share * y_force


@compiled
def worn_either(first: float, second: float, share: float, k: int, p: Any) -> tuple[float, float]:
    """As `worn`, for a boat with a propeller, which turns slower by the root of its share."""
    if p.propeller_diameter[k] > 0.0:
        return first, second * math.sqrt(share)
    return worn_jet(first, second, share, k, p)


@compiled
def output_of_either(angle: float, level: float, k: int, p: Any) -> tuple[float, float]:
    """As `actuator_output`, for a boat with a propeller."""
    if p.propeller_diameter[k] > 0.0:
        most = p.revolutions_max[k] if level >= 0.0 else p.revolutions_max_astern[k]
        return angle + p.azimuth_offset[k], beyond_dead_band(level, most, k, p)
    return jet_force(angle, level, k, p)


@compiled
def forces_of_both(
    outputs: Any, moment: int, u: float, v: float, r: float, p: Any
) -> tuple[float, float, float]:
    """As `propulsion_forces`, for a boat with a propeller."""
    surge, sway, yaw = 0.0, 0.0, 0.0
    for k in range(outputs.shape[1]):
        first, second = outputs[moment, k, 0], outputs[moment, k, 1]
        if p.propeller_diameter[k] > 0.0:
            x_force, y_force, z_moment = propeller_with_rudder(first, second, u, v, r, k, p)
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
    """As `throttle_limits`, for a boat with a propeller."""
    if p.propeller_diameter[k] > 0.0:
        return -p.revolutions_max_astern[k], p.revolutions_max[k]
    return jet_limits(k, p)


# Lowest and highest command of thruster k: throttle [1] of a jet, revolutions [rps] of a propeller.
throttle_limits = by_field(MARK, limits_of_either, jet_limits)

# What thruster k hands on to `propulsion_forces`: a jet's force [N] along x and y, or, where the force hangs
# on the boat's own speed, the rudder's angle [rad] and the revolutions [rps].
actuator_output = by_field(MARK, output_of_either, jet_force)

# An output of thruster k that gives only a share [1] of its thrust.
worn = by_field(MARK, worn_either, worn_jet)

# Total surge, sway force [N] and yaw moment [N m]; outputs[moment]: (K, JET) by `put_output`.
propulsion_forces = by_field(MARK, forces_of_both, jet_forces)

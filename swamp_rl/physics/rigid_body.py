"""Rigid body with added mass in the horizontal plane (thesis eq. 8.14)."""

from typing import Any

from swamp_rl.physics.compile import compiled


@compiled
def accelerations(
    u: float, v: float, r: float, surge: float, sway: float, yaw: float, p: Any
) -> tuple[float, float, float]:
    """u', v' [m/s^2] and r' [rad/s^2] from the forces [N] and the moment [N m] about midship.

    Velocities relative to the water: with the added mass on these, motion in a uniform current is exactly
    the motion in still water, carried along.
    """
    mass, x_g = p.mass, p.x_g
    a = mass - p.added_mass_sway
    b = mass * x_g
    d = p.inertia_z + mass * x_g * x_g - p.added_inertia_yaw
    sway_net = sway - mass * u * r
    u_dot = (mass * (v * r + x_g * r * r) + surge) / (mass - p.added_mass_surge)
    r_dot = (a * (yaw - b * u * r) - b * sway_net) / (a * d - b * b)
    v_dot = (sway_net - b * r_dot) / a
    return u_dot, v_dot, r_dot

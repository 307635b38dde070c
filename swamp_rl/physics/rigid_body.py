"""Rigid body with added mass in the horizontal plane (thesis eq. 8.14)."""

from typing import Any

from swamp_rl.physics.compile import compiled

Inverse = tuple[float, float, float, float]


@compiled
def inverse_inertia(p: Any) -> Inverse:
    """Inverse of the mass in surge [1/kg] and of the symmetric inertia of sway and yaw.

    The latter's elements: sway-sway [1/kg], sway-yaw [1/(kg m)], yaw-yaw [1/(kg m^2)]; A, B and D as in 8.14.
    """
    a = p.mass - p.added_mass_sway
    b = p.mass * p.x_g
    d = p.inertia_z + p.mass * p.x_g * p.x_g - p.added_inertia_yaw
    determinant = a * d - b * b
    return 1.0 / (p.mass - p.added_mass_surge), d / determinant, -b / determinant, a / determinant


@compiled
def accelerations(
    u: float, v: float, r: float, surge: float, sway: float, yaw: float, inverse: Inverse, p: Any
) -> tuple[float, float, float]:
    """u', v' [m/s^2] and r' [rad/s^2] from the forces [N] and the moment [N m] about midship (8.14).

    u' = [X + M (v r + x_G r²)] / (M − X_u̇),  r' = [A (N − M x_G u r) − B (Y − M u r)] / (A D − B²),
    v' = [Y − M u r − B r'] / A
    inverse: `inverse_inertia(p)`. Velocities relative to the water: with the added mass on these, motion in
    a uniform current is exactly the motion in still water, carried along.
    """
    surge_net = surge + p.mass * (v * r + p.x_g * r * r)
    sway_net = sway - p.mass * u * r
    yaw_net = yaw - p.mass * p.x_g * u * r
    in_surge, in_sway, coupled, in_yaw = inverse
    return (
        in_surge * surge_net,
        in_sway * sway_net + coupled * yaw_net,
        coupled * sway_net + in_yaw * yaw_net,
    )

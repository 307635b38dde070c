"""Forces of a fixed-pitch propeller in four quadrants (MMG form; Miyauchi 2022, after Hachii and Ueno)."""

import math
from typing import Any

from swamp_rl.physics.compile import by_field, compiled
from swamp_rl.physics.screw import SCREW, propeller_thrust

LEAST_SPEED = 1e-5  # m/s, below which v / U and r L / U mean nothing
ASTERN_STEEP, ASTERN_FLAT = -0.35, -0.06  # J_s where Hachii's side force changes its form


@compiled
def wake_factor(u: float, v: float, r: float, k: int, p: Any) -> float:
    """1 - w [1]: how much of the boat's speed the propeller meets, 1 for a boat that does not go ahead.

    w = w_P0 - tau |b| - C_P b^2, with b = v' + x'_P r' the sideways flow at the propeller.
    """
    if u <= 0.0:
        return 1.0
    speed = math.sqrt(u * u + v * v)
    if speed < LEAST_SPEED:
        return 1.0 - p.wake_zero[k]
    across = (v + p.x_wake[k] * r * p.length) / speed
    wake = p.wake_zero[k] - p.wake_tau[k] * abs(across) - p.wake_c_p[k] * across * across
    return min(max(1.0 - wake, 0.0), 1.0)


@compiled
def thrust_by_coefficients(n: float, inflow: float, k: int, p: Any) -> float:
    """rho n^2 D^4 K_T(J) [N] of a propeller turning ahead, J = inflow / (n D); without a division by n."""
    a = inflow / p.propeller_diameter[k]
    k_t = p.k_t[k]
    return p.water_density * p.propeller_diameter[k] ** 4 * (k_t[0] * n * n + k_t[1] * n * a + k_t[2] * a * a)


@compiled
def thrust_of_hachii(n: float, u: float, k: int, p: Any) -> float:
    """Thrust [N], negative, of a propeller turning astern (Hachii): ρ n² D⁴ C(J_s), J_s = u/(n D); n < 0."""
    j_s = u / (n * p.propeller_diameter[k])
    c = p.astern_thrust[k]
    factor = c[1] + c[2] * j_s if j_s >= c[3] else c[0]
    return p.water_density * n * n * p.propeller_diameter[k] ** 4 * factor


@compiled
def thrust_by_model(n: float, inflow: float, k: int, p: Any) -> float:
    """As `open_water_thrust`, for a boat with a propeller of `swamp_rl.physics.screw`."""
    if p.screw_model[k] > 0.0:
        return propeller_thrust(n, inflow, k, p)
    return thrust_by_coefficients(n, inflow, k, p)


@compiled
def astern_by_model(n: float, u: float, k: int, p: Any) -> float:
    """As `astern_thrust`, for a boat with a propeller of `swamp_rl.physics.screw`."""
    if p.screw_model[k] > 0.0:
        return propeller_thrust(n, u, k, p)
    return thrust_of_hachii(n, u, k, p)


# Thrust [N] of a propeller with a rudder: turning ahead at its inflow [m/s]; astern, negative, at u [m/s].
open_water_thrust = by_field(SCREW, thrust_by_model, thrust_by_coefficients)
astern_thrust = by_field(SCREW, astern_by_model, thrust_of_hachii)


@compiled
def side_factor(n: float, u: float, k: int, coefficients: Any, p: Any) -> float:
    """(n D)^2 [m^2/s^2] times the coefficient of the side force or the yaw moment that the propeller makes.

    None ahead; Hachii's for a propeller turning astern, Ueno's (on its pitch) for a boat that goes astern.
    """
    diameter = p.propeller_diameter[k]
    if n >= 0.0:
        if u >= 0.0:
            return 0.0
        a = u / diameter
        ueno = coefficients[5] * a * a + coefficients[6] * a * n + coefficients[7] * n * n
        return (p.pitch_ratio[k] * diameter) ** 2 * ueno
    j_s = u / (n * diameter)
    if j_s < ASTERN_STEEP:
        hachii = coefficients[2] + coefficients[3] * j_s
    elif j_s <= ASTERN_FLAT:
        hachii = coefficients[0] + coefficients[1] * j_s
    else:
        hachii = coefficients[4]
    return (n * diameter) ** 2 * hachii


@compiled
def propeller_forces(n: float, u: float, wake: float, k: int, p: Any) -> tuple[float, float, float, float]:
    """Surge, sway force [N] and yaw moment [N m] at n [rps], and the thrust [N] that drives the race.

    wake: `wake_factor`.
    """
    q = 0.5 * p.water_density * p.length * p.draught
    sway = q * side_factor(n, u, k, p.propeller_side_force[k], p)
    yaw = q * p.length * side_factor(n, u, k, p.propeller_yaw_moment[k], p)
    if n < 0.0:
        thrust = astern_thrust(n, u, k, p)
        return thrust, sway, yaw, thrust
    thrust = open_water_thrust(n, u * wake, k, p)
    return (1.0 - p.propeller_deduction[k]) * thrust, sway, yaw, thrust

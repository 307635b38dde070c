"""Forces of a rudder in the race of a propeller (MMG form; Miyauchi 2022, after Yoshimura and Kitagawa)."""

import math
from typing import Any

from swamp_rl.physics.compile import compiled
from swamp_rl.physics.foil import normal_force


@compiled
def inflow_ahead(n: float, u: float, wake: float, thrust: float, k: int, p: Any) -> float:
    """u_R [m/s], the flow along the boat at the rudder; wake: `wake_factor`; thrust [N]: open propeller's.

    A propeller that drives the boat ahead makes a race over the share eta of the rudder's height
    (Yoshimura); else Kitagawa's form. For a boat that goes astern the water's own speed.
    """
    if u < 0.0:
        return u
    diameter = p.propeller_diameter[k]
    eta = diameter / math.sqrt(p.rudder_area[k] * p.rudder_aspect_ratio[k])
    race = 8.0 * abs(thrust) / (math.pi * p.water_density * diameter * diameter)  # 8 K_T (n D)^2 / pi
    if n >= 0.0 and thrust > 0.0:
        at_propeller = u * wake
        kappa = p.rudder_k_x[k] / p.rudder_epsilon[k]
        inside = at_propeller + kappa * (math.sqrt(at_propeller * at_propeller + race) - at_propeller)
        mixed = eta * inside * inside + (1.0 - eta) * at_propeller * at_propeller
        return p.rudder_epsilon[k] * math.sqrt(mixed)
    outside = u * p.rudder_epsilon[k] * wake
    inside = outside + math.copysign(p.rudder_k_x_astern[k] * math.sqrt(race), n)
    square = eta * inside * abs(inside) + (1.0 - eta) * outside * outside + p.rudder_c_pr[k] * u * u
    return math.copysign(math.sqrt(abs(square)), square)


@compiled
def inflow_across(u: float, v: float, r: float, k: int, p: Any) -> float:
    """v_R = −γ_R (1 + s |β_R|) w [m/s], w = v + l_R L r: the flow across at the rudder, straightened by the
    hull, by less with its drift β_R = atan2(|w|, |u|) where s > 0.
    """
    gamma = p.rudder_gamma_p[k] if v + p.thruster_x[k] * r >= 0.0 else p.rudder_gamma_n[k]
    across = v + p.rudder_flow_lever[k] * p.length * r
    if p.rudder_drift_slope[k] == 0.0:  # most rudders: the angle is not needed
        return -gamma * across
    return -gamma * (1.0 + p.rudder_drift_slope[k] * math.atan2(abs(across), abs(u))) * across


@compiled
def rudder_forces(
    angle: float, u_rudder: float, v_rudder: float, k: int, p: Any
) -> tuple[float, float, float]:
    """Surge, sway force [N] and yaw moment [N m] of the rudder at `angle` δ [rad] in that flow [m/s].

    X = −(1 − t_R) F_N sin δ,  Y = −(1 + a_H) F_N cos δ,  N = −(x_R + a_H x_H) F_N cos δ, with
    F_N = ½ ρ A_R U_R² 6.13 Λ/(2.25 + Λ) sin(δ − atan2(v_R, u_R))

    and U_R sin(δ − atan2(v_R, u_R)) = u_R sin δ − v_R cos δ, which needs no angle of the flow.
    """
    cos, sin = math.cos(angle), math.sin(angle)
    speed = math.sqrt(u_rudder * u_rudder + v_rudder * v_rudder)
    across = u_rudder * sin - v_rudder * cos
    normal = normal_force(speed, across, p.rudder_area[k], p.rudder_aspect_ratio[k], p)
    surge = -(1.0 - p.rudder_deduction[k]) * normal * sin
    sway = -(1.0 + p.rudder_a_h[k]) * normal * cos
    lever = p.thruster_x[k] + p.rudder_a_h[k] * p.rudder_x_h[k] * p.length
    return surge, sway, -lever * normal * cos

"""Lift and induced drag of foils in a flow: rudders, and the legs, struts and nozzles of thrusters.

Normal force by Fujii and Tsuda (1961), as in the MMG model (Yasukawa and Yoshimura 2015,
10.1007/s00773-014-0293-y).
"""

import math
from typing import Any

from swamp_rl.physics.compile import compiled
from swamp_rl.physics.force_curve import ANGLE_OF_THRUSTER

FOIL = "foil_area"  # the record's field of thrusters with a foil


@compiled
def normal_force(speed: float, across: float, area: float, aspect: float, p: Any) -> float:
    """F_N = ½ ρ A U² 6.13 Λ/(2.25 + Λ) sin α [N], across the chord.

    speed: U [m/s]; across: U sin α [m/s], the flow across the chord; area: A [m²]; aspect: Λ [1].
    """
    return 0.5 * p.water_density * speed * across * area * 6.13 * aspect / (2.25 + aspect)


@compiled
def foil_forces(angle: float, u: float, v: float, r: float, k: int, p: Any) -> tuple[float, float, float]:
    """Surge, sway force [N] and yaw moment [N m] of the foil of thruster k, its chord at `angle` δ [rad].

    X = F_N sin δ,  Y = −F_N cos δ,  N = x Y − y X, with F_N by

    U² = u_F² + v_F²,  U sin α = v_F cos δ − u_F sin δ,  u_F = u − r y,  v_F = γ (v + r x).

    Its parts across and along the flow are the lift, as sin α cos α, and the induced drag, as sin² α. At
    γ = 1 it takes energy from every motion through the water, since it opposes the flow across the chord.
    Beyond the stall angle α_s, sin α = ±sin α_s. u, v [m/s], r [rad/s]: of the boat through the water.
    """
    x, y = p.thruster_x[k], p.thruster_y[k]
    u_foil, v_foil = u - r * y, p.foil_gamma[k] * (v + r * x)
    cos, sin = math.cos(angle), math.sin(angle)
    speed = math.sqrt(u_foil * u_foil + v_foil * v_foil)
    most = p.foil_stall[k] * speed
    across = min(max(v_foil * cos - u_foil * sin, -most), most)
    normal = normal_force(speed, across, p.foil_area[k], p.foil_aspect_ratio[k], p)
    surge, sway = normal * sin, -normal * cos
    return surge, sway, x * sway - y * surge


@compiled
def all_foils(outputs: Any, moment: int, u: float, v: float, r: float, p: Any) -> tuple[float, float, float]:
    """Total surge, sway force [N] and yaw moment [N m] of the thrusters' foils.

    outputs[moment]: (K, JET) by `move_actuators`.
    """
    surge, sway, yaw = 0.0, 0.0, 0.0
    for k in range(outputs.shape[1]):
        if p.foil_area[k] == 0.0:
            continue
        angle = outputs[moment, k, ANGLE_OF_THRUSTER] + p.azimuth_offset[k]
        x_force, y_force, z_moment = foil_forces(angle, u, v, r, k, p)
        surge, sway, yaw = surge + x_force, sway + y_force, yaw + z_moment
    return surge, sway, yaw

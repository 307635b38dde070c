"""Published estimates of a hull's numbers from length L, breadth B, draught d [m] and block coefficient.

Sources: Lamb, *Hydrodynamics* (6th ed. 1932), articles 114 and 115; Kijima et al. (1990); Yoshimura and
Masumoto (2012), whose database ends at L/B = 2.6; Hoerner, *Fluid-Dynamic Drag* (1965), as in
Fossen (2011); Fujii and Tsuda (1961), the lift of a rudder, as in `swamp_rl.physics.rudder`.
"""

import math

import numpy as np
from scipy.special import elliprd

FIN_ASPECT = 1.5  # span over chord of a skeg, a fin or a lower unit, ours, as of the rudder
FIN_AT = -0.5  # of the length forward of midship: the stern
BLOCK = 0.5  # C_B of small craft, 0.35 to 0.65
GYRATION = 0.25  # radius of gyration in yaw over the length
# the same abeam over the distance of two hulls: SWAMP's 7.88 kg m2 of 58 kg, less 0.25 L, of 0.8 m
ATHWART = 0.25
LOWEST, FULLEST = 0.07, 0.25  # C_B B/L at the ends of the database of Yoshimura and Masumoto
SHALLOWEST_TURN = 0.27  # k beyond which Kijima's N'_r falls again: there his regression ends
# B/(2d) and C_D
HOERNER_RATIO = (
    *(0.0109, 0.1766, 0.3530, 0.4519, 0.4728, 0.4929, 0.4933, 0.5585, 0.6464, 0.8336),
    *(0.9880, 1.3081, 1.6392, 1.8600, 2.3129, 2.6000, 3.0088, 3.4508, 3.7379, 4.0031),
)
HOERNER_DRAG = (
    *(1.9661, 1.9657, 1.8976, 1.7872, 1.5837, 1.2786, 1.2108, 1.0836, 0.9986, 0.8796),
    *(0.8284, 0.7599, 0.6914, 0.6571, 0.6307, 0.5962, 0.5868, 0.5859, 0.5599, 0.5593),
)


def draught_of(mass: float, length: float, breadth: float, density: float, block: float = BLOCK) -> float:
    """d [m] = m / (ρ C_B L B): the boat floats on the water that it displaces."""
    return mass / (density * block * length * breadth)


def ellipsoid_shares(a: float, b: float, c: float) -> tuple[float, float, float]:
    """Added mass ahead, abeam over the displaced water's mass, added inertia in yaw over its inertia [1].

    a, b, c: semi-axes ahead, abeam, down (Lamb 114: k = α_0/(2 − α_0); 115 for the rotation about the third):
    α_0 = abc ∫_0^∞ dλ / ((a² + λ) Δ), Δ² = (a² + λ)(b² + λ)(c² + λ): ⅔ abc R_D(b², c², a²) by Carlson.
    """
    ahead = 2.0 / 3.0 * a * b * c * float(elliprd(b * b, c * c, a * a))
    abeam = 2.0 / 3.0 * a * b * c * float(elliprd(c * c, a * a, b * b))
    squares, difference = a * a + b * b, a * a - b * b
    below = 2.0 * difference + squares * (ahead - abeam)
    # 0 over 0 where both axes are equal: a body of revolution takes no water with it.
    turning = difference**2 * (abeam - ahead) / (squares * below) if abs(difference) > 1e-9 * squares else 0.0
    return ahead / (2.0 - ahead), abeam / (2.0 - abeam), turning


def added_masses(mass: float, length: float, breadth: float, draught: float) -> tuple[float, float, float]:
    """−X_u̇, −Y_v̇ [kg] and −N_ṙ [kg m²]: of the ellipsoid of these dimensions, whose lower half floats.

    The shares of the ellipsoid are applied to the displaced water of the boat, its mass m, and to that
    water's inertia m (a² + b²)/5.
    """
    a, b = 0.5 * length, 0.5 * breadth
    surge, sway, yaw = ellipsoid_shares(a, b, draught)
    return surge * mass, sway * mass, yaw * mass * (a * a + b * b) / 5.0


def fullness(block: float, length: float, breadth: float) -> float:
    """C_B B/L [1] within the database of the regressions, [0.07, 0.25]."""
    return min(max(block * breadth / length, LOWEST), FULLEST)


def hull_derivatives(length: float, breadth: float, draught: float, block: float) -> dict[str, float]:
    """Coefficients of `hull` [1] on ½ρLd, k = 2d/L, f = C_B B/L (`fullness`).

    Y'_v = −(½πk + 1.4 f), N'_v = −k, N'_r = −0.54 k + k² (Kijima, even keel); Y'_r − m'_x = 0.5 f and
    X'_vr + m'_y = 1.91 f − 0.08, not below 0 (Yoshimura and Masumoto). c_d: `cross_flow_drag`; the yaw rate
    counts whole in the cross flow, C_rY = C_rN = 1 (strip theory).
    """
    k, f = 2.0 * draught / length, fullness(block, length, breadth)
    turning = min(k, SHALLOWEST_TURN)
    return {
        "x_vr": max(1.91 * f - 0.08, 0.0),
        "y_v": -(0.5 * math.pi * k + 1.4 * f),
        "y_r": 0.5 * f,
        "n_v": -k,
        "n_r": -0.54 * turning + turning**2,
        "c_d": cross_flow_drag(breadth, draught),
        "c_ry": 1.0,
        "c_rn": 1.0,
    }


def fin_derivatives(area: float, length: float, draught: float) -> dict[str, float]:
    """What a fin of that lateral area [m²] at the stern adds to coefficients of `hull` [1] under way ahead.

    It meets the flow at (v + x r)/u, x = −L/2, and lifts Y = −½ρ A f (v + x r) u with Fujii's slope
    f = 6.13 Λ/(2.25 + Λ): on ½ρLd, a = f A/(Ld), Y'_v = −a, Y'_r = N'_v = a/2, N'_r = −a/4.
    """
    lift = 6.13 * FIN_ASPECT / (2.25 + FIN_ASPECT) * area / (length * draught)
    return {"y_v": -lift, "y_r": -lift * FIN_AT, "n_v": -lift * FIN_AT, "n_r": -lift * FIN_AT**2}


def cross_flow_drag(breadth: float, draught: float) -> float:
    """C_D [1] of a section against B/(2d), Hoerner's curve; constant beyond its ends."""
    return float(np.interp(breadth / (2.0 * draught), HOERNER_RATIO, HOERNER_DRAG))

"""Propeller models of Allotta et al. 2018 (003, Typhoon AUV), section III, for arrays; corrections as each
function says. The simulator is held against them.

J = V_a/(n d) is the advance coefficient, K_t = T/(ρ n² d⁴) the thrust coefficient, p/d the pitch ratio.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def disc_speed_increase(advance: ArrayLike, pitch_ratio: float) -> Array:
    """Δ_j = Δ_v/(n d): increase of the axial speed through the bladed disc (15).

    It solves the conservation of rothalpy (14) with tan α = p/(π d); (10) prints the angle as if it were its
    tangent. Δ_j, and with it the thrust, is 0 at J = p/d (17).
    """
    j = np.asarray(advance, float)
    inverse = (math.pi / pitch_ratio) ** 2  # 1/tan² α
    a, b, c = 1.0 + 0.25 * inverse, j * (2.0 + inverse), j**2 * inverse - math.pi**2
    return (-b + np.sqrt(np.maximum(b**2 - 4.0 * a * c, 0.0))) / (2.0 * a)


def disc_thrust_coefficient(advance: ArrayLike, pitch_ratio: float) -> Array:
    """K_t = π/16 (2 J Δ_j + Δ_j²) of the bladed disc without losses.

    (11) integrates this over the radius: ∫ ρ n² 4r² (2JΔ + Δ²) π r dr = π ρ n² d⁴/16 (2JΔ + Δ²). (9) prints
    d⁴ for the uniform disc, whose thrust has d².
    """
    j, increase = np.asarray(advance, float), disc_speed_increase(advance, pitch_ratio)
    return math.pi / 16.0 * (2.0 * j * increase + increase**2)


def advance_angle(revolutions: ArrayLike, inflow: ArrayLike, diameter: float) -> Array:
    """β = atan2(V_a, 0.7 π n d) [rad], −π to π: all four quadrants (20)."""
    n, v = np.asarray(revolutions, float), np.asarray(inflow, float)
    return np.arctan2(v, 0.7 * math.pi * n * diameter)


def four_quadrant_thrust(
    density: float, diameter: float, revolutions: ArrayLike, inflow: ArrayLike, coefficient: ArrayLike
) -> Array:
    """T = ρ π d²/8 (V_a² + (0.7 π n d)²) C_t* [N] (21), (26) without its cross flow; n may be 0.

    coefficient: C_t* at `advance_angle`, such as `fourier_series` gives.
    """
    n, v = np.asarray(revolutions, float), np.asarray(inflow, float)
    speed = v**2 + (0.7 * math.pi * n * diameter) ** 2
    return density * math.pi * diameter**2 / 8.0 * speed * np.asarray(coefficient, float)


def fourier_series(angle: ArrayLike, cosines: ArrayLike, sines: ArrayLike) -> Array:
    """Σ A_k cos kβ + B_k sin kβ (23); `cosines` and `sines` from k = 0 on. (23) leaves out k = 0."""
    order = np.arange(np.asarray(cosines).size)
    turned = np.multiply.outer(np.asarray(angle, float), order)
    return np.cos(turned) @ np.asarray(cosines, float) + np.sin(turned) @ np.asarray(sines, float)


def linear_four_quadrant(
    density: float,
    diameter: float,
    revolutions: ArrayLike,
    inflow: ArrayLike,
    bollard: float,
    null_advance: float,
) -> Array:
    """T = ρ d⁴ K_t(0) |n| (n − V_a/(d k_null p/d)) [N]: (19), which prints ρ d⁴ K_t(0) p/d for k_nva, for a
    propeller alike both ways, as figure 14 shows of Typhoon's tunnel thrusters.

    Ahead k_nn n² − k_nva n V_a, with k_nn = ρ d⁴ K_t(0) and k_nva = ρ d³ K_t(0)/(k_null p/d) by (18).
    """
    n, v = np.asarray(revolutions, float), np.asarray(inflow, float)
    magnitude, along = np.abs(n), np.where(n < 0.0, -v, v)
    square = density * diameter**4 * bollard
    return np.sign(n) * (square * magnitude**2 - square / (diameter * null_advance) * magnitude * along)


def crossflow_factor(across: ArrayLike, jet_speed: ArrayLike, loss: float) -> Array:
    """k_f = exp(−c_loss (V_t/V_j)²): share of the thrust that a flow across leaves (24).

    across V_t, jet_speed V_j [m/s]. The exponent of (24), c V_t²/(ρ A π), has a dimension; Beveridge's loss,
    which it is taken from, is a function of the ratio of speeds (004: 'the squared rate between' them). V_j =
    √(T/(ρ A)) by the momentum theorem.
    """
    ratio = np.asarray(across, float) / np.asarray(jet_speed, float)
    return np.exp(-loss * ratio**2)


def motor_torque(
    speed: ArrayLike, stall: float, nominal: float, nominal_speed: float, no_load_speed: float
) -> Array:
    """Torque [N m] that a brushless motor has at a speed [rad/s] ≥ 0 (29); 0 above its no-load speed.

    Q_stall − (Q_stall − Q_nom) ω/ω_nom up to ω_nom, for which (29) prints a plus, then to 0 at ω_noload.
    """
    w = np.asarray(speed, float)
    below = stall - (stall - nominal) * w / nominal_speed
    above = nominal * (no_load_speed - w) / (no_load_speed - nominal_speed)
    return np.maximum(np.where(w <= nominal_speed, below, above), 0.0)

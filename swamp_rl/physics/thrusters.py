"""Thrust of the pump-jets and how their azimuth and pump follow the commands (thesis chapter 5)."""

import math
from typing import Any

from swamp_rl.physics.compile import compiled


@compiled
def azimuth_after(angle: float, command: float, time_constant: float, rate: float, time: float) -> float:
    """Azimuth [rad] after `time` [s] of a held command: first order, with a rate limit [rad/s].

    Exact: first a ramp at the limit, then an exponential approach that starts where the first-order rate
    falls below the limit, so the result does not depend on the integration step.
    """
    error = command - angle
    distance = abs(error)
    ramp_time = max(distance / rate - time_constant, 0.0)
    if time <= ramp_time:
        return angle + math.copysign(rate * time, error)
    if time_constant <= 0.0:
        return command
    remaining = min(distance, rate * time_constant) * math.exp(-(time - ramp_time) / time_constant)
    return command - math.copysign(remaining, error)


@compiled
def throttle_after(throttle: float, command: float, time_constant: float, time: float) -> float:
    """Throttle [1] of a pump after `time` [s] of a held command, first order."""
    if time_constant <= 0.0:
        return command
    return command + (throttle - command) * math.exp(-time / time_constant)


@compiled
def bollard_thrust(throttle: float, k: int, p: Any) -> float:
    """Thrust [N] of thruster k at rest, negative astern (Table 5.5: 12.2 N at full RPM, with its square)."""
    if throttle >= 0.0:
        return (p.thrust_linear[k] + p.thrust_quadratic[k] * throttle) * throttle
    return (p.astern_linear[k] - p.astern_quadratic[k] * throttle) * throttle


@compiled
def thrust_deduction_factor(throttle: float, p: Any) -> float:
    """(1 - t) [1]: linear in the throttle between two ends, constant outside (7.3.5, figure 7.56)."""
    low, high = p.deduction_throttle_low, p.deduction_throttle_high
    share = min(max((abs(throttle) - low) / (high - low), 0.0), 1.0)
    return p.deduction_factor_low + share * (p.deduction_factor_high - p.deduction_factor_low)


@compiled
def effective_thrust(throttle: float, k: int, p: Any) -> float:
    """Thrust [N] of thruster k as it acts on the boat."""
    if throttle == 0.0:
        return 0.0
    return p.thruster_gain[k] * bollard_thrust(throttle, k, p) * thrust_deduction_factor(throttle, p)


@compiled
def jet_force(azimuth: float, throttle: float, k: int, p: Any) -> tuple[float, float]:
    """Force [N] of thruster k on the boat along body x and y (5.47)."""
    thrust = effective_thrust(throttle, k, p)
    if thrust == 0.0:
        return 0.0, 0.0
    direction = azimuth + p.azimuth_offset[k]
    return thrust * math.cos(direction), thrust * math.sin(direction)


@compiled
def thruster_forces(jets: Any, moment: int, p: Any) -> tuple[float, float, float]:
    """Total surge, sway force [N] and yaw moment [N m]; jets[moment]: (K, 2) forces along body x and y.

    N = x Y - y X for each thruster (8.24, with y to starboard).
    """
    surge, sway, yaw = 0.0, 0.0, 0.0
    for k in range(jets.shape[1]):
        x_force, y_force = jets[moment, k, 0], jets[moment, k, 1]
        surge += x_force
        sway += y_force
        yaw += p.thruster_x[k] * y_force - p.thruster_y[k] * x_force
    return surge, sway, yaw

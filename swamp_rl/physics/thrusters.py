"""Thrust of jets at rest and under way, and how azimuth and pump follow the commands (thesis chapter 5)."""

import math
from typing import Any

from swamp_rl.physics.compile import by_field, compiled
from swamp_rl.physics.force_curve import SLOWNESS, THRUST
from swamp_rl.physics.screw import SCREW, thrust_at

LOW_KNOT, MIDDLE_KNOT = 0.3, 0.6  # throttles between which, and 1, the efficiency curve is linear


@compiled
def azimuth_after(angle: float, command: float, time_constant: float, rate: float, time: float) -> float:
    """Azimuth [rad] after `time` [s] of a held command: first order, with a rate limit [rad/s].

    Exact: first a ramp at the limit, then an exponential approach that starts where the first-order rate
    falls below the limit, so the result does not depend on the integration step. An infinite rate and no
    time constant: a thruster that is fixed.

    Angles count whole turns, as SWAMP's motor does: its reference is an absolute number of steps from the
    homing position, 483,328 to a turn and up to 32 bits (thesis 5.3.3 and 6.2). From 170 degrees it turns
    back 340 degrees to -170, and on by 20 degrees to 190: the way round is the commander's choice.
    """
    if time <= 0.0:
        return angle
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
    """Throttle [1] of a pump after `time` t [s] of a held command c: c + (p_0 − c) e^(−t/T), first order."""
    if time_constant <= 0.0:
        return command
    return command + (throttle - command) * math.exp(-time / time_constant)


@compiled
def throttle_at_start(throttle: float, command: float, time_constant: float, h: float) -> float:
    """Throttle [1] that stands for the start of a step of h [s]: c + (p_0 − c) e.

    e makes the mean over the step exact, (e + 4 e^(−z/2) + e^(−z)) / 6 = (1 − e^(−z)) / z with z = h/T, for
    Runge-Kutta weighs a force of time alone by Simpson's rule. It is 1 to the order of the integration where
    the lag is long, and 0 without one: with e = 1 any lag, however short, would act for a sixth of a step.
    """
    if time_constant <= 0.0:
        return command
    z = h / time_constant
    left = -6.0 * math.expm1(-z) / z - 4.0 * math.exp(-0.5 * z) - math.exp(-z)
    return command + (throttle - command) * left


@compiled
def own_rate(k: int, p: Any) -> float:
    """Limit of the throttle's rate [1/s] of thruster k, inf for none."""
    return p.throttle_rate[k]


@compiled
def no_limit(k: int, p: Any) -> float:
    """Of a boat whose throttles have no limit of rate."""
    return math.inf


throttle_rate = by_field("throttle_rate", own_rate, no_limit)


@compiled
def level_after(throttle: float, command: float, time: float, k: int, p: Any) -> float:
    """Throttle [1], or revolutions [rps], of thruster k after `time` [s] of a held command; with a limit of
    rate by the same law as an azimuth's.
    """
    if throttle_rate(k, p) == math.inf:
        return throttle_after(throttle, command, p.pump_time_constant[k], time)
    return azimuth_after(throttle, command, p.pump_time_constant[k], throttle_rate(k, p), time)


@compiled
def level_at_start(throttle: float, command: float, h: float, k: int, p: Any) -> float:
    """The level of thruster k that stands for the start of a step of h [s]; a throttle with a limit of rate
    meets that at first.
    """
    if throttle_rate(k, p) == math.inf:
        return throttle_at_start(throttle, command, p.pump_time_constant[k], h)
    return throttle


@compiled
def beyond_dead_band(level: float, most: float, k: int, p: Any) -> float:
    """Command that thruster k makes thrust of: sign(c) max(|c| − d c_max, 0) / (1 − d).

    level c, most c_max: throttle [1] and 1 of a jet, revolutions and their limit [rps] of a propeller. The
    dead band d [1] gives no thrust; beyond it the thrust rises from zero to what it is without one at c_max.
    """
    band = p.dead_band[k]
    if band == 0.0:
        return level
    return math.copysign(max(abs(level) - band * most, 0.0) / (1.0 - band), level)


@compiled
def efficiency(share: float, k: int, p: Any) -> float:
    """Factor [1] on the thrust of thruster k at the share |c| / c_max [1] of its greatest command.

    Linear between the knots (0.3, e_30), (0.6, e_60) and (1, e_100), constant below the first.
    """
    low, middle, high = p.efficiency_30[k], p.efficiency_60[k], p.efficiency_100[k]
    if low == middle and middle == high:
        return high
    if share < MIDDLE_KNOT:
        return low + max((share - LOW_KNOT) / (MIDDLE_KNOT - LOW_KNOT), 0.0) * (middle - low)
    return middle + min((share - MIDDLE_KNOT) / (1.0 - MIDDLE_KNOT), 1.0) * (high - middle)


@compiled
def curve_thrust(throttle: float, k: int, p: Any) -> float:
    """Thrust [N] of thruster k at rest, negative astern: T = (a + b p) p ahead, (a' − b' p) p astern.

    Table 5.5: a = 0, b = 12.2 N.
    """
    if throttle >= 0.0:
        return (p.thrust_linear[k] + p.thrust_quadratic[k] * throttle) * throttle
    return (p.astern_linear[k] - p.astern_quadratic[k] * throttle) * throttle


@compiled
def thrust_of_either(throttle: float, k: int, p: Any) -> float:
    """As `bollard_thrust`, for a boat with a propeller or a table of `swamp_rl.physics.screw`."""
    if p.screw_model[k] > 0.0:
        return thrust_at(throttle, 0.0, k, p)
    return curve_thrust(throttle, k, p)


# Thrust [N] of thruster k at rest at a throttle [1], negative astern.
bollard_thrust = by_field(SCREW, thrust_of_either, curve_thrust)


@compiled
def thrust_deduction_factor(throttle: float, p: Any) -> float:
    """(1 − t) [1] of throttle p: f_0 + s (f_1 − f_0), s = (|p| − p_0)/(p_1 − p_0) within [0, 1] (7.3.5)."""
    low, high = p.deduction_throttle_low, p.deduction_throttle_high
    share = min(max((abs(throttle) - low) / (high - low), 0.0), 1.0)
    return p.deduction_factor_low + share * (p.deduction_factor_high - p.deduction_factor_low)


@compiled
def thrust_share(throttle: float, k: int, p: Any) -> float:
    """scale · gain_k · e_k(p) · (1 − t)(p) [1] of thruster k at the throttle p beyond its dead band."""
    gain = p.thrust_scale * p.thruster_gain[k] * efficiency(abs(throttle), k, p)
    return gain * thrust_deduction_factor(throttle, p)


@compiled(entry=True)
def effective_thrust(throttle: float, k: int, p: Any) -> float:
    """Thrust [N] of thruster k on a boat at rest: T = scale · gain_k · e_k(p) · T_bollard(p) · (1 − t)(p).

    p: the throttle beyond the dead band.
    """
    throttle = beyond_dead_band(throttle, 1.0, k, p)
    if throttle == 0.0:
        return 0.0
    gain = p.thrust_scale * p.thruster_gain[k] * efficiency(abs(throttle), k, p)
    return gain * bollard_thrust(throttle, k, p) * thrust_deduction_factor(throttle, p)


@compiled
def jet_force(azimuth: float, throttle: float, k: int, p: Any) -> tuple[float, float]:
    """Force [N] of thruster k on the boat: X = T cos(α + α_0), Y = T sin(α + α_0) (5.47)."""
    thrust = effective_thrust(throttle, k, p)
    if thrust == 0.0:
        return 0.0, 0.0
    direction = azimuth + p.azimuth_offset[k]
    return thrust * math.cos(direction), thrust * math.sin(direction)


@compiled
def supply(time: float, p: Any) -> float:
    """Share of its thrust [1] that the boat's battery still gives after `time` t [s]: max(1 − s t, 0)."""
    return max(1.0 - p.thrust_sag * time, 0.0)


@compiled
def alive(k: int, time: float, h: float, p: Any) -> float:
    """Share of the h [s] from `time` that thruster k works, 1 before it fails and 0 after.

    A share, so that the track does not jump when the failure moves from one integration step to the next.
    """
    if p.failure_time[k] >= time + h:
        return 1.0
    return max((p.failure_time[k] - time) / h, 0.0)


@compiled(entry=True)
def put_output(first: float, second: float, jets: Any, moment: int, k: int, p: Any) -> None:
    """Put an output of `actuator_output` into jets[moment, k], with what `loss_under_way` needs of a jet's
    force T alone: T [N] and 1/V_o = √(ρ A_n / T) [s/m].
    """
    jets[moment, k, 0], jets[moment, k, 1] = first, second
    if p.advance_loss[k] == 0.0 and p.crossflow_loss == 0.0:
        return
    jets[moment, k, THRUST] = thrust = math.sqrt(first * first + second * second)
    jets[moment, k, SLOWNESS] = slowness_of(thrust, k, p)


@compiled
def slowness_of(thrust: float, k: int, p: Any) -> float:
    """1/V_o = √(ρ A_n / T) [s/m] of the jet of thruster k at the thrust T [N]."""
    return math.sqrt(p.water_density * p.nozzle_area[k] / thrust) if thrust > 0.0 else 0.0


@compiled
def loss_under_way(jets: Any, moment: int, u: float, v: float, r: float, k: int, p: Any) -> float:
    """As `loss_in_flow`, of a force in jets[moment]: (K, JET) by `put_output`."""
    if p.advance_loss[k] == 0.0 and p.crossflow_loss == 0.0:
        return 1.0
    thrust, slowness = jets[moment, k, THRUST], jets[moment, k, SLOWNESS]
    return loss_in_flow(jets[moment, k, 0], jets[moment, k, 1], thrust, slowness, u, v, r, k, p)


@compiled
def loss_in_flow(
    x_force: float,
    y_force: float,
    thrust: float,
    slowness: float,
    u: float,
    v: float,
    r: float,
    k: int,
    p: Any,
) -> float:
    """What is left [1] of the force T of thruster k in water that passes it at u, v [m/s] and r [rad/s].

    (1 − c_a V_a/V_o) exp(−c_t (V_t/V_o)²), V_o = √(T / (ρ A_n)): the jet gains less momentum the faster the
    water already runs along it (thesis eq. 5.2), and the flow across it takes its share (Typhoon AUV, eq. 24,
    on the ratio of speeds as the energy paper has it). V_a, V_t [m/s]: the thruster's own speed through the
    water along and across the jet. No loss at rest; it neither turns round nor is drawn backwards.
    thrust: T [N]; slowness: 1/V_o [s/m].
    """
    if thrust == 0.0:
        return 0.0
    u_there, v_there = u - r * p.thruster_y[k], v + r * p.thruster_x[k]
    along = (u_there * x_force + v_there * y_force) / thrust
    across = (v_there * x_force - u_there * y_force) / thrust
    advance = max(1.0 - p.advance_loss[k] * along * slowness, 0.0)
    if p.crossflow_loss == 0.0:
        return advance
    ratio = across * slowness
    return advance * math.exp(-p.crossflow_loss * ratio * ratio)


@compiled
def jet_forces(jets: Any, moment: int, u: float, v: float, r: float, p: Any) -> tuple[float, float, float]:
    """Total surge, sway force [N] and yaw moment [N m] at u, v [m/s], r [rad/s] through the water.

    jets[moment]: (K, JET) by `put_output`, forces along body x and y first; N = x Y - y X for each (8.24,
    with y to starboard).
    """
    surge, sway, yaw = 0.0, 0.0, 0.0
    for k in range(jets.shape[1]):
        left = loss_under_way(jets, moment, u, v, r, k, p)
        x_force, y_force = left * jets[moment, k, 0], left * jets[moment, k, 1]
        surge += x_force
        sway += y_force
        yaw += p.thruster_x[k] * y_force - p.thruster_y[k] * x_force
    return surge, sway, yaw

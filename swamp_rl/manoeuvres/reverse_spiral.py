"""Reverse spiral (Bech): the angle that holds each yaw rate; it shows the whole loop of an unstable boat."""

import math

from swamp_rl.guidance.heading import slowest_speed
from swamp_rl.guidance.loop import Seen
from swamp_rl.manoeuvres.controller import DONE, Controller, Order, Phase, Trial, patience
from swamp_rl.manoeuvres.settling import Settling, started, watched
from swamp_rl.manoeuvres.spiral import HOLD, SHARE, SLOW, spiral_angles, steady_turn

LARGEST, HOLDING = "largest", "hold"
STIFFNESS, SAILED = 2.0, 3.0  # angle per yaw rate in rad per length; lengths over which the integral forms
TOLERANCE = 0.005  # rad of the steering angle
BEYOND = 1.5  # times the trial's angle: how far the control may steer


def reverse_spiral(trial: Trial, length: float, limit: float) -> Controller:
    """Holds shares of the yaw rate that the trial's angle gives, from one side to the other and back.

    First the angle itself is held until that yaw rate is known. Then a proportional and integral control of
    the yaw rate steers, within `limit` [rad]; a step is over when the angle that it needs is steady. length
    of the boat [m].
    """
    shares = spiral_angles(1.0)
    longest = SHARE * patience(length)
    bound = min(BEYOND * abs(trial.angle), limit)

    def control(sensed: Seen, phase: Phase) -> tuple[Order, Phase]:
        if phase.name not in (LARGEST, HOLDING):
            phase = phase.then(LARGEST, sensed.time, memory=started(sensed.time, sensed.yaw_rate))
        if phase.name == LARGEST:
            phase, settled = steady_turn(sensed, phase, length)
            if not settled and sensed.time - phase.began <= longest:
                return Order(trial.angle, trial.throttle), phase
            if not settled:
                phase = phase.noted(f"the yaw rate at the angle itself was not steady after {longest:.0f} s")
            memory = (*started(sensed.time, trial.angle), sensed.yaw_rate, trial.angle)
            phase = phase.then(HOLDING, sensed.time, number=1, memory=memory)
        wanted = phase.memory[3] * shares[phase.number - 1]
        angle, phase, over = _held(sensed, phase, wanted, bound, length)
        if over or sensed.time - phase.began > longest:
            if not over:
                at = f"{math.degrees(wanted):+.1f} deg/s"
                phase = phase.noted_also(f"the angle was not steady after {longest:.0f} s", at)
            phase = _next(sensed, phase, angle, len(shares))
        return Order(angle, trial.throttle), phase

    return control


def _held(
    sensed: Seen, phase: Phase, wanted: float, bound: float, length: float
) -> tuple[float, Phase, bool]:
    """Angle [rad] that holds the yaw rate `wanted` [rad/s], the phase, and whether that angle is steady.

    memory: the watched angle, the largest yaw rate, the integral's angle, which stays within `bound` [rad].
    """
    sailed = length / max(math.hypot(sensed.surge, sensed.sway), slowest_speed(length))
    time, average, since, largest, integral = phase.memory
    error = (wanted - sensed.yaw_rate) * sailed
    integral += STIFFNESS * error * (sensed.time - time) / (SAILED * sailed)
    integral = min(max(integral, -bound), bound)
    angle = min(max(integral + STIFFNESS * error, -bound), bound)
    seen = watched(Settling(time, average, since), sensed.time, angle, SLOW * sailed, TOLERANCE)
    phase = phase._replace(memory=(*seen, largest, integral))
    return angle, phase, sensed.time - seen.since >= HOLD * sailed


def _next(sensed: Seen, phase: Phase, angle: float, steps: int) -> Phase:
    if phase.number == steps:
        return phase.then(DONE, sensed.time, number=steps)
    memory = (*started(sensed.time, angle), *phase.memory[3:])
    return phase.then(HOLDING, sensed.time, phase.number + 1, memory)

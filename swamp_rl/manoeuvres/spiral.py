"""Direct spiral (Dieudonné): steady yaw rates at angles from one side to the other and back."""

import math

from swamp_rl.guidance.heading import slowest_speed
from swamp_rl.guidance.loop import Seen
from swamp_rl.manoeuvres.controller import DONE, Controller, Order, Phase, Trial, patience
from swamp_rl.manoeuvres.settling import Settling, started, watched

STEP = "step"
STEPS = 5  # from amidships to the largest angle
SLOW, HOLD = 5.0, 8.0  # lengths sailed that are averaged, and that the yaw rate must stay near that average
TOLERANCE = 0.003  # rad per length sailed
SHARE = 0.5  # of the patience, for one step


def spiral_angles(angle: float) -> list[float]:
    """The trial's angles [rad]: from `angle` to its opposite and back, amidships passed twice."""
    down = [angle * (STEPS - i) / STEPS for i in range(2 * STEPS + 1)]
    return down + down[-2::-1]


def spiral(trial: Trial, length: float) -> Controller:
    """Steps of the steering angle, each held until the yaw rate is steady; length of the boat [m]."""
    angles = spiral_angles(trial.angle)
    longest = SHARE * patience(length)

    def control(sensed: Seen, phase: Phase) -> tuple[Order, Phase]:
        if phase.name != STEP:
            phase = phase.then(STEP, sensed.time, number=1, memory=started(sensed.time, sensed.yaw_rate))
        phase, settled = steady_turn(sensed, phase, length)
        if settled or sensed.time - phase.began > longest:
            if not settled:
                at = f"{math.degrees(angles[phase.number - 1]):+.1f} deg"
                phase = phase.noted_also(f"the yaw rate was not steady after {longest:.0f} s", at)
            if phase.number == len(angles):
                phase = phase.then(DONE, sensed.time, number=phase.number)
            else:
                phase = phase.then(STEP, sensed.time, phase.number + 1, started(sensed.time, sensed.yaw_rate))
        return Order(angles[phase.number - 1], trial.throttle), phase

    return control


def steady_turn(sensed: Seen, phase: Phase, length: float) -> tuple[Phase, bool]:
    """The phase with its memory of the yaw rate brought up to date, and whether that rate is steady."""
    pace = max(math.hypot(sensed.surge, sensed.sway), slowest_speed(length))
    sailed = length / pace
    seen = watched(
        Settling(*phase.memory[:3]), sensed.time, sensed.yaw_rate, SLOW * sailed, TOLERANCE / sailed
    )
    phase = phase._replace(memory=(*seen, *phase.memory[3:]))
    return phase, sensed.time - seen.since >= HOLD * sailed

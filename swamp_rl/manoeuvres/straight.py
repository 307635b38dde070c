"""Straight runs ahead or astern at one throttle: the self-propulsion test (thesis 7.3.5)."""

import math

from swamp_rl.guidance.heading import Limits, slowest_speed, steering_angle
from swamp_rl.guidance.loop import Seen
from swamp_rl.manoeuvres.approach import HOLD, SLOW, STEADY
from swamp_rl.manoeuvres.controller import DONE, Controller, Order, Phase, Trial, patience
from swamp_rl.manoeuvres.settling import Settling, started, watched

SPEEDING, MEASURED = "speeding", "measured"


def straight(trial: Trial, length: float, limits: Limits) -> Controller:
    """The heading is held, within the limits of steering, until the speed is steady and then measured.

    What is measured lasts for the trial's duration; length of the boat [m].
    """
    longest = patience(length)

    def control(sensed: Seen, phase: Phase) -> tuple[Order, Phase]:
        speed = math.hypot(sensed.surge, sensed.sway)
        pace = max(speed, slowest_speed(length))
        angle = steering_angle(phase.heading, sensed.heading, sensed.yaw_rate, speed, length, limits)
        if phase.name not in (SPEEDING, MEASURED):
            phase = phase.then(SPEEDING, sensed.time, memory=started(sensed.time, sensed.surge))
        if phase.name == SPEEDING:
            before = Settling(*phase.memory)
            seen = watched(before, sensed.time, sensed.surge, SLOW * length / pace, STEADY * pace)
            phase = phase._replace(memory=seen)
            settled = sensed.time - seen.since >= HOLD * length / pace and (sensed.surge < 0) == trial.astern
            if settled or sensed.time - phase.began > longest:
                if not settled:
                    phase = phase.noted(f"the speed was not steady after {longest:.0f} s")
                phase = phase.then(MEASURED, sensed.time)
        elif sensed.time - phase.began >= trial.duration:
            phase = phase.then(DONE, sensed.time)
        return Order(angle, trial.throttle, trial.astern), phase

    return control

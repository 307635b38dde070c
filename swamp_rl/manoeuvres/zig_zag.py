"""Zig-zag and modified zig-zag: the angle is reversed whenever the heading has gone far enough (002, 3.2)."""

import math

from swamp_rl.guidance.loop import Seen
from swamp_rl.manoeuvres.controller import DONE, Controller, Order, Phase, Trial, gave_up, patience

STEERING = "execute"


def zig_zag(trial: Trial, length: float) -> Controller:
    """Executes of the trial's angle at its heading, the first at the start; length of the boat [m].

    The trial ends when the heading has answered the last execute.
    """
    longest = patience(length)

    def control(sensed: Seen, phase: Phase) -> tuple[Order, Phase]:
        if phase.number == 0:
            phase = phase.then(STEERING, sensed.time, number=1)
        angle = trial.angle if phase.number % 2 else -trial.angle
        deviation = math.copysign(1.0, angle) * (sensed.heading - phase.heading)
        if deviation >= trial.heading:
            if phase.number == trial.executes:
                return Order(angle, trial.throttle), phase.then(DONE, sensed.time, number=phase.number)
            phase, angle = phase.then(STEERING, sensed.time, number=phase.number + 1), -angle
        elif sensed.time - phase.began > longest:
            note = (
                f"execute {phase.number} of {trial.executes} brought the heading to "
                f"{math.degrees(deviation):.1f} of {math.degrees(trial.heading):g} deg in {longest:.0f} s"
            )
            phase = gave_up(phase, sensed.time, note)
        return Order(angle, trial.throttle), phase

    return control

"""Turning circle: the angle held for so many full turns, then amidships for the pull-out (002, 3.1)."""

import math

from swamp_rl.guidance.loop import Seen
from swamp_rl.manoeuvres.controller import DONE, Controller, Order, Phase, Trial, gave_up, patience

TURNING, PULL_OUT = "turning", "pull-out"


def turning_circle(trial: Trial, length: float) -> Controller:
    """Turns of the trial's angle, counted as they are completed; length of the boat [m]."""
    longest = patience(length)

    def control(sensed: Seen, phase: Phase) -> tuple[Order, Phase]:
        if phase.name not in (TURNING, PULL_OUT):
            phase = phase.then(TURNING, sensed.time, number=1)
        if phase.name == TURNING:
            turned = abs(sensed.heading - phase.heading) / (2.0 * math.pi)
            if turned >= trial.turns:
                phase = phase.then(PULL_OUT, sensed.time)
            elif turned >= phase.number:
                phase = phase.then(TURNING, sensed.time, number=phase.number + 1)
            elif sensed.time - phase.began > longest:
                note = f"turn {phase.number} of {trial.turns} was not completed in {longest:.0f} s"
                phase = gave_up(phase, sensed.time, note)
        elif sensed.time - phase.began >= trial.duration:
            phase = phase.then(DONE, sensed.time)
        return Order(trial.angle if phase.name == TURNING else 0.0, trial.throttle), phase

    return control

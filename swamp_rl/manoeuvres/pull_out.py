"""Pull-out: from a steady turn to either side the steering goes amidships; the yaw rate tells the rest."""

from swamp_rl.guidance.loop import Seen
from swamp_rl.manoeuvres.controller import DONE, Controller, Order, Phase, Trial, patience
from swamp_rl.manoeuvres.settling import started
from swamp_rl.manoeuvres.spiral import SHARE, steady_turn

TURNING, PULL_OUT = "turning", "pull-out"


def pull_out(trial: Trial, length: float) -> Controller:
    """A steady turn and its pull-out for the trial's duration, then the same to the other side."""
    longest = SHARE * patience(length)

    def control(sensed: Seen, phase: Phase) -> tuple[Order, Phase]:
        if phase.name not in (TURNING, PULL_OUT):
            phase = phase.then(TURNING, sensed.time, 1, started(sensed.time, sensed.yaw_rate))
        if phase.name == TURNING:
            phase, settled = steady_turn(sensed, phase, length)
            if settled or sensed.time - phase.began > longest:
                if not settled:
                    phase = phase.noted(f"turn {phase.number} was not steady after {longest:.0f} s")
                phase = phase.then(PULL_OUT, sensed.time, phase.number)
        elif sensed.time - phase.began >= trial.duration:
            if phase.number == 2:
                return Order(0.0, trial.throttle), phase.then(DONE, sensed.time, 2)
            phase = phase.then(TURNING, sensed.time, 2, started(sensed.time, sensed.yaw_rate))
        angle = 0.0 if phase.name == PULL_OUT else trial.angle if phase.number == 1 else -trial.angle
        return Order(angle, trial.throttle), phase

    return control

"""Stopping: from steady running all thrusters push astern until the boat has no way on."""

from swamp_rl.guidance.loop import Seen
from swamp_rl.manoeuvres.controller import DONE, Controller, Order, Phase, Trial, gave_up, patience

ASTERN = "astern"


def stopping(trial: Trial, length: float) -> Controller:
    """Full astern, steering amidships, until the surge over ground is zero; length of the boat [m]."""
    longest = patience(length)

    def control(sensed: Seen, phase: Phase) -> tuple[Order, Phase]:
        if phase.name != ASTERN:
            phase = phase.then(ASTERN, sensed.time)
        if sensed.surge <= 0.0:
            phase = phase.then(DONE, sensed.time)
        elif sensed.time - phase.began > longest:
            note = f"after {longest:.0f} s astern the boat still made {sensed.surge:.2f} m/s ahead"
            phase = gave_up(phase, sensed.time, note)
        return Order(0.0, trial.astern_throttle, astern=True), phase

    return control

"""Whether the levers of logged runs follow the observations as late as a pilot's `reaction` says."""

from collections.abc import Sequence

import numpy as np
from swamp_rl.envs.hindsight import with_gates
from swamp_rl.experiments.config.scene import Scene
from swamp_rl.experiments.config.schema import PilotPlan

from swamp_rl.pilots.demonstrations import LAST, examples
from swamp_rl.runs import Run

CLEARLY_MORE = 1.25
"Ratio of the unexplained shares of the levers, from which the reaction is too long."


def reaction_warning(scene: Scene, name: str, plan: PilotPlan, runs: Sequence[Run]) -> str | None:
    """One line where the levers of the runs that the pilot of that name learns from follow clearly earlier
    than its `reaction`, so that it would learn to act too early; else None.

    The levers' delay is the shift at which a linear function of the observations explains most of them. The
    last action is not among these: it explains the next one best without a delay, whoever drives.
    """
    reaction = plan.options.get("reaction", 0.0)
    senses = [sense for sense in plan.options.get("senses", ()) if sense not in LAST]
    if reaction == 0.0 or not senses:
        return None
    seen = [with_gates(run, scene.course) for run in runs]
    step = scene.experiment.step
    shifts = [*np.arange(0.0, reaction, step), reaction]
    left = [_unexplained(seen, senses, shift) for shift in shifts]
    best = int(np.argmin(left))
    if left[-1] <= CLEARLY_MORE * left[best]:
        return None
    advice = f"{shifts[best]:.2g}, or to 0 for a driver that is no person" if best else "0"
    return (
        f"pilots.{name}: the levers follow what the driver saw by about {shifts[best]:.2g} s, not by the "
        f"reaction of {reaction:g} s (a linear fit leaves {left[best]:.0%} and {left[-1]:.0%} of them); if "
        f"it acts too early, set reaction to {advice}"
    )


def _unexplained(runs: Sequence[Run], senses: Sequence[str], reaction: float) -> float:
    """Share of the levers' variance that a linear function of the observations leaves."""
    seen, levers, shown = (np.concatenate(parts) for parts in examples(runs, senses, reaction))
    seen, levers = seen[shown], levers[shown] - levers[shown].mean(axis=0)
    given = np.column_stack([np.ones(len(seen)), seen])
    fitted = given @ np.linalg.lstsq(given, levers, rcond=None)[0]
    return float(((levers - fitted) ** 2).sum() / max((levers**2).sum(), 1e-12))

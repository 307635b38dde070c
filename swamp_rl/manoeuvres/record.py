"""Trials as they went, written as a dataset of runs, so that simulated and measured ones are read alike."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.guidance.flight import command_columns
from swamp_rl.manoeuvres.approach import Area
from swamp_rl.manoeuvres.controller import APPROACH, Trial
from swamp_rl.manoeuvres.execute import STEP, Executed, execute
from swamp_rl.runs import Run, RunMeta, append_runs, dataset_beside
from swamp_rl.runs.schema import meta_of
from swamp_rl.simulator.replay import run_of
from swamp_rl.simulator.sensors import CHANNELS

NOTES = "Trials executed by swamp_rl in closed loop on its own simulator; no measured data."


def trial_name(number: int, trial: Trial) -> str:
    """A name for the run of a trial: what it is, its angle to (s)tarboard or (p)ort, its throttle."""
    parts = [f"{number:02d}", trial.kind]
    if trial.angle != 0.0:
        parts.append(f"{'s' if trial.angle > 0 else 'p'}{abs(math.degrees(trial.angle)):g}")
    if trial.kind == "zig-zag" and abs(trial.heading - abs(trial.angle)) > 1e-9:
        parts.append(f"at{math.degrees(trial.heading):g}")
    if trial.astern:
        parts.append("astern")
    if trial.pattern != "opposed":
        parts.append(trial.pattern)
    return "-".join([*parts, f"{100 * trial.throttle:.4g}pc"])


def run_of_trial(executed: Executed, boat: Boat, name: str, seed: int) -> Run:
    """The run of an executed trial; its meta holds the trial asked for, the marks and what went amiss."""
    time = np.arange(len(executed.track), dtype=np.float64) * STEP
    columns = {"time": time} | command_columns(boat, executed.commands)
    first = dict(zip(CHANNELS, executed.measured[0].tolist(), strict=True))
    meta = RunMeta.model_validate(
        {
            "seed": seed,
            "initial_state": first,
            "outcome": "success" if executed.completed else "incomplete",
            "manoeuvre": {name: value for name, value in asdict(executed.trial).items() if value is not None},
            "marks": [asdict(mark) for mark in executed.marks if mark.phase != APPROACH],
            "notes": list(executed.notes),
        }
    )
    run = run_of(executed.track, executed.measured, time, Run(name, columns), boat)
    return Run(name, run.columns, meta)


def runs_of_trials(executed: Sequence[Executed], boat: Boat, seed: int) -> list[Run]:
    """The runs of trials that were executed with that seed, named by their number."""
    return [
        run_of_trial(one, boat, trial_name(number + 1, one.trial), seed + number)
        for number, one in enumerate(executed)
    ]


def record_trials(
    out: Path | str,
    boat: Boat,
    vehicle: str,
    trials: Sequence[Trial],
    area: Area | None = None,
    seed: int = 0,
) -> list[Executed]:
    """Execute the trials with a boat, read from the name or file `vehicle`, and write them as the dataset
    `out`.

    UserError where the boat cannot do a trial, or the folder holds something else.
    """
    meta = meta_of(boat, vehicle, 1.0 / STEP, "simulated", notes=NOTES)
    with dataset_beside(out, meta) as part:
        executed = execute(boat, trials, area, seed)
        append_runs(part, runs_of_trials(executed, boat, seed))
    return executed

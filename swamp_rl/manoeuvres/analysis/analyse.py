"""From runs to results: each manoeuvre by its own analysis, and what two runs tell together."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from swamp_rl.boat import Boat, load_boat
from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.analysis.circle import analyse_circle
from swamp_rl.manoeuvres.analysis.figure import Result
from swamp_rl.manoeuvres.analysis.imo import criteria
from swamp_rl.manoeuvres.analysis.motion import Motion, motion_of
from swamp_rl.manoeuvres.analysis.recognise import Recognised, listed, recognised
from swamp_rl.manoeuvres.analysis.speed import analyse_stopping, analyse_straight
from swamp_rl.manoeuvres.analysis.stability import (
    analyse_pull_out,
    analyse_reverse_spiral,
    analyse_spiral,
)
from swamp_rl.manoeuvres.analysis.zig_zag import analyse_zig_zag
from swamp_rl.runs import Dataset, Run, read_dataset

Analysis = Callable[[Motion, Recognised, Result, np.random.Generator], None]

ANALYSES: dict[str, tuple[Analysis, str]] = {  # with the phase that a run must hold
    "turning-circle": (analyse_circle, "turning"),
    "zig-zag": (analyse_zig_zag, "execute"),
    "spiral": (analyse_spiral, "step"),
    "reverse-spiral": (analyse_reverse_spiral, "hold"),
    "pull-out": (analyse_pull_out, "pull-out"),
    "stopping": (analyse_stopping, "astern"),
    "straight": (analyse_straight, "measured"),
}


def analyse_run(run: Run, boat: Boat, seed: int = 0) -> Result:
    """The figures of one run of `boat`; seed: of the bootstrap. UserError where no manoeuvre is found."""
    motion = motion_of(run, boat)
    found = recognised(run.meta, motion, run.name)
    notes = [str(note) for note in listed(run.meta, "notes", run.name)]
    result = Result(run.name, found.kind, dict(found.setting), notes=notes)
    if found.others:
        result.notes.append(
            f"the run holds {found.others + 1} turning circles, and the figures are those of the one that "
            "turns most; make a run of each manoeuvre, by runs import --map keep=..."
        )
    analysis, phase = ANALYSES[found.kind]
    rng = np.random.default_rng(seed)
    if not found.of(phase):
        there = ", ".join(dict.fromkeys(repr(clipped(mark.phase)) for mark in found.marks))
        result.notes.append(f"no phase {phase!r} among its marks, which have {there}: no figures")
        return result
    analysis(motion, found, result, rng)
    if found.kind == "turning-circle" and found.of("pull-out"):
        analyse_pull_out(motion, found, result, rng)
    throttle = motion.throttle[motion.row(found.of(phase)[0].time)]
    if np.isfinite(throttle):
        result.setting.setdefault("throttle", float(throttle))
    result.criteria = criteria(result, boat.length)
    return result


def analyse_runs(runs: Sequence[Run], boat: Boat) -> tuple[list[Result], list[str]]:
    """The results of the runs that hold a manoeuvre, and one line for each that does not."""
    results, refused = [], []
    for run in runs:
        try:
            results.append(analyse_run(run, boat))
        except UserError as error:
            refused.append(str(error))
    return results, refused


def analyse_dataset(
    folder: Path | str, boat: str | None = None
) -> tuple[Dataset, Boat, list[Result], list[str]]:
    """A dataset with its boat, results and refusals; UserError where no run of it can be analysed.

    boat: another one than its own, or whose runs a plain folder holds.
    """
    dataset = read_dataset(folder, boat)
    vessel = dataset.boat if boat is None or boat == dataset.named_boat else load_boat(boat)
    results, refused = analyse_runs(dataset.runs, vessel)
    if not results:
        raise UserError(f"{folder}: {refused[0]}")
    return dataset, vessel, results, refused

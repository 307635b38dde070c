"""Faults of successful runs that a pilot would learn: gates that were missed, levers of other commands."""

from collections.abc import Sequence

import numpy as np
from swamp_rl.envs.aboard import Measured
from swamp_rl.envs.hindsight import with_gates
from swamp_rl.experiments.config.scene import Scene

from swamp_rl.counted import counted
from swamp_rl.runs import Dataset, Run

APART = 0.1
"Difference of two commands, as a share of what the levers reach, from which they are not the same."
MOST_APART = 0.15
"Share of the rows above which the levers of a run are not those of its commands."
ENDS = [(throttle, angle) for throttle in (0.0, 1.0) for angle in (-1.0, 1.0)]
"Levers at the ends of their ways."
NAMED = 3
"Runs that a line names."


def run_faults(scene: Scene, dataset: Dataset) -> list[str]:
    """One line for each fault of the successful runs, with their number and names.

    They do not pass every gate of the experiment's course, their levers never move, or the thrusters'
    commands are not those that the boat makes of the levers.
    """
    good = [run for run in dataset.successful if {"joy_thrust", "joy_angle"} <= run.columns.keys()]
    still = [run for run in good if not run.joypad.any()]
    measured = Measured(boat=scene.boat, course=scene.course)
    found = (
        (
            [run for run in good if not _passes_all(scene, run)],
            f"do not pass every gate of {scene.course.name}; correct their outcome, or set course to theirs",
        ),
        (still, "have levers that never move; record joy_thrust and joy_angle"),
        (
            [run for run in good if run.joypad.any() and _share_apart(measured, run) > MOST_APART],
            f"have commands that boat {scene.boat.name} does not make of their levers; check the sign, range "
            "and time of joy_thrust and joy_angle",
        ),
    )
    return [f"{dataset.folder}: {_of(runs, good)} {message}" for runs, message in found if runs]


def _of(runs: Sequence[Run], among: Sequence[Run]) -> str:
    names = ", ".join(run.name for run in runs[:NAMED]) + (", ..." if len(runs) > NAMED else "")
    return f"{len(runs)} of {counted(len(among), 'successful run')} ({names})"


def _passes_all(scene: Scene, run: Run) -> bool:
    return with_gates(run, scene.course).columns["gates_passed"][-1] == len(scene.course.gates)


def _share_apart(measured: Measured, run: Run) -> float:
    """Share of the rows in which a command differs from that of the levers; 0 for a run without commands."""
    thrusters = measured.boat.thrusters
    driven = [k for k, one in enumerate(thrusters) if one.name in measured.boat.joypad.thrusters]
    pairs = [zip(thrusters[k].command_columns, (k, len(thrusters) + k), strict=True) for k in driven]
    places = {name: place for pair in pairs for name, place in pair if name is not None}
    if not places.keys() <= run.columns.keys():
        return 0.0
    wanted, ends = (
        np.array([measured.commands(levers) for levers in asked])[:, list(places.values())]
        for asked in (run.joypad, ENDS)
    )
    apart = np.abs(run.stacked(places) - wanted)
    return float(np.mean((apart > APART * np.ptp(ends, axis=0)).any(axis=1)))

"""All checks of a dataset, in the order in which one rests on another."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.clipped import clipped
from swamp_rl.doctor.commands import command_findings, other_boat_findings, small_findings
from swamp_rl.doctor.filtered import filter_findings
from swamp_rl.doctor.finding import Finding
from swamp_rl.doctor.finite import finite_runs
from swamp_rl.doctor.heading_seam import seam_findings
from swamp_rl.doctor.jumps import jump_findings
from swamp_rl.doctor.kinematics import kinematic_findings
from swamp_rl.doctor.ranges import range_findings
from swamp_rl.doctor.response import response_findings
from swamp_rl.doctor.smooth import Motion, motion_of
from swamp_rl.doctor.stuck import stuck_findings
from swamp_rl.doctor.times import JUMP, time_findings
from swamp_rl.doctor.unpowered import unpowered_findings
from swamp_rl.runs import Run
from swamp_rl.runs.columns import REQUIRED
from swamp_rl.runs.same_run import same_runs

LONGEST_ROW = 0.25
"""Lengths that the boat passes from row to row: the motion's corner, speed / (2 pi length), then lies at
a fifth of the band in which `filtered` looks for noise."""
SHORTEST_STEP = 1e-6
"""s: of the rows of a log; a window of any length then has a count of rows."""
FRAMES = {"axes_exchanged", "heading_enu"}
"""The two explanations of positions that are a mirror image of the heading."""
MIRRORED = {"commands_exchanged", "angles_flipped"}
"""Answers of a boat whose motion is seen in a mirror."""


def examine(runs: Sequence[Run], boat: Boat | None = None, measured: bool = True) -> list[Finding]:
    """What is odd about runs, faults first.

    boat: whose thrusters the commands are of; without it sides are taken from the names of columns. measured:
    whether channels without noise are odd. Runs are divided where their positions jump and where the heading
    was interpolated across its seam. A column that another check has shown to be in another unit is brought
    into ours, in memory, before those that rest on it.
    """
    found = missing_findings(runs) + (twice_findings(runs) if measured else [])
    without, runs = finite_runs(runs)
    found += without + time_findings(runs)
    jumps, runs = jump_findings(runs)
    found += jumps
    ranges, runs = range_findings(runs)
    seams, runs = seam_findings(runs)
    found += ranges + seams + stuck_findings(runs, measured) + command_findings(runs)
    found += [] if boat is None else other_boat_findings(runs, boat) + small_findings(runs, boat)
    even = [run for run in runs if _even(run)]
    moved = [(run, motion_of(run)) for run in even]
    resolved = [run for run, motion in moved if _whole(run) and _is_resolved(motion, boat)]
    found += filter_findings(resolved, measured)
    motions = [motion for _, motion in moved if motion is not None]
    found += _motion_findings(motions, boat)
    return sorted(found, key=lambda finding: finding.level != "fault")


def _motion_findings(motions: Sequence[Motion], boat: Boat | None) -> list[Finding]:
    """Of the kinematics and of the response to the commands. Exchanged axes and a heading of another frame
    have the same kinematics: the one is chosen for which the response is not that of a mirror image.
    """
    kinematic, corrected = kinematic_findings(motions)
    response = response_findings(corrected, boat)
    first = next((one.code for one in kinematic if one.code in FRAMES), None)
    if first and MIRRORED & {one.code for one in response}:
        other, instead = kinematic_findings(motions, exchanged=first != "axes_exchanged")
        answer = response_findings(instead, boat)
        if not MIRRORED & {one.code for one in answer}:
            kinematic, corrected, response = other, instead, answer
    return [*kinematic, *response, *unpowered_findings(motions)]


def missing_findings(runs: Sequence[Run]) -> list[Finding]:
    """Columns of the pose that no run has: without them there is nothing to compare."""
    there = list(dict.fromkeys(name for run in runs for name in run.columns))
    lacking = tuple(name for name in REQUIRED if name not in there)
    if not lacking or not there:
        return []
    message = f"in no run, which have {clipped(', '.join(there))}"
    return [
        Finding("fault", "columns_missing", lacking, message, "name them so, or give --map in runs import")
    ]


def twice_findings(runs: Sequence[Run]) -> list[Finding]:
    """Runs that are there twice, of which one may be held out and the other fitted to; without noise, runs
    may repeat."""
    pairs = same_runs([run.columns for run in runs])
    if not pairs:
        return []
    names = tuple(dict.fromkeys(runs[i].name for pair in pairs for i in pair))
    first, second = pairs[0]
    message = f"{runs[second].name} is the same motion as {runs[first].name}, row by row"
    figures = {"pairs": float(len(pairs))}
    return [Finding("fault", "run_twice", ("heading",), message, "leave one of the two out", names, figures)]


def _whole(run: Run) -> bool:
    """Whether no row is missing: a gap is a step in every channel."""
    steps = np.diff(run.time)
    return bool(steps.max() <= JUMP * float(np.median(steps)))


def _is_resolved(motion: Motion | None, boat: Boat | None) -> bool:
    """Whether the rows come fast enough for the hull's motion to lie below the noise at their Nyquist
    frequency: it turns within about a length passed. Taken for granted without a boat."""
    if motion is None or boat is None:
        return True
    speed = float(np.quantile(np.abs(motion.velocity), 0.9))
    return speed * motion.step <= LONGEST_ROW * boat.length


def _even(run: Run) -> bool:
    """Whether the rows come at one rate, as filters over rows need."""
    return len(run.time) >= 3 and bool(np.quantile(np.diff(run.time), 0.02) > SHORTEST_STEP)

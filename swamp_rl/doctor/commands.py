"""Commands by themselves: which never vary, which are cut off at a level."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run
from swamp_rl.runs.columns import command_columns, command_limits
from swamp_rl.runs.units import factor
from swamp_rl.units import UNITS

Array = NDArray[np.float64]

COMMANDS = ("azimuth_", "throttle_", "rudder_", "propeller_", "joy_", "action")
FEWEST_VISITS = 5
"""Separate stays at an extreme: with fewer a driver may have held the lever there."""
LARGEST_SHARE = 0.5
"""Of the distinct values' usual number of rows: where every level is held for long, so is the greatest."""
LITTLE = 0.05
"""Share of its limit below which a command suggests another unit."""
FULL = 0.3, 1.02
"""Span of the largest share of full command in runs that use it."""
NEVER_SO = 0.02
"""Share of the rows at the extreme from which a cut-off changes what the data show."""


def is_command(name: str) -> bool:
    """Whether a column tells what was commanded."""
    return name.startswith(COMMANDS)


def other_boat_findings(runs: Sequence[Run], boat: Boat) -> list[Finding]:
    """The fault of commands of thrusters none of which the boat has."""
    there = {name for run in runs for name in run.columns}
    own = command_columns(boat)
    others = sorted(name for name in there if name.startswith(COMMANDS[:4]))
    if there & set(own) or not others:
        return []
    message = f"are not of boat {boat.name}, whose commands are {', '.join(own)}"
    advice = "name the boat of these runs by --boat, or the columns by --map in runs import"
    return [Finding("fault", "commands_missing", tuple(others), message, advice)]


def small_findings(runs: Sequence[Run], boat: Boat) -> list[Finding]:
    """Notes of commands that stay below LITTLE of the boat's limits in all runs, with the unit that would
    explain it."""
    units = [(run.meta.model_extra or {}).get("units") for run in runs]
    declared = {name: unit for one in units if isinstance(one, dict) for name, unit in one.items()}
    found = []
    for name, limit in command_limits(boat).items():
        sizes = [np.abs(known) for run in runs if name in run.columns and len(known := _known(run, name))]
        largest = max((float(size.max()) for size in sizes), default=0.0)
        if not 0.0 < largest < LITTLE * limit < math.inf:
            continue
        message = f"reaches {largest:.3g}, {largest / limit:.2g} of the limit {limit:.4g} of boat {boat.name}"
        advice = "check its unit, unless the boat was driven so slowly"
        unit = str(declared.get(name))
        if unit in UNITS and FULL[0] <= largest / factor(name, unit) / limit <= FULL[1]:
            advice = f"it was imported with --unit {name}={unit}: check whether the log has {unit}"
        elif FULL[0] <= largest <= FULL[1]:
            advice = f"if it is a share of full command, multiply it: --map '{name}=COLUMN*{limit:.9g}'"
        found.append(
            Finding("note", "command_small", (name,), message, advice, figures={"share": largest / limit})
        )
    return found


def _known(run: Run, name: str) -> Array:
    return run.columns[name][np.isfinite(run.columns[name])]


def command_findings(runs: Sequence[Run]) -> list[Finding]:
    """Commands that are missing, never vary (a fault where none does), or are cut off below full command."""
    if runs and not any(is_command(name) for run in runs for name in run.columns):
        message = "no run has a column of them"
        advice = "diagnose and identify boat need them; name them with --map in runs import"
        return [Finding("note", "commands_missing", ("commands",), message, advice)]
    names = dict.fromkeys(name for run in runs for name in run.columns if is_command(name))
    joined = {
        name: np.concatenate([run.columns[name] for run in runs if name in run.columns]) for name in names
    }
    joined = {name: known for name, values in joined.items() if len(known := values[np.isfinite(values)])}
    constant = [name for name, values in joined.items() if np.ptp(values) == 0.0]
    found = []
    own = [name for name in joined if not name.startswith("joy_")] or list(joined)
    if own and set(own) <= set(constant):
        message = "no command varies in any run"
        advice = "thrust and steering cannot be identified from them; check that commands were logged"
        found.append(Finding("fault", "commands_constant", tuple(own), message, advice))
    elif still := [name for name in constant if name in own]:
        message, its = ("never varies", "its") if len(still) == 1 else ("never vary", "their")
        advice = f"{its} effect cannot be distinguished from that of the others"
        found.append(Finding("note", "command_constant", tuple(still), message, advice))
    for name, values in joined.items():
        if name not in constant and (cut := _clipped(values)):
            level, share = cut
            if _lever_at_end(runs, name, level):
                continue
            message = f"is {level:.6g} in {share:.0%} of the rows, a level at which it is cut off"
            advice = "check the mapping (limits of the pulse width, clip()) and the logger's range"
            found.append(
                Finding(
                    "fault",
                    "command_clipped",
                    (name,),
                    message,
                    advice,
                    figures={"level": level, "share": share},
                )
            )
    return found


def _lever_at_end(runs: Sequence[Run], name: str, level: float) -> bool:
    """Whether a lever of the joypad is at its end in all rows where a command is at a level."""
    parts = [run.columns for run in runs if name in run.columns and (run.columns[name] == level).any()]
    levers = [lever for lever in parts[0] if lever.startswith("joy_")]
    return any(
        all(lever in part and np.all(np.abs(part[lever][part[name] == level]) == 1.0) for part in parts)
        for lever in levers
    )


def _clipped(values: Array) -> tuple[float, float] | None:
    """The extreme and the share of rows at it, where a signal that varies from row to row stays there.

    Full command (0, ±1) is where a driver or a controller ends by itself.
    """
    moving = np.diff(values) != 0.0
    for level in (float(values.max()), float(values.min())):
        if level in (0.0, 1.0, -1.0):
            continue
        there = values == level
        visits = int(np.sum(there[1:] & ~there[:-1]))
        share = float(there.mean())
        # Elsewhere the signal must move in nearly every row; a signal of held levels says nothing.
        elsewhere = moving[~there[1:] & ~there[:-1]]
        if len(elsewhere) < 20 or elsewhere.mean() < 1.0 - LARGEST_SHARE:
            continue
        if visits >= FEWEST_VISITS and share >= NEVER_SO and int(there.sum()) >= 2 * visits:
            return level, share
    return None

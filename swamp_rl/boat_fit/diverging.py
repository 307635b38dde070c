"""The refusal of fitted numbers with which the boat's simulated motion diverges."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.boat_fit.boat_file import Fitted
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.runs.columns import command_limits

FARTHEST = 3  # numbers that are named
NEARLY = 0.9  # of a command's limit, from which runs show how the boat moves at it


def diverging(label: str, what: str, numbers: Sequence[Fitted], run_set: RunSet) -> str:
    """The refusal of numbers fitted to the runs named: how the motion diverges, the numbers farthest from
    the start file, the commands that stay below their limits, and what to do.
    """
    below = [f"{name} {share:.2g}" for name, share in reached(run_set).items() if share < NEARLY]
    reach = f"; the runs reach of the limits of commands: {', '.join(below)}" if below else ""
    return (
        f"{_of_no_boat(label, what, numbers)}{reach}; check the units of the runs' commands and the limits "
        "in the start file, or give these numbers a smaller `sd` there"
    )


def implausible_fit(label: str, fault: str, numbers: Sequence[Fitted]) -> str:
    """The refusal of numbers fitted to the runs named that no boat file may hold: the fault, the numbers
    farthest from the start file, and what to do.
    """
    return (
        f"{_of_no_boat(label, fault, numbers)}; correct them in the start file, give them a smaller `sd` "
        "there, or record runs with more turns and speeds"
    )


def _of_no_boat(label: str, what: str, numbers: Sequence[Fitted]) -> str:
    """The fault, and the numbers farthest from the start file in its standard deviations."""
    some = sorted(numbers, key=lambda one: one.distance, reverse=True)[:FARTHEST]
    named = (f"{one.number.name} {one.number.start:.3g} to {one.value:.3g}" for one in some)
    fault = f"{label}: the fitted numbers are of no boat: {what}"
    return f"{fault}; farthest from the start file: {', '.join(named)}"


def reached(run_set: RunSet) -> dict[str, float]:
    """The share [1] of its limit that each command of a thrust reaches in runs."""
    limits = command_limits(run_set.boat)
    columns = [level for thruster in run_set.boat.thrusters for level in thruster.command_columns[1:]]
    largest = np.nanmax(np.abs(run_set.commands[..., len(columns) :]), axis=(0, 1)).tolist()
    return {name: value / limits[name] for name, value in zip(columns, largest, strict=True) if name}

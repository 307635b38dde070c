"""Weather that a run measured, as an input of its simulation, row by row."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat.resistance import DriftResistance
from swamp_rl.effects import LIBRARY
from swamp_rl.errors import UserError
from swamp_rl.physics.resistance import DEPTH as TANK_DEPTH
from swamp_rl.runs import Run
from swamp_rl.simulator.parameters import tank

Array = NDArray[np.float64]

MEASURED = {"wind": ("wind_speed", "wind_from"), "depth": ("depth",)}
"""Columns of a run that are inputs of a simulation, by what they measure."""
SPEED, FROM, DEPTH = range(3)
FIELDS = ("wind_speed", "wind_from", "depth_over_draught")
"""Of the boat's record that a row of weather sets."""
NO_WEATHER = np.zeros((0, 3))


def refuse_unknown(ignore: Sequence[str]) -> None:
    """UserError for a name that is none of MEASURED."""
    for name in ignore:
        if name not in MEASURED:
            raise UserError(f"ignore: unknown measurement {name!r}; known here: {', '.join(MEASURED)}")


def measured_weather(run: Run, boat: Boat, ignore: Sequence[str] = ()) -> Array:
    """(T, 3) wind speed [m/s], direction it comes from [rad], water depth in draughts [1] of each row.

    NaN in the columns of what was not measured, or stands in `ignore` (names of MEASURED); (0, 3) where
    nothing is left. UserError for a name that is not one, and for a depth that the boat has no tests for.
    """
    refuse_unknown(ignore)
    taken = {
        name: columns
        for name, columns in MEASURED.items()
        if name not in ignore and set(columns) <= set(run.columns)
    }
    if not taken:
        return NO_WEATHER
    weather = np.full((len(run.time), 3), np.nan)
    if "wind" in taken:
        weather[:, [SPEED, FROM]] = run.stacked(taken["wind"])
    if "depth" in taken:
        weather[:, DEPTH] = _depth_in_draughts(run, boat)
    return weather


def _depth_in_draughts(run: Run, boat: Boat) -> Array:
    depth = run.columns["depth"] / boat.draught
    if isinstance(boat.resistance, DriftResistance):
        tested = LIBRARY["shallow_water"].parameter("depth_over_draught").neutral or math.inf
        why = "has coefficients for deep water"
    else:
        tested = float(tank(boat)[0, TANK_DEPTH, 0])
        why = f"has no resistance below {tested:.3g} draughts"
    wrong = depth < tested
    if wrong.any():
        row = int(np.argmax(wrong))
        raise UserError(
            f"run {run.name}, row {row + 1}, column depth: {run.columns['depth'][row]:.6g} m is "
            f"{depth[row]:.3g} draughts, and boat {boat.name} {why}; leave it out with --ignore depth"
        )
    return depth

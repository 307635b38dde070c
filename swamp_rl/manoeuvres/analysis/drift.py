"""The drift of a turning circle's centre, from places one full turn apart (IMO MSC/Circ.1053, 3.4)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.manoeuvres.analysis.figure import resampled_blocks

Array = NDArray[np.float64]

GRID = math.radians(1.0)
BLOCK = 90  # degrees of heading that are resampled together: neighbours share their error
BLOCKS = 3  # at least, or a short turn would have no spread at all
LEAST = math.radians(90.0)  # of pairs, below which no drift is estimated


@dataclass(frozen=True)
class Turning:
    """A turn by the angle turned (N,), from 0 in steps of GRID [rad]: time [s] and place (N, 2) [m]."""

    turned: Array
    time: Array
    place: Array

    def at(self, turned: float) -> Array:
        """(2,) where the boat was when it had turned so far; NaN beyond the end."""
        if turned > self.turned[-1] + 1e-9:
            return np.full(2, math.nan)
        return np.array([np.interp(turned, self.turned, column) for column in self.place.T])

    def moment(self, turned: float) -> float:
        """Time [s] at which the boat had turned so far."""
        return float(np.interp(turned, self.turned, self.time))


def turning_of(time: Array, place: Array, turned: Array) -> Turning:
    """A turn resampled evenly in the angle turned [rad]; small reversals, which noise makes, are skipped."""
    onward = np.maximum.accumulate(turned)
    new = np.concatenate([[True], np.diff(onward) > 0.0])
    grid = np.arange(0.0, onward[-1] + 1e-12, GRID)
    columns = [np.interp(grid, onward[new], column[new]) for column in (time, *place.T)]
    return Turning(grid, columns[0], np.stack(columns[1:], axis=1))


@dataclass(frozen=True)
class Drift:
    """Mean velocity (2,) north, east [m/s] of the centre, and its resamples (B, 2)."""

    velocity: Array
    resamples: Array


def drift_of(turning: Turning, rng: np.random.Generator) -> Drift | None:
    """The drift, by the mean of the local ones over pairs one turn apart; None for too short a turn.

    The first turn is left out where three were made, half of it where there were fewer: the boat still
    loses speed there.
    """
    end, full = float(turning.turned[-1]), 2.0 * math.pi
    start = min(full, max(math.pi, end - 3.0 * math.pi))
    if end - full - start < LEAST - 1e-9:
        return None
    shift = round(full / GRID)
    first = np.arange(math.ceil(start / GRID), len(turning.turned) - shift)
    way = turning.place[first + shift] - turning.place[first]
    local = way / (turning.time[first + shift] - turning.time[first])[:, None]
    picks = resampled_blocks(len(local), min(BLOCK, len(local) // BLOCKS), rng)
    return Drift(local.mean(axis=0), local[picks].mean(axis=1))

"""Hyper-parameters of a reservoir by cross-validation over whole runs.

Rows of one run are strongly correlated, so leaving out rows would underestimate the error on new runs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Annotated, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from swamp_rl.errors import SettingsError
from swamp_rl.one_thread import one_thread
from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.callbacks import Tick
from swamp_rl.pilots.demonstrations import rows_to_learn
from swamp_rl.pilots.readout import Moments, ridge_readouts, squared_error
from swamp_rl.pilots.reservoir import ReservoirPilot, ReservoirSettings, Units, fit_reservoir, states_of
from swamp_rl.pilots.settings import NotNegative, Positive, Seed, Settings, Share
from swamp_rl.runs import Run

Some = Field(min_length=1)


class Unsearched(ReservoirSettings):
    """Settings common to all candidates."""

    seed: Annotated[int, Field(ge=0, lt=2**32, exclude=True)] = 0


class SearchedReservoirSettings(Settings):
    """The grid: the product of the lists below; all other settings as in `reservoir`."""

    reservoir: Unsearched = Unsearched()
    units: Annotated[tuple[Units, ...], Some] = (100, 200, 400)
    spectral_radius: Annotated[tuple[NotNegative, ...], Some] = (0.2, 0.5, 0.9)
    lowest_leak: Annotated[tuple[Share, ...], Some] = (0.05, 0.2)
    ridge: Annotated[tuple[Positive, ...], Some] = (0.3, 1.0, 3.0, 10.0, 30.0)
    folds: Annotated[int, Field(ge=2, le=1_000)] = 5
    seed: Seed = 0
    "Seed of the reservoirs."

    @model_validator(mode="after")
    def _leaks_in_order(self) -> Self:
        if max(self.lowest_leak) > self.reservoir.leak[1]:
            raise ValueError("lowest_leak: is above the largest leak, reservoir.leak; give smaller ones")
        return self

    @field_validator("reservoir")
    @classmethod
    def _one_seed(cls, reservoir: Unsearched) -> Unsearched:
        if reservoir.seed != 0:
            raise ValueError("seed: give it beside reservoir, not in it")
        return reservoir

    def check_count(self, count: int) -> None:
        """Raise SettingsError for fewer runs than folds."""
        if count < self.folds:
            raise SettingsError(
                f"folds: {self.folds} folds need as many runs, not {count}; lower folds, or record more runs"
            )

    def check_runs(self, runs: Sequence[Run]) -> None:
        """Raise SettingsError as `rows_to_learn`, and where a fold has no row or is none."""
        self.check_count(len(runs))
        learned = rows_to_learn(runs, self.reservoir.reaction, self.reservoir.washout)
        if not all(any(rows.any() for rows in learned[k :: self.folds]) for k in range(self.folds)):
            raise SettingsError("folds: one has no row to learn from; lower folds or reservoir.washout")


@dataclass(frozen=True)
class Scored:
    """Settings and their cross-validated mean squared error of the levers [1]."""

    settings: ReservoirSettings
    error: float


@one_thread()
def fit_searched_reservoir(
    runs: Sequence[Run],
    settings: SearchedReservoirSettings | None = None,
    tick: Tick = lambda done: None,
) -> ReservoirPilot:
    """Fit the settings with the smallest error to all runs; UserError as for `scores`."""
    return fit_reservoir(runs, scores(runs, settings, tick)[0].settings)


@one_thread()
def scores(
    runs: Sequence[Run],
    settings: SearchedReservoirSettings | None = None,
    tick: Tick = lambda done: None,
) -> list[Scored]:
    """Return the grid sorted by error, smallest first; `tick` is called with the share done.

    Each reservoir passes over all runs once; one Gram matrix for each fold serves all ridges.
    UserError where a run lacks a column, and as for `SearchedReservoirSettings.check_runs`.
    """
    settings = settings or SearchedReservoirSettings()
    settings.check_runs(runs)
    grid = list(product(settings.units, settings.spectral_radius, settings.lowest_leak))
    found = []
    for number, (units, radius, leak) in enumerate(grid):
        drawn = settings.reservoir.model_copy(
            update={
                "units": units,
                "spectral_radius": radius,
                "leak": (leak, settings.reservoir.leak[1]),
                "seed": settings.seed,
            }
        )
        errors = errors_left_out(runs, drawn, settings.ridge, settings.folds)
        found += [
            Scored(drawn.model_copy(update={"ridge": ridge}), float(error))
            for ridge, error in zip(settings.ridge, errors, strict=True)
        ]
        tick((number + 1) / len(grid))
    return sorted(found, key=lambda scored: scored.error)


def errors_left_out(
    runs: Sequence[Run], settings: ReservoirSettings, ridges: Sequence[float], folds: int
) -> Array:
    """Return the cross-validated mean squared error (R,) of each ridge; run i belongs to fold i mod `folds`.

    The error is that of the ridge readout before variance matching (`matched`). The scaling of the
    observations is that of all runs.
    """
    _, states, levers = states_of(runs, settings)
    parts = [Moments.of(states[k::folds], levers[k::folds]) for k in range(folds)]
    everything = sum(parts[1:], parts[0])
    errors = np.array(
        [
            [squared_error(readout, part) for readout in ridge_readouts(everything - part, ridges)]
            for part in parts
        ]
    )
    rows = np.array([part.gram[-1, -1] for part in parts])
    return rows @ errors / rows.sum()

"""The Esso Osaka model ship in the simulator against its pond tests: the tables of docs/validation.md."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.esso_osaka.circles import turn_rows
from benchmarks.esso_osaka.pond_tests import rms, window_errors
from benchmarks.esso_osaka.wind import HORIZON
from benchmarks.esso_osaka.windows import predicted
from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat
from swamp_rl.manoeuvres.analysis.analyse import analyse_run
from swamp_rl.manoeuvres.analysis.figure import Result
from swamp_rl.runs import Run

BEFORE = 5.0  # s before the execute that a replay starts, so that the approach is in it
FIGURES = ("advance", "tactical_diameter")


@dataclass(frozen=True)
class Circle:
    """A measured turning circle and its predictions: as measured, with the measured wind, in no wind."""

    name: str
    angle: float
    revolutions: float
    measured: Result
    windy: Result
    calm: Result


def windows(boat: Boat, runs: Sequence[Run]) -> tuple[int, float, float]:
    """How many windows of half a minute, and the root mean square position error [m] at their end.

    First without, then with the measured wind.
    """
    calm, windy = (window_errors(boat, runs, HORIZON, wind) for wind in (False, True))
    return len(calm), rms(calm), rms(windy)


def circles(boat: Boat, runs: Sequence[Run]) -> list[Circle]:
    """Every turning circle by one analysis, measured and predicted from 5 s before the execute."""
    found = []
    for source in runs:
        first, last = turn_rows(source)
        rows = slice(max(first - round(BEFORE * 10), 0), last + 1)
        cut = Run(source.name, {name: values[rows] for name, values in source.columns.items()})
        each = (cut, replayed(boat, cut, True), replayed(boat, cut, False))
        results = [analyse_run(run, boat) for run in each]
        angle = math.degrees(float(results[0].setting["angle"]))
        found.append(Circle(source.name, angle, float(source.columns["propeller_main"][first]), *results))
    return found


def replayed(boat: Boat, run: Run, wind: bool) -> Run:
    """The run that the boat file predicts for the commands of another, from its first state."""
    track = predicted(boat, run, np.array([0]), len(run.time) - 1, wind)[0]
    columns = {"time": run.time, "north": track[:, 0], "east": track[:, 1]}
    columns["heading"] = wrapped(track[:, 2])
    columns |= {name: run.columns[name] for name in ("rudder_main", "propeller_main")}
    return Run(run.name, columns)

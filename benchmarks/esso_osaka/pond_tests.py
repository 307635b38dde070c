"""Hold the Esso Osaka boat file against the measured pond tests: the tables of docs/esso_osaka.md.

    python -m benchmarks.esso_osaka.pond_tests ../shared/data/esso_osaka

The measured data are not part of the project; their licence is CC BY-NC-SA.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.circles import circle_table, steady_table
from benchmarks.esso_osaka.diagnosis import days, diagnosed, diagnosis_table
from benchmarks.esso_osaka.sway import circles_table, diagnosed_scales, sway_table
from benchmarks.esso_osaka.wind import (
    HORIZON,
    INDEPENDENT,
    Named,
    drift_table,
    error_table,
    named,
    ranking_table,
    wind_table,
)
from benchmarks.esso_osaka.windows import errors_at_end
from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import Boat, load_boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from swamp_rl.runs.free_running import import_free_running

Array = NDArray[np.float64]


def window_errors(boat: Boat, runs: Sequence[Run], seconds: float, measured_wind: bool) -> Array:
    """(n,) position error [m] at the end of all windows of the runs."""
    return np.concatenate([errors_at_end(boat, run, seconds, measured_wind) for run in runs])


def rms(errors: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(errors**2)))


def with_hull(boat: Boat, **changes: float) -> Boat:
    """The boat with other hull coefficients."""
    return boat.model_copy(update={"hull": boat.hull.model_copy(update=changes)})


def window_table(boat: Boat, runs: Sequence[Run]) -> str:
    """Errors at the horizon, run by run and over all windows."""
    rows = []
    for run in runs:
        calm, windy = (window_errors(boat, [run], HORIZON, wind) for wind in (False, True))
        speed = float(np.mean(run.columns["wind_speed"]))
        rows.append([run.name, str(len(calm)), f"{speed:.2f}", f"{rms(calm):.2f}", f"{rms(windy):.2f}"])
    calm, windy = (window_errors(boat, runs, HORIZON, wind) for wind in (False, True))
    rows.append(["**all**", str(len(calm)), "", f"**{rms(calm):.2f}**", f"**{rms(windy):.2f}**"])
    theirs = (f"{INDEPENDENT[wind]:.2f}" for wind in ("no wind", "measured wind"))
    rows.append(["an independent program", "", "", *theirs])
    return table(["run", "windows", "mean wind, m/s", "no wind, m", "measured wind, m"], rows)


def as_published(boat: Boat) -> Boat:
    """The hull with the table's X'_vr and Y'_r as they stand, which the independent program ran."""
    return with_hull(boat, x_vr=-0.0081, y_r=0.116)


def variant_table(boat: Boat, runs: Sequence[Run]) -> str:
    """Errors at the horizon where one thing is taken otherwise."""
    boats = {
        "boat file": boat,
        "X'_vr and Y'_r without the added mass": as_published(boat),
        "C_rY = 1 in place of 2.217": with_hull(boat, c_ry=1.0),
    }
    rows = [
        [name, *(f"{rms(window_errors(each, runs, HORIZON, wind)):.2f}" for wind in (False, True))]
        for name, each in boats.items()
    ]
    return table(["hull", "no wind, m", "measured wind, m"], rows)


def refused_table(folder: Path, boat: Boat) -> str:
    """The runs of a folder that the importer refuses, and why."""
    rows = []
    for path in sorted(folder.glob("*.csv")):
        try:
            import_free_running(path, boat)
        except UserError as error:
            rows.append([f"`{path.name}`", str(error).removeprefix(str(path)).lstrip(": ")])
    return table(["run", "refused for"], rows)


def parts(boat: Boat, random: Sequence[Run], turning: Sequence[Run]) -> dict[str, str]:
    """The tables of docs/esso_osaka.md by their marks, but that of the runs refused."""
    every: list[Named] = [named(boat, run) for run in random]
    calm, measured = (rms(window_errors(boat, random, HORIZON, wind)) for wind in (False, True))
    entries = {day: diagnosed(boat, runs) for day, runs in days(random).items()}
    return {
        "windows": window_table(boat, random),
        "hulls": variant_table(boat, random),
        "winds": wind_table(every),
        "candidates": ranking_table(every),
        "currents": drift_table(every),
        "predictions": error_table(boat, every, {"calm": calm, "measured": measured}),
        "diagnosis": diagnosis_table(entries),
        "circles": circle_table(boat, turning),
        "steady turns": steady_table(boat, with_hull(boat, c_ry=1.0), turning),
        "sway drag": sway_table(every),
        "circles with sway drag": circles_table(boat, diagnosed_scales(entries, every), turning),
    }


def main() -> None:
    """Write the document from the folder of measured data."""
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    data, boat = Path(sys.argv[1]), load_boat("esso_osaka")
    random, turning = (
        [import_free_running(path, boat) for path in sorted((data / kind).glob("*.csv"))]
        for kind in ("random", "turning")
    )
    found = parts(boat, random, turning) | {"refused": refused_table(data / "zigzag", boat)}
    write_parts(DOCS / "esso_osaka.md", found)


if __name__ == "__main__":
    main()

"""Hold the simulator against every number that its sources print: the tables of docs/validation.md.

    python -m benchmarks.validation.sources [FOLDER OF THE MEASURED POND TESTS]

The measured data are not part of the project; where the folder is absent their tables stay as they are.
"""

import math
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.pond import DATA
from benchmarks.esso_osaka.wind import INDEPENDENT
from benchmarks.markers import DOCS, write_parts
from benchmarks.validation.design import design_parts
from benchmarks.validation.energy import energy_rows
from benchmarks.validation.esso_osaka import FIGURES, Circle, circles, windows
from benchmarks.validation.link import link_rows
from benchmarks.validation.squat import squat_table
from benchmarks.validation.swamp import (
    FULL,
    Row,
    deduction_rows,
    force_rows,
    speed_rows,
    tank_rows,
    thrust_errors,
    turning_rows,
    yaw_rows,
)
from swamp_rl.boat import load_boat
from swamp_rl.runs.free_running import import_free_running

LARGE = 0.10  # mismatch from which a number is listed among the worst


def number(value: float, digits: int = 2) -> str:
    """A number for a table, a dash where there is none."""
    return f"{value:.{digits}f}" if math.isfinite(value) else "–"


def share(value: float) -> str:
    """A share in percent for a table, a dash where there is none."""
    return f"{100 * value:.1f} %" if math.isfinite(value) else "–"


def row_table(rows: Sequence[Row]) -> str:
    """Printed numbers against the simulator's, the comparable one bold."""
    cells = []
    for row in rows:
        full, light = number(row.full), number(row.light)
        if row.comparable == FULL:
            full = f"**{full}**"
        else:
            light = f"**{light}**"
        cells.append([row.what, row.source, row.printed, full, light, f"{100 * row.mismatch:+.0f} %"])
    return table(["number", "source", "printed", "58 kg", "48 kg", "mismatch of the bold one"], cells)


def worst_table(rows: Sequence[Row]) -> str:
    """The mismatches above `LARGE`, the largest first."""
    worst = sorted(rows, key=lambda row: -abs(row.mismatch))
    cells = [
        [row.what, row.source, row.printed, f"{100 * row.mismatch:+.0f} %"]
        for row in worst
        if abs(row.mismatch) > LARGE
    ]
    return table(["number", "source", "printed", "mismatch"], cells)


def count_table(rows: Sequence[Row]) -> str:
    """How many printed numbers there are, and how many of them some reading meets within `LARGE`."""
    best: dict[str, float] = {}
    for row in rows:
        number_of = row.reading_of or f"{row.what}, {row.source}"
        best[number_of] = min(best.get(number_of, math.inf), abs(row.mismatch))
    met = sum(mismatch <= LARGE for mismatch in best.values())
    return table(
        ["printed numbers", "within 10 %", "readings", "within 10 %"],
        [[str(len(best)), str(met), str(len(rows)), str(sum(abs(row.mismatch) <= LARGE for row in rows))]],
    )


def swamp_parts() -> dict[str, str]:
    """The tables about SWAMP by their marks."""
    speeds, turns, forces, energy = speed_rows(), turning_rows(), force_rows(), energy_rows()
    link = link_rows()
    tank = ["depth", "points", "largest error", "depth left out: largest", "root mean square"]
    yaw = ["yaw model", "k_r", "c_ru", "c_rv", "b_r", "damping at 1 m/s, N m s", "time constant at 1 m/s, s"]
    bollard = [[number(error) for error in thrust_errors()]]
    deduction = [[str(percent), number(speed), number(factor)] for percent, speed, factor in deduction_rows()]
    return {
        "count": count_table([*speeds, *turns, *forces, *energy, *link]),
        "largest mismatches": worst_table([*speeds, *turns, *forces, *energy, *link]),
        "speeds": row_table(speeds),
        "turns": row_table(turns),
        "tank": table(tank, [[r.depth, str(r.points), *map(share, r.errors)] for r in tank_rows()]),
        "bollard thrust": table(["largest difference, N", "root mean square, N"], bollard),
        "forces": row_table(forces),
        "squat": squat_table(),
        "energy": row_table(energy),
        "link": row_table(link),
        "thrust deduction": table(["RPM %", "speed, m/s", "1 − t by eq. 7.3"], deduction),
        "yaw models": table([*yaw, "rate at 30°, deg/s"], [row.cells for row in yaw_rows()]),
    }


def esso_parts(folder: Path) -> dict[str, str]:
    """The tables about the second boat by their marks; none where its data are absent."""
    if not folder.is_dir():
        return {}
    boat = load_boat("esso_osaka")
    random, turning = (
        [import_free_running(path, boat) for path in sorted((folder / kind).glob("*.csv"))]
        for kind in ("random", "turning")
    )
    _, calm, windy = windows(boat, random)
    found = circles(boat, turning)
    errors = [["boat file", number(calm), number(windy)]]
    theirs = (number(INDEPENDENT[wind]) for wind in ("no wind", "measured wind"))
    errors.append(["an independent program", *theirs])
    return {
        "windows": table(["", "no wind, m", "measured wind, m"], errors),
        "circles": circle_table(found, corrected=False),
        "circles without drift": circle_table(found, corrected=True),
        "circle errors": circle_errors(found),
    }


def circle_table(found: Sequence[Circle], corrected: bool) -> str:
    """Advance and tactical diameter of each circle, measured, with the measured wind and without wind."""
    rows = []
    for circle in found:
        cells = [circle.name, f"{circle.angle:+.0f}", f"{circle.revolutions:.0f}"]
        for result in (circle.measured, circle.windy, circle.calm):
            figures = result.corrected if corrected else result.figures
            cells.append(" / ".join(number(figures[n].value, 1) if n in figures else "–" for n in FIGURES))
        rows.append(cells)
    return table(["run", "rudder, deg", "rps", "measured", "with its wind", "no wind"], rows)


def circle_errors(found: Sequence[Circle]) -> str:
    """How far the predictions with wind are off, over ground, over all circles."""
    rows = []
    for name in FIGURES:
        ratios = [c.windy.figures[name].value / c.measured.figures[name].value - 1.0 for c in found]
        off = 100.0 * np.array([ratio for ratio in ratios if math.isfinite(ratio)])
        spread = f"{off.min():+.0f} to {off.max():+.0f} %"
        rows.append([name.replace("_", " "), str(len(off)), f"{np.median(off):+.0f} %", spread])
    return table(["figure", "circles", "median error", "least to most"], rows)


def main() -> None:
    """Write the tables; the folder of measured data may be given."""
    if len(sys.argv) > 2:
        raise SystemExit(__doc__)
    folder = Path(sys.argv[1]) if len(sys.argv) == 2 else DATA
    if len(sys.argv) == 2 and not (folder / "turning").is_dir():
        raise SystemExit(f"{folder}: no turning/ here; name the folder of the measured pond tests, or none")
    write_parts(DOCS / "validation.md", swamp_parts() | design_parts() | esso_parts(folder))


if __name__ == "__main__":
    main()

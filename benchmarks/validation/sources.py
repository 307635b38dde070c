"""Hold the simulator against every number that its sources print: the tables of docs/validation.md.

    python -m benchmarks.validation.sources [FOLDER OF THE MEASURED POND TESTS]

The measured data are not part of the project; where the folder is absent their tables stay as they are.
"""

import math
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.pond import DATA
from benchmarks.esso_osaka.wind import INDEPENDENT
from benchmarks.markers import DOCS, write_parts
from benchmarks.validation.check import Judged, count_table, reasons
from benchmarks.validation.coefficients import coefficient_rows
from benchmarks.validation.design import design_groups, design_parts
from benchmarks.validation.energy import energy_rows
from benchmarks.validation.esso_osaka import FIGURES, Circle, circles, windows
from benchmarks.validation.link import link_rows
from benchmarks.validation.not_computable import not_computable_table
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
    """The readings that are not within the tolerance, the largest mismatch first."""
    worst = sorted((row for row in rows if not row.met), key=lambda row: -abs(row.mismatch))
    cells = [[row.what, row.source, row.printed, f"{100 * row.mismatch:+.0f} %"] for row in worst]
    return table(["number", "source", "printed", "mismatch"], cells)


def swamp_groups() -> dict[str, list[Row]]:
    """The counted rows about SWAMP by the names of their tables."""
    return {
        "speeds": speed_rows(),
        "turning": turning_rows(),
        "resistance and thrust": force_rows(),
        "coefficients": coefficient_rows(),
        "energy": energy_rows(),
        "azimuth": link_rows(),
    }


def swamp_parts(groups: Mapping[str, list[Row]]) -> dict[str, str]:
    """The tables about SWAMP by their marks."""
    rows = [row for group in groups.values() for row in group]
    tank = ["depth", "points", "largest error", "depth left out: largest", "root mean square"]
    yaw = ["yaw model", "k_r", "c_ru", "c_rv", "b_r", "damping at 1 m/s, N m s", "time constant at 1 m/s, s"]
    bollard = [[number(error) for error in thrust_errors()]]
    deduction = [[str(percent), number(speed), number(factor)] for percent, speed, factor in deduction_rows()]
    return {
        "count": count_table(groups, "SWAMP"),
        "missed": reasons(rows),
        "largest mismatches": worst_table(rows),
        "speeds": row_table(groups["speeds"]),
        "turns": row_table(groups["turning"]),
        "tank": table(tank, [[r.depth, str(r.points), *map(share, r.errors)] for r in tank_rows()]),
        "bollard thrust": table(["largest difference, N", "root mean square, N"], bollard),
        "forces": row_table(groups["resistance and thrust"]),
        "coefficients": row_table(groups["coefficients"]),
        "squat": squat_table(),
        "energy": row_table(groups["energy"]),
        "link": row_table(groups["azimuth"]),
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
    swamp, designs = swamp_groups(), design_groups()
    parts = swamp_parts(swamp) | design_parts(designs) | {"not computable": not_computable_table()}
    parts["count of all"] = count_table({"SWAMP": _all(swamp), "designs": _all(designs)}, "source")
    write_parts(DOCS / "validation.md", parts | esso_parts(folder))


def _all(groups: Mapping[str, Sequence[Judged]]) -> list[Judged]:
    return [one for group in groups.values() for one in group]


if __name__ == "__main__":
    main()

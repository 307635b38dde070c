"""Hold the simulator against every number that its sources print and write docs/validation.md.

    python -m benchmarks.validation.sources [FOLDER OF THE MEASURED POND TESTS]

The measured data are not part of the project; where the folder is absent the document says so.
"""

import math
import sys
import textwrap
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.pond_tests import HORIZON
from benchmarks.validation.esso_osaka import FIGURES, INDEPENDENT, Circle, circles, windows
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
from swamp_rl.files import write_beside
from swamp_rl.runs.free_running import import_free_running

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT.parent / "shared" / "data" / "esso_osaka"
LARGE = 0.10  # mismatch that the summary names


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


def summary(rows: Sequence[Row]) -> str:
    """The mismatches in order of their size."""
    worst = sorted(rows, key=lambda row: -abs(row.mismatch))
    off = [row for row in worst if abs(row.mismatch) > LARGE]
    lines = [f"* {row.what}: {100 * row.mismatch:+.0f} % against {row.printed} ({row.source})" for row in off]
    kept = f"{len(rows) - len(off)} of {len(rows)} printed numbers are met within {100 * LARGE:.0f} %"
    return f"{kept}. The others:\n\n" + "\n".join(lines)


def swamp_part() -> str:
    """The part of the document about SWAMP."""
    speeds, turns, forces = speed_rows(), turning_rows(), force_rows()
    return f"""## SWAMP

`swamp` is the boat at 58 kg, `swamp-light` at 48 kg. Bold is the load that the source is about,
and 58 kg where
it does not say. A printed "almost" or "about" is taken at its number; "under" is a limit, met below it.

### In short

{summary([*speeds, *turns, *forces])}

### Speeds

{row_table(speeds)}

In 200 mm of water the boat at 58 kg has h/T = 1.43, shallower than any test of the tank: the model
refuses it,
and the number is that at h/T = 1.5.

### Turning

Each trial in closed loop after a steady approach, as `swamp-rl trial` sails it. The thesis does
not say how its
diameters were measured, so both kinds stand here.

{row_table(turns)}

### Resistance and thrust

{tank_part()}

{row_table(forces)}

{deduction_part()}

### The yaw model of 002

{yaw_part()}

The overshoots and diameters of 002's own trials are printed as pictures only, so there is no number to hold
against the plan `ittc_swamp`.
"""


def tank_part() -> str:
    """Resistance at every depth, and bollard thrust."""
    head = ["depth", "points", "largest error", "depth left out: largest", "root mean square"]
    rows = [[row.depth, str(row.points), *(share(error) for error in row.errors)] for row in tank_rows()]
    most, mean = thrust_errors()
    return f"""\
The towing tank's table is the model's own input, so its reproduction is no test; it shows that nothing
was lost.
How the model does at a depth whose tests it was not given is one: the last two columns.

{table(head, rows)}

Bollard thrust against table 5.5, 19 points: largest difference {most:.2f} N, root mean square
{mean:.2f} N."""


def deduction_part() -> str:
    """The self-propulsion test of 7.3.5."""
    rows = [[str(percent), number(speed), number(factor)] for percent, speed, factor in deduction_rows()]
    return f"""\
Straight ahead on four thrusters at 48 kg, with what eq. 7.3 makes of it. 7.3.5 gives in words about 0.3 at
low RPM % and 0.75 around the design RPM, and its curves only as pictures; the model was given these two ends.

{table(["RPM %", "speed, m/s", "1 − t by eq. 7.3"], rows)}"""


def yaw_part() -> str:
    """Table III against the same model of the simulated boat."""
    models = yaw_rows()
    head = ["yaw model", "k_r", "c_ru", "c_rv", "b_r", "time constant at 1 m/s, s", "rate at 30°, deg/s"]
    published, simulated = (row.model.damping(1.0) for row in models[:2])
    return f"""\
Eq. 1 of 002 with table III, and the same form fitted to the simulator's own runs of tables I and II at
1600 rpm (48 kg), I_r = 7.58 kg m². The last two columns follow from each: how fast the yaw rate settles at
1 m/s without
sway, and where it settles at 30° in the simulator's own turn ({models[0].surge:.2f} m/s ahead,
{models[0].sway:.2f} m/s aside).

{table(head, [row.cells for row in models])}

Running straight at 1 m/s, table III damps a yaw rate with {published:.2f} N m s: {on_course(published)}.
The simulator's own runs give {simulated:.2f} N m s: {on_course(simulated)}. A positive c_rv makes the
sway of a turn drive it, a negative one makes it brake."""


def on_course(damping: float) -> str:
    """Whether a boat with that damping of its yaw rate keeps its course."""
    return "stable on its course" if damping > 0.0 else "unstable on its course"


def esso_part(folder: Path) -> str:
    """The part about the second boat, or the line that its data are absent."""
    head = "## Esso Osaka, measured on a pond\n\n"
    if not folder.is_dir():
        return f"{head}Not regenerated: the measured runs were not found; name their folder to the command.\n"
    boat = load_boat("esso_osaka")
    random, turning = (
        [import_free_running(path, boat) for path in sorted((folder / kind).glob("*.csv"))]
        for kind in ("random", "turning")
    )
    count, calm, windy = windows(boat, random)
    found = circles(boat, turning)
    errors = [["boat file", number(calm), number(windy)]]
    errors.append(["an independent program", *(number(error) for error in INDEPENDENT)])
    return f"""{head}\
Wakita et al. 2022 (10.1007/s00773-021-00867-1) and Miyauchi et al. 2022 (10.1007/s00773-022-00889-3),
CC BY-NC-SA; the runs are not part of this project. `docs/esso_osaka.md` says more about the boat
and about what may
cause the mismatch.

{count} windows of {HORIZON:.0f} s over the {len(random)} random runs, position error at the end,
root mean square:

{table(["", "no wind, m", "measured wind, m"], errors)}

Turning circles, advance / tactical diameter in m. As they were, over ground, measured and predicted from the
measured state 5 s before the rudder went over:

{circle_table(found, corrected=False)}

With the drift of each circle's centre removed, where it turned far enough (1.75 turns) to tell it:

{circle_table(found, corrected=True)}

{circle_summary(found)}
"""


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


def circle_summary(found: Sequence[Circle]) -> str:
    """How far the predictions with wind are off, over all circles."""
    lines = []
    for name in FIGURES:
        ratios = [c.windy.figures[name].value / c.measured.figures[name].value - 1.0 for c in found]
        finite = 100.0 * np.array([ratio for ratio in ratios if math.isfinite(ratio)])
        spread = f"{finite.min():+.0f} to {finite.max():+.0f} % over {len(finite)} circles"
        what = f"{name.replace('_', ' ')}, over ground, with the measured wind"
        lines.append(f"* {what}: off by {np.median(finite):+.0f} % in the median, {spread}")
    return "\n".join(lines)


def filled(text: str) -> str:
    """The same Markdown with its paragraphs filled to one width; headings, lists and tables stay."""
    blocks = text.split("\n\n")
    plain = [not block.lstrip().startswith(("#", "|", "*")) for block in blocks]
    return "\n\n".join(
        textwrap.fill(" ".join(block.split()), 110, break_long_words=False, break_on_hyphens=False)
        if fill
        else block
        for block, fill in zip(blocks, plain, strict=True)
    )


def document(folder: Path) -> str:
    """The text of docs/validation.md."""
    text = f"""# The simulator against what was measured

Written by `python -m benchmarks.validation.sources`, every number in it. Nothing was tuned to this list.
Sections, tables
and equations are those of A. Odetti's thesis; 002 is Ferretti et al., *Procedures for Manoeuvrability
Characterization: From Ships to Marine Robots*.

{swamp_part()}
{esso_part(folder)}"""
    return filled(text).rstrip() + "\n"


def main() -> None:
    """Write the document; the folder of measured data may be given."""
    if len(sys.argv) > 2:
        raise SystemExit(__doc__)
    folder = Path(sys.argv[1]) if len(sys.argv) == 2 else DATA
    if len(sys.argv) == 2 and not (folder / "turning").is_dir():
        raise SystemExit(f"{folder}: no turning/ here; name the folder of the measured pond tests, or none")
    with write_beside(ROOT / "docs" / "validation.md") as part:
        part.write_text(document(folder), encoding="utf-8")


if __name__ == "__main__":
    main()

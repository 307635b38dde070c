"""Hold the Esso Osaka boat file against the measured pond tests and write docs/esso_osaka.md.

    python -m benchmarks.esso_osaka.pond_tests ../shared/data/esso_osaka

The measured data are not part of the project; their licence is CC BY-NC-SA.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.circles import circle, circle_table, steady_figures, steady_table
from benchmarks.esso_osaka.diagnosis import days, diagnosed, diagnosis_table, interval_words
from benchmarks.esso_osaka.sway import circles_table, sway_table, sway_words, told_scales
from benchmarks.esso_osaka.wind import Named, drift_table, error_table, named, ranking_table, wind_table
from benchmarks.esso_osaka.words import calm_run_words, cause_words, circle_words, refused, steady_words
from swamp_rl.boat import Boat, load_boat
from swamp_rl.files import write_beside
from swamp_rl.runs import Run
from swamp_rl.runs.free_running import import_free_running
from swamp_rl.simulator.windows import replay_windows

Array = NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[2]
HORIZON = 30.0  # s


def window_errors(boat: Boat, runs: Sequence[Run], seconds: float, measured_wind: bool) -> Array:
    """(n,) position error [m] at the end of all windows of the runs."""
    found = [replay_windows(boat, run, seconds, measured_wind).position_error[:, -1] for run in runs]
    return np.concatenate(found)


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
    rows.append(["an independent program", "", "", "0.75", "0.47"])
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


def document(boat: Boat, random: Sequence[Run], turning: Sequence[Run], zigzags: str) -> str:
    """The text of docs/esso_osaka.md; zigzags: those refused."""
    every: list[Named] = [named(boat, run) for run in random]
    calm, measured = (rms(window_errors(boat, random, HORIZON, wind)) for wind in (False, True))
    known = {"calm": calm, "measured": measured}
    raw_calm, raw_windy = (
        rms(window_errors(as_published(boat), random, HORIZON, wind)) for wind in (False, True)
    )
    told = {day: diagnosed(boat, runs) for day, runs in days(random).items()}
    return f"""# The Esso Osaka model ship against its pond tests

Written by `python -m benchmarks.esso_osaka.pond_tests ../shared/data/esso_osaka`. The boat is
`configs/boats/esso_osaka.yaml`: a 3 m model, one propeller, one rudder, with the coefficients published for
it; nothing in it was fitted here. The measured runs (Wakita et al. 2022, 10.1007/s00773-021-00867-1; Miyauchi
et al. 2022, 10.1007/s00773-022-00889-3; CC BY-NC-SA) are not part of this project.

## Half a minute ahead

Windows of {HORIZON:.0f} s over the random runs, each started from the measured pose and velocity; root mean
square of the position error at the end. The measured wind goes in sample by sample, through the DNV form of
SWAMP's wind model with the published areas. The commands are what the run holds, after a servo of 20 deg/s
(ours).

{window_table(boat, random)}

The independent program ran the same coefficients, with Fujiwara's wind coefficients. One convention lies
between the two. The published equations of motion carry the added mass in the Coriolis terms,
(m + m_y) v r and (m + m_x) u r; SWAMP's do not, their hull coefficients hold it. So the boat file has
X'_vr + m'_y and Y'_r - m'_x where the published table has X'_vr and Y'_r. Taken as they stand, the table's
numbers leave {raw_calm:.2f} m without wind, where the independent program has 0.75 m:

{variant_table(boat, random)}

## The wind, named from the motion alone

The wind columns are hidden; the rest of each run is cut in minutes, each with an initial state of its own,
and effects are fitted by rollouts as `swamp-rl diagnose` fits them (docs/criticism.md). The wind differs from
run to run, so each run has its own. Residuals are weighted by what the wind's own fit leaves, since here the
model errs by more than the sensors do. One constant wind, beside what the anemometer measured in its gusts:

{wind_table(every)}

{calm_run_words(every)}

What the motion calls for, held-out misfit minute by minute (1 is what the wind alone leaves in the fit):

{ranking_table(every)}

{cause_words(every)}

{drift_table(every)}

How far that carries, in windows of {HORIZON:.0f} s from measured states, every minute predicted with numbers
from the other half of the minutes:

{error_table(boat, every, known)}

## What `swamp-rl diagnose` says

The runs of each day together, their wind columns hidden, through the command's own method from beginning to
end: one constant wind for all of a day's runs, among all other candidates. Intervals cover 95 %.

{diagnosis_table(told)}

{interval_words(told)}

## Circles

Advance / tactical diameter of the longest turn of each run, raw: the wind's drift is in all but the last
column.

{circle_table(boat, turning)}

The same turns after their first minute, over whole turns: speed, drift angle, yaw rate.

{steady_table(boat, with_hull(boat, c_ry=1.0), turning)}

## What the sway drag explains

{sway_words(told, every)}

{sway_table(every)}

That was told from runs with a rudder at random. The circles above had no part in it; they were sailed in
other months. Predicted from their first state, in their measured wind, by how much is each off, in the median
of {len(turning)} turns and in the worst? Speed, drift angle and yaw rate are those after the first minute.

{circles_table(boat, told_scales(told, every), turning)}

What the candidates call sway drag is the hull's whole cross-flow drag. What else resists sideways could hide
behind it, so the runs tell how much resists, not why. One wind for all of a day's runs, which the diagnosis
has, leaves what the wind changes by between them to the hull.

## What differs

* {circle_words([circle(boat, run) for run in turning])}
* {steady_words(steady_figures(boat, with_hull(boat, c_ry=1.0), turning))} C_rY multiplies the yaw rate in the
  sideways drag, whose net force then pushes the hull into the turn and keeps the drift small. One value tried
  once is a hint at a cause, not a fit. Less sway drag, which the random runs call for, is told above. The
  boat file keeps what was published.
* Without the measured wind the windows' error is {calm / measured:.1f} times as large. The DNV coefficients
  are not this ship's own, yet with the hull taken as the independent program took it they leave
  {raw_windy:.2f} m, where that program got 0.47 m from Fujiwara's.
* The rudder's servo is assumed. The runs record steps of 35 degrees from one sample to the next, so they
  hold the commanded angle.
* While the ship goes astern the rudder meets the water at u_R = u, so a propeller turning ahead loses its
  rudder at the moment the ship stops; the authors' program keeps the race there.
* Zig-zags that the importer refuses: {zigzags}.
"""


def main() -> None:
    """Write the document from the folder of measured data."""
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    data, boat = Path(sys.argv[1]), load_boat("esso_osaka")
    random, turning = (
        [import_free_running(path, boat) for path in sorted((data / kind).glob("*.csv"))]
        for kind in ("random", "turning")
    )
    text = document(boat, random, turning, refused(data / "zigzag", boat))
    with write_beside(ROOT / "docs" / "esso_osaka.md") as part:
        part.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()

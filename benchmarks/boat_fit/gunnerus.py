"""Identify the research vessel Gunnerus from its sea trials in October 2022: the tables of docs/gunnerus.md.

    python -m benchmarks.boat_fit.gunnerus RVG_ManeuveringTests.csv --out results/gunnerus

The measured data are not part of the project: one table of 2.5 hours, in steps of 0.5 s.
"""

from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.boat_fit.arguments import source_and_out
from benchmarks.boat_fit.kvlcc2 import FIGURES, WAYS, causes_table
from benchmarks.boat_fit.tables import compared_table, doctor_lines, error_table, findings, number_table
from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import load_boat
from swamp_rl.boat.defaults import assumed
from swamp_rl.boat.estimate import DENSITY, annotated, boat_file
from swamp_rl.boat.estimate_hull import FIN_ASPECT, fullness
from swamp_rl.boat_fit.identify import identify_boat
from swamp_rl.boat_fit.result import Identification
from swamp_rl.criticism.diagnose import diagnose
from swamp_rl.criticism.report.words import residual_force_sentence
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.manoeuvres.analysis.analyse import analyse_runs
from swamp_rl.manoeuvres.analysis.figure import Result
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes

SIZES = {
    "length": 33.9,
    "breadth": 9.6,
    "mass": 531e3,
    "thrust": 140e3,
    "top_speed": 6.3,
    "draught": 2.786,
    "fin": 6.0,
}
"""Sizes [m], mass [kg], bollard pull [N], speed [m/s] and lateral area of both drives [m2]."""
SIDES = {"port": -2.7, "starboard": 2.7}  # m to starboard of the centre line
AZIMUTH, REVOLUTIONS = 0.8, 205  # rad that the drives turn at most, rpm of full throttle
RESAMPLED, FILL = 1.0, 4.0  # Hz and s of `--resample` and `--fill`
KNOTS = "1.9834/1.943844"  # the factor of the log's knots over the true one
NOTES = "R/V Gunnerus, 27 October 2022"
SHARED = [
    *("time=tvec", "north=N", "east=E", "r=radians(r)"),
    *(f"azimuth_{side}=radians(Azi)" for side in SIDES),
    *(f"throttle_{side}=RPM/{REVOLUTIONS}" for side in SIDES),
]
LOGGED = [*SHARED, "heading=radians(psi)", "u=u", "v=v"]
MENDED = [
    *SHARED,
    "heading=where(abs(turn_rate(radians(psi))) > 0.12, 0/0, radians(psi))",
    *(f"{name}={name}*{KNOTS}" for name in "uv"),
]
RECKONED = [
    "north=integral(surge*cos(heading)-sway*sin(heading))",
    "east=integral(surge*sin(heading)+sway*cos(heading))",
]
CUTS = [440, 720, 1180, 1440, 1590, 1840, 2290, 2600, 2960, 3270, 3720, 4080, 4350, 4600]
CUTS += [4920, 5040, 5290, 5960, 6250, 6960, 7090, 7470, 7570, 7790, 8210, 8450]
"""s: between two manoeuvres."""
LOST = [2699, 4213]
"""s: about which a minute of the log is missing."""
KEEP = "keep=" + "*".join(
    [*(f"(time-{at})" for at in CUTS), *(f"where(abs(time-{at})<5,0,1)" for at in LOST)]
)
FOIL_SPREAD, GAMMA_SD = 0.4, 0.15
"""Standard deviation of the prior of a foil's area, a share of it, and of γ, as of a rudder of `boat new`."""
OF_FOILS = ("foil.area", "foil.gamma", "azimuth_offset", "inertia_z", "hull.y_v", "hull.n_v", "hull.n_r")
"""Numbers of the table on foils."""
FEWEST, TURNED = 60.0, 2.0  # s of a run, and rad that it turns at least, whose clock is compared


def start_content() -> dict[str, Any]:
    """The estimate of `boat new` for an outboard, with two drives of half its thrust in its place."""
    content = boat_file("gunnerus", "outboard", **SIZES)
    (drive,) = content["thrusters"]
    for name in ("thrust_linear", "thrust_quadratic", "astern_linear", "astern_quadratic", "nozzle_area"):
        drive[name] |= {key: 0.5 * drive[name][key] for key in ("value", "sd")}
    drive["azimuth_min"] |= {"value": -AZIMUTH}
    drive["azimuth_max"] |= {"value": AZIMUTH}
    content["thrusters"] = [deepcopy(drive) | {"name": side} for side in SIDES]
    for thruster, place in zip(content["thrusters"], SIDES.values(), strict=True):
        thruster["y"] |= {"value": place}
    content["joypad"]["thrusters"] = list(SIDES)
    return content


def content_with_foils() -> dict[str, Any]:
    """As `start_content`, the lateral area as foils that turn with the drives, in place of a fin of the hull;
    γ by Yoshimura and Masumoto's regression of rudders, 2.06 C_B B/L + 0.14."""
    content = start_content()
    sizes = {name: value for name, value in SIZES.items() if name != "fin"}
    content["hull"] = boat_file("gunnerus", "outboard", **sizes)["hull"]
    length, breadth, area = SIZES["length"], SIZES["breadth"], 0.5 * SIZES["fin"]
    block = SIZES["mass"] / (DENSITY * length * breadth * SIZES["draught"])
    gamma = 2.06 * fullness(block, length, breadth) + 0.14
    source = "Yoshimura and Masumoto 2012, 2.06 C_B B/L + 0.14, of rudders"
    foil = {
        "area": assumed(area, "m2", "half of the lateral area of both drives", FOIL_SPREAD * area),
        "aspect_ratio": assumed(FIN_ASPECT, "1", "as of a fin"),
        "gamma": assumed(gamma, "1", source, GAMMA_SD),
    }
    content["thrusters"] = [drive | {"foil": foil} for drive in content["thrusters"]]
    return content


def start_file(path: Path, content: dict[str, Any]) -> Path:
    """The file of that content."""
    path.write_text(annotated(content, "R/V Gunnerus."), encoding="utf-8")
    return path


def imported(source: Path, boat: Path, out: Path, mapping: list[str], wishes: Wishes | None = None) -> Path:
    """The runs of a log, or of a dataset, as the new dataset `out`."""
    kind = "parquet" if source.is_dir() else "csv"
    about = About() if source.is_dir() else About(boat=str(boat), notes=NOTES)
    import_logs([source], kind, out, about, wishes or Wishes(), Reading(mapping_of(mapping)))
    return out


def results_of(runs: list[Run], boat: Path) -> list[Result]:
    """What `trial analyse` finds in the runs."""
    return analyse_runs(runs, load_boat(boat))[0]


def figures_table(results: list[Result], length: float) -> str:
    """Figures of the measured manoeuvres, ways in lengths."""
    rows = []
    for one in results:
        values = [one.figures[name].value if name in one.figures else None for name in FIGURES]
        ways = ["" if value is None else f"{value / length:.2f}" for value in values[: len(WAYS)]]
        shown = ["" if value is None else f"{value:.1f}" for value in values[len(WAYS) :]]
        angle = float(np.degrees(one.setting["angle"]))
        rows.append([one.run.rpartition("-")[2], one.kind, f"{angle:+.0f}", *ways, *shown])
    return table(["run", "manoeuvre", "steering, deg", *FIGURES.values()], rows)


def clock_table(measured: list[Run]) -> str:
    """Of the runs that turn: way by the positions over that by the speeds, and turn of the heading over that
    by the yaw rate; both are 1 where all channels have one clock."""
    rows = []
    for run in measured:
        c, seconds = run.columns, float(run.time[-1] - run.time[0])
        by_rate = abs(float(np.trapezoid(c["yaw_rate"], run.time)))
        if seconds < FEWEST or by_rate < TURNED:
            continue
        samples = slice(None, None, 4)
        way = float(np.hypot(np.diff(c["north"][samples]), np.diff(c["east"][samples])).sum())
        by_speed = float(np.trapezoid(np.hypot(c["surge"], c["sway"]), run.time))
        heading = np.unwrap(c["heading"])
        change = abs(float(heading[-1] - heading[0]))
        rows.append([run.name.rpartition("-")[2], f"{way / by_speed:.3f}", f"{change / by_rate:.3f}"])
    return table(["run", "way by positions / by speeds", "turn by heading / by yaw rate"], rows)


def foil_parts(found: Identification, steered: Identification) -> dict[str, str]:
    """The parts of the page on the identified file whose drives are foils; found: the one without."""
    return {
        "foil errors": compared_table(found, steered),
        "foil numbers": number_table(steered, OF_FOILS),
    }


def main() -> None:
    """Write the page's tables."""
    source, out = source_and_out(__doc__)
    out.mkdir(parents=True)
    start = start_file(out / "gunnerus.yaml", start_content())
    doctor = doctor_lines(imported(source, start, out / "as_logged", LOGGED))
    whole = Wishes(resample=RESAMPLED, fill=FILL, bad_rows="split")
    mended = imported(source, start, out / "mended", MENDED, whole)
    measured = imported(mended, start, out / "measured", [KEEP])
    reckoned = imported(mended, start, out / "reckoned", RECKONED)
    runs = imported(reckoned, start, out / "runs", [KEEP])
    file = out / "identified.yaml"
    found = identify_boat(runs, start, file)
    parts = {
        "doctor": doctor,
        "clock": clock_table(read_dataset(measured).runs),
        "findings": findings(found),
        "errors": error_table(found),
        "numbers": number_table(found),
        "figures": figures_table(results_of(read_dataset(runs).runs, start), found.boat.length),
    }
    write_parts(DOCS / "gunnerus.md", parts)
    foils = start_file(out / "gunnerus_foils.yaml", content_with_foils())
    steered = identify_boat(runs, foils, out / "identified_foils.yaml")
    write_parts(DOCS / "gunnerus.md", foil_parts(found, steered))
    lacking = diagnose(runs, file, out / "diagnosis", twins=0)
    causes = f"{causes_table(lacking)}\n\n{residual_force_sentence(lacking)}"
    write_parts(DOCS / "gunnerus.md", {"causes": causes})
    print(f"identified in {found.elapsed:.0f} s", flush=True)


if __name__ == "__main__":
    main()

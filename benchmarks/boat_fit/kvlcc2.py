"""Identify a model of the tanker KVLCC2 from zig-zags in one tank, and predict tests in another: the tables
of docs/kvlcc2.md.

    python -m benchmarks.boat_fit.kvlcc2 SOURCE/data/01_raw --out results/kvlcc2

The measured data are not part of the project. Each file is one test: lines of title, then a table without
names; those of MARIN are at the scale of the ship.
"""

import csv
from pathlib import Path

import numpy as np
from swamp_rl.experiments.fleet.words import estimate_words
from swamp_rl.experiments.reports.experiment import table

from benchmarks.boat_fit.arguments import source_and_out
from benchmarks.boat_fit.tables import doctor_lines, error_table, findings, number_table
from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import annotated, boat_file
from swamp_rl.boat_fit.identify import errors_on, identify_boat
from swamp_rl.criticism.data.run_set import read_run_set
from swamp_rl.criticism.diagnose import diagnose
from swamp_rl.criticism.report.evidence import carry_over_sentence, share_text
from swamp_rl.criticism.report.words import parameter_sets, readable
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.manoeuvres.analysis.analyse import analyse_run
from swamp_rl.runs import read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes

SCALE, RATE, RESAMPLED = (
    45.7,
    49.97,
    5.0,
)  # of the ship; Hz of MARIN's rows at the model's scale; Hz of all runs
SIZES = {
    "length": 7.0,
    "breadth": 1.2688,
    "mass": 3272.0,
    "thrust": 59.0,
    "top_speed": 1.18,
    "draught": 0.455,
}
"""Sizes [m], mass [kg], bollard pull [N] by the open-water test and speed [m/s] of the model."""
PARTICULARS = {"water_density": 1000.0, "x_g": 0.2436}
THRUSTER = {"rudder_max": 0.62, "revolutions_max": 10.8}
DIAMETER, RUDDER_AREA = 0.204, 0.0539  # m, m2
HSVA = ["time", "x", "y", "heading", "vx", "vy", "r", "roll", "rudder", "n", "thrust", "torque"]
MARIN = ["time", "x", "y", "roll", "heading", "vx", "vy", "p", "r", "rudder", "rpm"]
SHARED = ["heading=radians(heading)", "rudder_main=-radians(rudder)"]
OF_HSVA = ["time=time", "north=x", "east=y", "vx=vx", "vy=vy", "r=radians(r)", "propeller_main=n", *SHARED]
ROOT = f"{SCALE}**0.5"  # of times and speeds, by Froude's law
OF_MARIN = [
    *(f"{ours}={theirs}/{SCALE}" for ours, theirs in (("north", "x"), ("east", "y"))),
    *(f"{name}={name}/{ROOT}" for name in ("vx", "vy")),
    *(f"r=radians(r)*{ROOT}", f"propeller_main=rpm/60*{ROOT}", *SHARED),
]
WAYS = {"advance": "advance, L", "tactical_diameter": "tactical diameter, L"}
FIGURES = WAYS | {
    "first_overshoot": "first overshoot, deg",
    "second_overshoot": "second overshoot, deg",
}


def with_names(files: list[Path], names: list[str], out: Path) -> list[Path]:
    """The tables of the files as CSV with those names, in the new folder `out`."""
    if not files:
        raise UserError("no test is there; name the folder data/01_raw")
    out.mkdir(parents=True)
    made = []
    for file in files:
        lines = (line.split() for line in file.read_text(encoding="latin-1").splitlines())
        rows = [cells for cells in lines if len(cells) == len(names)]
        made.append(out / f"{file.stem}.csv")
        with made[-1].open("w", encoding="utf-8", newline="") as stream:
            csv.writer(stream).writerows([names, *rows])
    return made


def start_file(path: Path, open_water: Path) -> Path:
    """The estimate of `boat new` with the particulars of the model and its propeller's open-water test."""
    content = boat_file("kvlcc2", "propeller-rudder", **SIZES)
    (thruster,) = content["thrusters"]
    advance, k_t = np.loadtxt(open_water, delimiter=",", skiprows=1, usecols=(0, 1)).T
    known = [(content, key, value) for key, value in PARTICULARS.items()]
    known += [(thruster, key, value) for key, value in THRUSTER.items()]
    known += [(thruster["propeller"], "diameter", DIAMETER), (thruster["rudder"], "area", RUDDER_AREA)]
    known += [(thruster["propeller"], "k_t", np.polyfit(advance, k_t, 2)[::-1].round(4).tolist())]
    for section, key, value in known:
        section[key] = {
            "value": value,
            "unit": section[key]["unit"],
            "provenance": "measured",
            "source": "SIMMAN 2008",
        }
    path.write_text(annotated(content, "KVLCC2, model 1 to 45.7."), encoding="utf-8")
    return path


def imported(logs: list[Path], boat: Path, out: Path, mapping: list[str], rate: float | None = None) -> Path:
    """The runs of the logs as the new dataset `out`."""
    reading = Reading(mapping_of(mapping))
    about = About(boat=str(boat), notes="KVLCC2, model 1 to 45.7, SIMMAN 2008")
    import_logs(logs, "csv", out, about, Wishes(resample=RESAMPLED, rate=rate), reading)
    return out


def transfer_table(runs: Path, start: Path, identified: Path) -> str:
    """Errors [m] on the other tank's tests by horizon."""
    boats = [load_boat(start), load_boat(identified)]
    run_set = read_run_set([runs], boats[0], start, [])
    rows = [
        [
            f"{was.horizon_s:g}",
            *(
                f"{error:.3f}"
                for error in (was.boat_file, now.boat_file, now.constant_velocity, now.no_thrust)
            ),
        ]
        for was, now in zip(*(errors_on(run_set, boat) for boat in boats), strict=True)
    ]
    return table(["horizon, s", "start", "identified", "constant velocity", "no thrust"], rows)


def figures_table(runs: Path, boat: Boat) -> str:
    """Figures of the measured tests, ways in lengths."""
    rows = []
    for run in read_dataset(runs).runs:
        figures = analyse_run(run, boat).figures
        values = [figures[name].value if name in figures else None for name in FIGURES]
        shown = ["" if value is None else f"{value:.1f}" for value in values[len(WAYS) :]]
        ways = ["" if value is None else f"{value / boat.length:.2f}" for value in values[: len(WAYS)]]
        rows.append([run.name.removeprefix("MARIN_FREE_KVLCC2_"), *ways, *shown])
    return table(["test", *FIGURES.values()], rows)


def causes_table(found: Diagnosis) -> str:
    """The causes that a diagnosis names, those that do not carry over, and what it does not distinguish."""
    rows = [
        [
            f"`{readable(cause.label)}`",
            ", ".join(estimate_words(one) for one in own.values()),
            share_text(cause, found),
        ]
        for cause in found.causes
        for _, own in parameter_sets(cause)
    ]
    lacking = carry_over_sentence(found) or "All causes carry over."
    lines = [f"The verdict is `{found.verdict}`. {lacking}"]
    lines += [
        f"Explanations that are not distinguished: {'; '.join(map(readable, names))}."
        for names in found.indistinguishable
    ]
    return "\n\n".join([*lines, table(["cause", "value ± standard error", "share"], rows)])


def main() -> None:
    """Write the page's tables."""
    source, out = source_and_out(__doc__)
    hsva = with_names(sorted((source / "kvlcc2_hsva" / "raw_data").glob("*.dat")), HSVA, out / "hsva_logs")
    marin = with_names(sorted((source / "kvlcc2").glob("*.dat")), MARIN, out / "marin_logs")
    start = start_file(out / "kvlcc2.yaml", source / "kvlcc2_hsva" / "open_water_characteristics.csv")
    as_logged = [one.replace("=-radians", "=radians") for one in OF_HSVA]
    doctor = doctor_lines(imported(hsva, start, out / "as_logged", as_logged))
    file = out / "identified.yaml"
    found = identify_boat(imported(hsva, start, out / "hsva", OF_HSVA), start, file)
    other = imported(marin, start, out / "marin", OF_MARIN, RATE)
    parts = {
        "doctor": doctor,
        "findings": findings(found),
        "errors": error_table(found),
        "numbers": number_table(found),
        "transfer": transfer_table(other, start, file),
        "figures": figures_table(other, found.boat),
        "causes": causes_table(diagnose(other, file, out / "diagnosis", twins=0)),
    }
    write_parts(DOCS / "kvlcc2.md", parts)
    print(f"identified in {found.elapsed:.0f} s", flush=True)


if __name__ == "__main__":
    main()

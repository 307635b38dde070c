"""Identify a Kingfisher M200 from its tests on a lake: the tables of docs/kingfisher.md.

    python -m benchmarks.boat_fit.kingfisher andy_thesis_code/Data/LakeTest_14FEB --out results/kingfisher

The measured data are not part of the project. Each .mat file of the source is one run of 60 to 120 s: time,
heading, speed and the commands of both thrusters at 10 Hz, and no position.
"""

import argparse
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat.estimate import annotated, boat_file
from swamp_rl.boat_fit.identify import errors_on, identify_boat
from swamp_rl.boat_fit.recent_thrust import recent_errors
from swamp_rl.boat_fit.report import gains_sentence, held_out_sentence, summary
from swamp_rl.boat_fit.result import Identification
from swamp_rl.criticism.report.evidence import TRIVIAL
from swamp_rl.errors import UserError
from swamp_rl.files import write_yaml
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes

SHOWN = 5.0  # s, horizon of the table by run
FIELDS = ("time", "kfhd", "kfspd", "portcmd", "stbdcmd")
PREDICTORS = ["identified with gains", "without gains", *(name.replace("_", " ") for name in TRIVIAL)]
SIZES = {"length": 1.35, "breadth": 0.98, "mass": 28.0, "thrust": 41.4, "top_speed": 1.6, "draught": 0.12}
"""The maker's sizes [m, kg], bollard pull [N] of `tcurve_nohead.csv` beside the data, top speed [m/s]."""
MAPPING = {
    "frame": "enu",
    "columns": {
        "time": "time",
        "x": "integral(kfspd * cos(radians(kfhd)))",
        "y": "integral(kfspd * sin(radians(kfhd)))",
        "yaw": "radians(kfhd)",
        "u": "kfspd",
        "throttle_port": "portcmd",
        "throttle_starboard": "stbdcmd",
    },
}
NOTES = "Kingfisher M200 on a lake, 14 February 2018; position by dead reckoning from speed and heading"


def tables_of(source: Path, folder: Path) -> list[Path]:
    """The runs as CSV files in the new folder."""
    from scipy.io import loadmat

    folder.mkdir(parents=True)
    made = []
    for path in sorted(source.glob("14FEB_LakeTest_Run*.mat")):
        held = loadmat(path, squeeze_me=True)
        rows = min(len(held[name]) for name in FIELDS)
        columns = np.column_stack([held[name][:rows] for name in FIELDS])
        made.append(folder / f"{path.stem}.csv")
        np.savetxt(made[-1], columns, "%.6g", ",", header=",".join(FIELDS), comments="")
    if not made:
        raise UserError(f"{source}: has no file 14FEB_LakeTest_Run*.mat; name the folder LakeTest_14FEB")
    return made


def identified(source: Path, out: Path) -> Identification:
    """From the .mat files to an identified boat, all in the new folder `out`."""
    logs = tables_of(source, out / "logs")
    boat = out / "kingfisher.yaml"
    boat.write_text(
        annotated(boat_file("kingfisher", "twin-fixed", **SIZES), "Kingfisher M200."), encoding="utf-8"
    )
    write_yaml(out / "mapping.yaml", MAPPING)
    mapping = mapping_of([str(out / "mapping.yaml")])
    import_logs(logs, "csv", out / "runs", About(boat=str(boat), notes=NOTES), Wishes(), Reading(mapping))
    return identify_boat(out / "runs", boat, out / "identified.yaml")


def error_table(found: Identification) -> str:
    """Errors [m] on the held-out runs by horizon."""
    rows = [
        [
            f"{was.horizon_s:g}",
            f"{was.boat_file:.3f}",
            f"{with_gains.boat_file:.3f}",
            f"{now.boat_file:.3f}",
            *(f"{getattr(now, name):.3f}" for name in TRIVIAL),
        ]
        for was, now, with_gains in zip(found.before, found.after, found.predicted, strict=True)
    ]
    return table(["horizon, s", "start", *PREDICTORS], rows)


def number_table(found: Identification) -> str:
    """The numbers that the runs show."""
    rows = [
        [
            f"`{one.number.name}`",
            f"{one.number.start:.3g}",
            f"{one.value:.3g}",
            f"{one.standard_error:.2g}",
            one.number.unit,
        ]
        for one in found.fitted
        if one.shown
    ]
    return table(["number", "start", "identified", "standard error", "unit"], rows)


def run_table(found: Identification) -> str:
    """Errors [m] at 5 s on each held-out run, and the span of its commands."""
    rows, held = [], found.data.held_out
    count = len(found.boat.thrusters)
    for i, (name, length) in enumerate(zip(held.names, held.lengths, strict=True)):
        run = held.subset([i])
        own = next(one for one in errors_on(run, found.boat) if one.horizon_s == SHOWN)
        recent = next(one for one in recent_errors(run, found.boat, found.gains) if one.horizon_s == SHOWN)
        levels = held.commands[i, :length, count:]
        spans = [f"{low:.2f} to {high:.2f}" for low, high in zip(levels.min(0), levels.max(0), strict=True)]
        errors = [recent.position, own.boat_file, *(getattr(own, trivial) for trivial in TRIVIAL)]
        rows.append([name.split(",")[0].split("_")[-1], *spans, *(f"{error:.2f}" for error in errors)])
    names = [f"throttle of {thruster.name}" for thruster in found.boat.thrusters]
    return table(["run", *names, *PREDICTORS], rows)


def findings(found: Identification) -> str:
    """What `identify boat` says, a line each."""
    return "\n".join(
        f"* {line}" for line in [*summary(found), held_out_sentence(found), gains_sentence(found)]
    )


def main() -> None:
    """Write the page's tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("source", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    asked = parser.parse_args()
    found = identified(asked.source, asked.out)
    parts = {
        "findings": findings(found),
        "errors": error_table(found),
        "by run": run_table(found),
        "numbers": number_table(found),
    }
    write_parts(DOCS / "kingfisher.md", parts)
    print(f"identified in {found.elapsed:.0f} s", flush=True)


if __name__ == "__main__":
    main()

"""Identify a Kingfisher M200 from its tests on a lake: the tables of docs/kingfisher.md.

    python -m benchmarks.boat_fit.kingfisher andy_thesis_code/Data/LakeTest_14FEB --out results/kingfisher

The measured data are not part of the project. Each .mat file of the source is one run of 60 to 120 s: time,
heading, speed and the commands of both thrusters at 10 Hz, and no position.
"""

from pathlib import Path

from benchmarks.boat_fit.arguments import source_and_out
from benchmarks.boat_fit.tables import error_table, findings, number_table, run_table
from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat.estimate import annotated, boat_file
from swamp_rl.boat_fit.identify import identify_boat
from swamp_rl.boat_fit.result import Identification
from swamp_rl.errors import UserError
from swamp_rl.files import write_yaml
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes

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


def identified(source: Path, out: Path) -> Identification:
    """From the .mat files to an identified boat, all in the new folder `out`."""
    logs = sorted(source.glob("14FEB_LakeTest_Run*.mat"))
    if not logs:
        raise UserError(f"{source}: has no file 14FEB_LakeTest_Run*.mat; name the folder LakeTest_14FEB")
    out.mkdir(parents=True)
    boat = out / "kingfisher.yaml"
    boat.write_text(
        annotated(boat_file("kingfisher", "twin-fixed", **SIZES), "Kingfisher M200."), encoding="utf-8"
    )
    write_yaml(out / "mapping.yaml", MAPPING)
    mapping = mapping_of([str(out / "mapping.yaml")])
    import_logs(logs, "matlab", out / "runs", About(boat=str(boat), notes=NOTES), Wishes(), Reading(mapping))
    return identify_boat(out / "runs", boat, out / "identified.yaml")


def main() -> None:
    """Write the page's tables."""
    source, out = source_and_out(__doc__)
    found = identified(source, out)
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

"""Identify the ferry milliAmpere1 from its tests in April 2025: the tables of docs/ferry.md.

    python -m benchmarks.boat_fit.ferry milliampere_data/physical_tests --out results/ferry

The measured data are not part of the project. Each folder of the source is one run, a bag of ROS 2 exported
as a CSV file for each topic.
"""

from pathlib import Path

from benchmarks.boat_fit.arguments import source_and_out
from benchmarks.boat_fit.tables import doctor_lines, error_table, findings, number_table, thrust_table
from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat.estimate import annotated, boat_file
from swamp_rl.boat_fit.identify import identify_boat
from swamp_rl.files import write_yaml
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes

RATE, FILL = 10.0, 0.6  # Hz and s of `--resample` and `--fill`
EARLIER = 0.9  # s, the latency that `runs doctor` finds
SIZES = {"length": 5.0, "breadth": 2.8, "mass": 1800.0, "thrust": 1600.0}
"""Sizes [m], mass [kg] and bollard pull [N] of all four thrusters, rounded."""
ASTERN, ASTERN_SD = 240.0, 120.0  # N, of each thruster at full throttle astern
ACTUATORS = {"bow_port": 1, "bow_starboard": 2, "stern_starboard": 3, "stern_port": 4}
NOTES = "milliAmpere1, Trondheim, 11 April 2025"


def mapping() -> dict[str, object]:
    """The mapping file: receiver, compass, measured azimuths and motor speeds as commands."""
    columns: dict[str, object] = {"time": "time"}
    columns |= {name: f"vectorVS330_fix.{name}" for name in ("latitude", "longitude")}
    columns |= {f"q{part}": f"vectorVS330_heading.quaternion_{part}" for part in "wxyz"}
    for name, number in ACTUATORS.items():
        actuator = f"actuators_actuator_{number}"
        columns[f"throttle_{name}"] = f"{actuator}_thruster_motor_state.motor_speed/1000"
        columns[f"azimuth_{name}"] = {"value": f"{actuator}_azimuth_angle.data", "unit": "deg"}
    return {"columns": columns}


def start_file(path: Path) -> Path:
    """The estimate of `boat new`, with thrusters that reverse."""
    content = boat_file("ferry", "four-azimuths", **SIZES)
    for thruster in content["thrusters"]:
        thruster["astern_quadratic"] |= {"value": ASTERN, "sd": ASTERN_SD}
        thruster["astern_linear"] |= {"sd": ASTERN_SD}
    path.write_text(annotated(content, "milliAmpere1."), encoding="utf-8")
    return path


def imported(source: Path, boat: Path, out: Path, earlier: float) -> Path:
    """The runs of the source's folders as the new dataset `out`."""
    reading = Reading(mapping_of([str(boat.with_name("mapping.yaml"))]), folders=True)
    wishes = Wishes(resample=RATE, bad_rows="split", fill=FILL, earlier=earlier)
    import_logs(sorted(source.iterdir()), "csv", out, About(boat=str(boat), notes=NOTES), wishes, reading)
    return out


def main() -> None:
    """Write the page's tables."""
    source, out = source_and_out(__doc__)
    out.mkdir(parents=True)
    boat = start_file(out / "ferry.yaml")
    write_yaml(out / "mapping.yaml", mapping())
    doctor = doctor_lines(imported(source, boat, out / "as_logged", 0.0))
    found = identify_boat(imported(source, boat, out / "runs", EARLIER), boat, out / "identified.yaml")
    parts = {
        "doctor": doctor,
        "findings": findings(found),
        "errors": error_table(found),
        "thrust": thrust_table(found),
        "numbers": number_table(found),
    }
    write_parts(DOCS / "ferry.md", parts)
    print(f"identified in {found.elapsed:.0f} s", flush=True)


if __name__ == "__main__":
    main()

"""Identify a BlueBoat from its tests on a lake: the tables of docs/blueboat.md.

    python -m benchmarks.boat_fit.blueboat BlueBoatSystemIdentification/sorted_data --out results/blueboat

The measured data are not part of the project. Each table is one run at 10 Hz, as the autopilot estimated it,
with the pulse widths of both thrusters.
"""

from pathlib import Path

from benchmarks.boat_fit.arguments import source_and_out
from benchmarks.boat_fit.tables import doctor_lines, error_table, findings, number_table
from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import load_boat
from swamp_rl.boat.estimate import annotated, boat_file
from swamp_rl.boat_fit.identify import identify_boat
from swamp_rl.criticism.diagnose import diagnose
from swamp_rl.criticism.report.extension import extension_sentence
from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes

SIZES = {"length": 1.2, "breadth": 0.93, "mass": 15.0, "thrust": 105.0, "demihull": 0.2}
"""The maker's sizes [m]; mass [kg] of the authors; bollard pull [N] of two thrusters at 16 V; each hull's
breadth [m] is an estimate from photographs."""
SHARED = [
    *("time=original_timestamp/1000", "latitude=lat", "longitude=lon", "heading=radians(yaw)"),
    *("u=surge", "v=sway", "yaw_rate=yaw_rate"),
]
AHEAD = ["clip((1510-thr_left)/400,-1,1)", "clip((thr_right-1510)/400,-1,1)"]
SIDES = ["port", "starboard"]


def imported(source: Path, boat: Path, out: Path, sides: list[str], earlier: float = 0.0) -> Path:
    """The runs of the source as the new dataset `out`; sides: those of the left and the right thruster."""
    logs = sorted(source.glob("fixed_*.csv"))
    if not logs:
        raise UserError(f"{source}: has no file fixed_*.csv; name the folder sorted_data")
    throttles = [f"throttle_{side}={expression}" for side, expression in zip(sides, AHEAD, strict=True)]
    reading = Reading(mapping_of([*SHARED, *throttles]))
    about = About(boat=str(boat), notes="BlueBoat, Trondheim, repository of October 2024")
    import_logs(logs, "csv", out, about, Wishes(bad_rows="cut", earlier=earlier), reading)
    return out


def main() -> None:
    """Write the page's tables."""
    source, out = source_and_out(__doc__)
    out.mkdir(parents=True)
    boat, file = out / "blueboat.yaml", out / "identified.yaml"
    boat.write_text(annotated(boat_file("blueboat", "twin-fixed", **SIZES), "BlueBoat."), encoding="utf-8")
    doctor = doctor_lines(imported(source, boat, out / "as_named", SIDES))
    runs = imported(source, boat, out / "runs", SIDES[::-1])
    found = identify_boat(runs, boat, file)
    earlier = imported(source, boat, out / "earlier", SIDES[::-1], found.wiring.advance)
    left = diagnose(earlier, file, out / "diagnosis")
    lines = [f"verdict `{left.verdict}`", extension_sentence(left, load_boat(file)), *left.next_steps]
    parts = {
        "doctor": doctor,
        "findings": findings(found),
        "errors": error_table(found),
        "numbers": number_table(found),
        "diagnosis": "\n".join(f"* {line}" for line in lines if line),
    }
    write_parts(DOCS / "blueboat.md", parts)
    print(f"identified in {found.elapsed:.0f} s", flush=True)


if __name__ == "__main__":
    main()

"""Follow the shipped paths, and draw an eight and a capability plot: docs/following.md.

python -m benchmarks.guidance.paths
"""

import json
import math
import shutil
import tempfile
from pathlib import Path
from typing import Any

from swamp_rl.experiments.reports.capability import write_capability
from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.reports.guidance import follow_path, hold_station

from benchmarks.markers import DOCS, write_parts
from swamp_rl.errors import UserError

PATHS = ("eight", "river", "lawn_mower")
BOATS = ("swamp", "esso_osaka")
SEAS: dict[str, list[dict[str, Any]]] = {
    "calm": [],
    "current 0.2 m/s": [{"effect": "current", "north": 0.0, "east": 0.2}],
    "wind 6 m/s": [{"effect": "wind", "speed": 6.0, "from": 0.5 * math.pi}],
}


def path_table(folder: Path) -> str:
    """Cross-track errors and energy of SWAMP on each path in each sea."""
    rows = []
    for name in PATHS:
        for sea, effects in SEAS.items():
            follow_path(folder / "path", name, "swamp", None, effects, 0)
            data = json.loads((folder / "path/analysis/result.json").read_text())
            errors = [f"{value:.2f}" for value in data["cross_track_error"].values()]
            rows.append([name, sea, *errors, f"{data['mean_speed']:.2f}", f"{data['electric_energy']:.0f}"])
            if (name, sea) == ("eight", "current 0.2 m/s"):
                shutil.copy(folder / "path/analysis/track.png", DOCS / "eight_path.png")
    head = ["path", "sea", "mean, m", "rms, m", "95 %, m", "max, m", "mean speed, m/s", "energy, J"]
    return table(head, rows)


def station_table(folder: Path) -> str:
    """Distance from the station of SWAMP and of the tanker in current and wind, and in gusts."""
    rows = []
    for boat in BOATS:
        for sea in ("current 0.2 m/s", "wind 6 m/s"):
            try:
                hold_station(folder / "station", boat, 240.0, None, [], None, SEAS[sea], 0)
            except UserError:
                rows.append([boat, sea, "refused", *"––––"])
                continue
            data = json.loads((folder / "station/analysis/result.json").read_text())
            rows.append([boat, sea, data["keeper"], *(f"{e:.2f}" for e in data["distance"].values())])
    return table(["boat", "sea", "controller", "mean, m", "rms, m", "95 %, m", "max, m"], rows)


def capability_table(folder: Path) -> str:
    """The strongest current and wind from ahead, from 45 degrees off the bow and abeam."""
    rows = []
    for boat, failed in (("swamp", []), ("swamp", ["bs"]), ("esso_osaka", [])):
        write_capability(folder / "capability", boat, 0.0, 0.0, failed)
        data = json.loads((folder / "capability/capability.json").read_text())
        at = [data["direction"].index(direction) for direction in (0.0, 40.0, 90.0)]
        cells = [f"{data[what][i]:.2f}" for what in ("current", "wind") for i in at]
        rows.append([boat + (f" without {failed[0]}" if failed else ""), *cells])
        if boat == "swamp" and not failed:
            shutil.copy(folder / "capability/capability.png", DOCS / "capability.png")
    head = [f"{what} from {angle}°, m/s" for what in ("current", "wind") for angle in (0, 40, 90)]
    return table(["boat", *head], rows)


def main() -> None:
    """Write the tables and the figures."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        parts = {
            "paths": path_table(folder),
            "stations": station_table(folder),
            "capabilities": capability_table(folder),
        }
    write_parts(DOCS / "following.md", parts)


if __name__ == "__main__":
    main()

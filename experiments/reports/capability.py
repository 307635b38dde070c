"""A boat's capability plot, as CSV and JSON besides."""

import json
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.guidance_figures import draw_capability
from swamp_rl.experiments.reports.rows import write_rows

from swamp_rl.boat import load_boat
from swamp_rl.guidance.capability import capability
from swamp_rl.guidance.holding import RESERVE
from swamp_rl.guidance.keep import drive_without
from swamp_rl.guidance.weathervane import pushes_sideways
from swamp_rl.unfinished import folder_beside

DATA = "capability.json"


def write_capability(out: Path, boat_name: str, wind: float, current: float, failed: list[str]) -> list[str]:
    """Work out the plot and write the folder; lines to print."""
    boat = load_boat(boat_name)
    drive = drive_without(boat, failed)
    with folder_beside(out, replaces=DATA) as part:
        found = capability(boat, drive, wind, current)
        degrees = np.round(np.degrees(found.direction), 6)
        content = {
            "boat": boat.name,
            "failed": failed,
            "reserve": RESERVE,
            "units": {
                "direction": "relative direction of the weather [deg]",
                "current": "m/s",
                "wind": "m/s",
            },
            "wind_beside": wind,
            "current_beside": current,
            "direction": degrees.tolist(),
            "current": found.current.tolist(),
            "wind": found.wind.tolist(),
        }
        (part / DATA).write_text(json.dumps(content, indent=1, allow_nan=False), encoding="utf-8")
        rows = np.stack([degrees, found.current, found.wind], axis=1)
        write_rows(part / "capability.csv", ["direction_deg", "current", "wind"], rows)
        without = f" without {', '.join(failed)}" if failed else ""
        draw_capability(part / "capability.png", found, f"Capability of {boat.name}{without}")
    lines = [
        f"{name} [m/s]: from ahead {'at least ' * bool(values[0] >= most)}{values[0]:.2f}, least "
        f"{values.min():.2f} from {degrees[values.argmin()]:.0f} deg"
        for name, values, most in zip(
            ("current", "wind"), (found.current, found.wind), found.most, strict=True
        )
    ]
    if not pushes_sideways(drive):
        lines.append("the drive has no sway force: it holds only what comes from straight ahead or astern")
    return lines

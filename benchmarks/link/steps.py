"""What the thesis's three readings of the azimuth's encoder make of its example: the table of docs/link.md.

python -m benchmarks.link.steps
"""

import math

from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.link.module import GEAR
from swamp_rl.runs.thruster_telemetry import STEPS_PER_TURN, azimuth_angle

EXAMPLE_STEPS, EXAMPLE_ANGLE = 41_284, 45.0
"""Of `1004 1 41284` in 6.2, and the degrees that its comment calls them."""
ENCODER = 4096
"""Steps of the azimuth's motor in a turn (6.1)."""
READINGS = {
    "table 5.5 and section 7.2, used here": float(STEPS_PER_TURN),
    f"section 6.1, {ENCODER} steps times the gear, {GEAR}": float(ENCODER * GEAR),
    f'the example in 6.2, "{EXAMPLE_ANGLE:g} deg"': EXAMPLE_STEPS * 360.0 / EXAMPLE_ANGLE,
}


def example_angle(steps_per_turn: float) -> float:
    """Degrees of the example's reference."""
    return math.degrees(azimuth_angle(EXAMPLE_STEPS, steps_per_turn))


def main() -> None:
    """Write the table."""
    rows = [[name, f"{steps:,.0f}", f"{example_angle(steps):.2f}°"] for name, steps in READINGS.items()]
    head = ["source", "steps per turn", f"{EXAMPLE_STEPS:,} steps"]
    write_parts(DOCS / "link.md", {"steps": table(head, rows)})


if __name__ == "__main__":
    main()

"""Strike the two computers with each fault of thesis 6.5: the table and the figure of docs/link.md.

python -m benchmarks.link.redundancy
"""

from pathlib import Path

from swamp_rl.experiments.reports.experiment import table

from benchmarks.link.faults import FAULTS, Array, Outcome, most_of, outcome_of
from benchmarks.markers import DOCS, write_parts
from swamp_rl.allocation import force_region, jets_of
from swamp_rl.boat import load_boat
from swamp_rl.figure_style import sheet
from swamp_rl.link.network import Faults

LOSSY = Faults(loss=0.2, doubled=0.1, delay=(0.0, 0.03))
SEEDS = range(4)
DIRECTIONS = 72
LEFT = {
    "all four": (),
    "one dead": ("bs",),
    "both at the bow dead": ("bs", "bp"),
    "a diagonal dead": ("bs", "sp"),
    "a hull dead": ("bs", "ss"),
}
"""Thrusters that are dead, by what the figure calls it."""
COLOURS = dict(zip(LEFT, ("tab:gray", "tab:blue", "tab:green", "tab:orange", "tab:red"), strict=True))
BOAT = "swamp"


def rows() -> list[list[str]]:
    """A row for each fault; times of the perfect network, and the longest of the lossy ones."""
    boat = load_boat(BOAT)
    intact = intact_forces()
    found = []
    for fault in FAULTS:
        clean = outcome_of(fault, boat)
        lossy = [outcome_of(fault, boat, LOSSY, seed) for seed in SEEDS]
        found.append(
            [
                fault.name,
                fault.consequence or "–",
                commanders(clean),
                clean.gps or "none",
                f"{clean.commanded:.2f} / {max(one.commanded for one in lossy):.2f}",
                f"{clean.reached:.2f} / {max(one.reached for one in lossy):.2f}",
                *(f"{100 * share:.0f} %" for share in clean.most / intact),
            ]
        )
    return found


def intact_forces() -> Array:
    """(3,) greatest surge, sway force [N] and yaw moment [N m] of the intact boat."""
    return most_of(jets_of(load_boat(BOAT)))


def commanders(outcome: Outcome) -> str:
    """Whose computer commands the jets that work."""
    return " and ".join(sorted({hull for hull in outcome.commander if hull is not None}, reverse=True))


def draw(path: Path) -> None:
    """Surge and sway force that the jets hold without a yaw moment, after each fault that takes jets."""
    jets = jets_of(load_boat(BOAT))
    with sheet(path, 5.2, 4.2) as figure:
        axes = figure.add_subplot(xlabel="sway force, N", ylabel="surge force, N", aspect="equal")
        for label, dead in LEFT.items():
            border = force_region(jets.without(dead), directions=DIRECTIONS)
            axes.fill(border[:, 1], border[:, 0], fill=False, edgecolor=COLOURS[label], label=label)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


def main() -> None:
    """Write the table."""
    draw(DOCS / "link_forces.png")
    head = ["fault", "thesis 6.5", "computer", "GPS", "commanded, s", "reached, s", "surge", "sway", "yaw"]
    surge, sway, yaw = intact_forces()
    message = f"Shares of the intact boat's {surge:.1f} N, {sway:.1f} N and {yaw:.1f} N m."
    write_parts(DOCS / "link.md", {"redundancy": f"{table(head, rows())}\n\n{message}"})


if __name__ == "__main__":
    main()

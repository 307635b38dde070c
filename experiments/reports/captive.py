"""Captive trials as a CSV of every run, tables for people and JSON for programmes."""

import csv
import json
import math
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from swamp_rl.experiments.reports.captive_figures import draw_bollard, draw_towed
from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.reports.trials import JSON, REPORT

from swamp_rl.boat import Boat
from swamp_rl.clipped import in_markdown
from swamp_rl.manoeuvres.captive import Point, self_propulsion
from swamp_rl.runs.schema import ANALYSIS
from swamp_rl.unfinished import folder_beside

DATA = "captive.csv"
COLUMNS = {  # of the CSV: unit of each
    "thrusters": "",
    "throttle": "1",
    "speed": "m/s",
    "resistance": "N",
    "towing_force": "N",
    "thrust": "N",
    "bollard_thrust": "N",
    "thrust_factor": "1",
    "side_force": "N",
    "yaw_moment": "N m",
}
DRAWINGS = {"bollard": ("bollard_pull.png", draw_bollard), "towed": ("towed.png", draw_towed)}
Balance = dict[tuple[tuple[str, ...], float], float]


def write_captive(out: Path, kind: str, boat: Boat, points: Sequence[Point], astern: bool) -> list[str]:
    """Write the trial `kind` into `out`, its figures into OUT/analysis, all or nothing; lines to print.

    UserError where `out` holds something else.
    """
    balance: Balance = {}
    if kind == "towed":
        pairs = dict.fromkeys((one.thrusters, one.speed) for one in points)
        balance = {(names, speed): self_propulsion(boat, speed, names, astern) for names, speed in pairs}
    picture, draw = DRAWINGS[kind]
    with folder_beside(out, replaces=DATA) as part:
        write_csv(part / DATA, points)
        folder = part / ANALYSIS
        folder.mkdir()
        draw(folder / picture, boat.name, points)
        (folder / JSON).write_text(as_json(kind, boat, points, balance, astern), encoding="utf-8")
        text = report(kind, boat, points, balance, astern, picture)
        (folder / REPORT).write_text(text, encoding="utf-8")
    return lines(kind, points, balance)


def row_of(point: Point) -> dict[str, Any]:
    """A run by column; None for what has no value."""
    row = {name: getattr(point, name) for name in COLUMNS} | {"thrusters": "+".join(point.thrusters)}
    return row | {"thrust_factor": point.thrust_factor if math.isfinite(point.thrust_factor) else None}


def write_csv(path: Path, points: Sequence[Point]) -> None:
    """One row a run; units as in `COLUMNS`, thrusters joined by +."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(COLUMNS))
        writer.writeheader()
        writer.writerows(row_of(point) for point in points)


def as_json(kind: str, boat: Boat, points: Sequence[Point], balance: Balance, astern: bool) -> str:
    """Every run and, for a towed trial, the throttle of each self-propulsion point."""
    content = {
        "trial": kind,
        "boat": boat.name,
        "length": boat.length,
        "water_density": boat.water_density,
        "source": "simulated",
        "astern": astern,
        "units": COLUMNS,
        "points": [row_of(point) for point in points],
        "self_propulsion": [
            {"thrusters": "+".join(names), "speed": speed, "throttle": None if math.isnan(level) else level}
            for (names, speed), level in balance.items()
        ],
    }
    return json.dumps(content, indent=1, allow_nan=False)


def report(
    kind: str, boat: Boat, points: Sequence[Point], balance: Balance, astern: bool, picture: str
) -> str:
    """The Markdown report."""
    way = ", pushing astern" if astern else ""
    opening = (
        f"# {'Bollard pull' if kind == 'bollard' else 'Towed trial'} of {in_markdown(boat.name)}{way}\n\n"
        f"{len(points)} captive runs, simulated, in still water of {boat.water_density:g} kg/m3. "
    )
    if kind == "bollard":
        opening += (
            "Pull on the line at rest; the thrusters' own thrust is that of the boat file's curve, without "
            "deduction."
        )
    else:
        opening += (
            "The carriage tows at the speed with the force F_D; R is the hull's resistance, "
            "1 - t = (R - F_D) / T_bollard (thesis eq. 7.1), T_bollard the thrusters' own thrust at rest."
        )
    head, cells = (BOLLARD_HEAD, bollard_cells) if kind == "bollard" else (TOWED_HEAD, towed_cells)
    parts = [opening, table(head, [cells(point) for point in points])]
    if balance:
        rows = [[", ".join(names), f"{speed:g}", percent(level)] for (names, speed), level in balance.items()]
        head = ["thrusters", "speed, m/s", "throttle without towing force, %"]
        parts.append("## Self-propulsion point\n\n" + table(head, rows))
    return "\n\n".join([*parts, f"![{picture}]({picture})"]) + "\n"


BOLLARD_HEAD = ["thrusters", "throttle, %", "pull, N", "own thrust, N", "pull / own", "yaw moment, N m"]
TOWED_HEAD = [
    "thrusters",
    "speed, m/s",
    "throttle, %",
    "R, N",
    "F_D, N",
    "R - F_D, N",
    "T_bollard, N",
    "1 - t",
]


def bollard_cells(point: Point) -> list[str]:
    """A row of the bollard table."""
    return [
        ", ".join(point.thrusters),
        percent(point.throttle),
        f"{point.thrust:.2f}",
        f"{point.bollard_thrust:.2f}",
        factor(point),
        f"{point.yaw_moment:.2f}",
    ]


def towed_cells(point: Point) -> list[str]:
    """A row of the towed table."""
    forces = (point.resistance, point.towing_force, point.thrust, point.bollard_thrust)
    return [
        ", ".join(point.thrusters),
        f"{point.speed:g}",
        percent(point.throttle),
        *(f"{force:.2f}" for force in forces),
        factor(point),
    ]


def percent(throttle: float) -> str:
    """A throttle for a table; a dash where full throttle is too little."""
    return "–" if math.isnan(throttle) else f"{100.0 * throttle:.3g}"


def factor(point: Point) -> str:
    """1 - t for a table; a dash without thrust."""
    return f"{point.thrust_factor:.3f}" if math.isfinite(point.thrust_factor) else "–"


def lines(kind: str, points: Sequence[Point], balance: Balance) -> list[str]:
    """What the command line prints: a line for each set of thrusters, and speed."""
    found = []
    for (names, speed), group in groupby(points, key=lambda one: (one.thrusters, one.speed)):
        some, who = list(group), ", ".join(names)
        if kind == "bollard":
            each = [f"{percent(one.throttle)} % {one.thrust:.2f}" for one in some]
            found.append(f"{who}: pull in N at {', '.join(each)}")
            continue
        each = [f"{percent(one.throttle)} % {factor(one)}" for one in some]
        level = balance[names, speed]
        needs = "beyond full throttle" if math.isnan(level) else f"at {percent(level)} %"
        found.append(f"{who} at {speed:g} m/s: 1 - t at {', '.join(each)}; no towing force {needs}")
    return found

"""A flown mission as a report for people, JSON and CSV for programmes, and a figure."""

import json
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.reports.mission_figures import draw_mission
from swamp_rl.experiments.reports.rows import write_rows

from swamp_rl.clipped import in_markdown
from swamp_rl.energy.figures import leg_figures, summary
from swamp_rl.energy.fly import STEP, Flight
from swamp_rl.energy.power import pack_names
from swamp_rl.simulator.state import EAST, HEADING, NORTH
from swamp_rl.unfinished import folder_beside

DATA, REPORT, ROWS, PICTURE = "mission.json", "report.md", "mission.csv", "mission.png"
EVERY = 1.0  # s between two rows of the CSV
UNITS = {
    "time": "s",
    "distance": "m",
    "energy": "J",
    "energy_per_metre": "J/m",
    "charge": "1",
    "voltage": "V",
    "current_max": "A",
    "seconds_above_continuous_current": "s",
    "range_left": "m",
    "emptied": "s",
    "depth": "m",
    "draught": "m",
    "squat": "m",
    "speed": "m/s",
    "power": "W",
    "thruster_power": "W",
    "duration": "s",
}
WATT_HOUR = 3600.0  # J


def write_mission(out: Path, flight: Flight) -> None:
    """Write report, figure, JSON and CSV into the folder `out`, all or nothing; UserError where it holds
    something else."""
    with folder_beside(out, replaces=DATA) as part:
        (part / DATA).write_text(as_json(flight), encoding="utf-8")
        write_track(part / ROWS, flight)
        draw_mission(part / PICTURE, flight)
        (part / REPORT).write_text(report(flight), encoding="utf-8")


def as_json(flight: Flight) -> str:
    """The figures of the whole and of each leg; `mission` holds the file as it was read."""
    legs = [
        {
            "number": leg.number,
            "asked_speed": leg.asked,
            "speed": leg.speed,
            "duration": leg.duration,
            "distance": leg.distance,
            "power": leg.power.tolist(),
            "thruster_power": dict(zip(flight.boat.thruster_names, leg.thrusters.tolist(), strict=True)),
            "energy": leg.energy.tolist(),
            "charge": leg.charge.tolist(),
        }
        for leg in leg_figures(flight)
    ]
    content = {
        "boat": flight.boat.name,
        "source": "simulated",
        "packs": pack_names(flight.boat),
        "units": UNITS,
        **summary(flight),
        "legs": legs,
        "mission": flight.mission.model_dump(mode="json", exclude_none=True),
    }
    return json.dumps(content, indent=1, allow_nan=False)


def write_track(path: Path, flight: Flight) -> None:
    """A row every `EVERY` s: time, leg, pose, speed; power, current, voltage and charge of each pack; power
    of each thruster.

    Power and current are those of the step that ends at the row.
    """
    names, packs = pack_names(flight.boat), flight.packs
    head = ["time", "leg", "north", "east", "heading", "speed"]
    head += [f"{what}_{name}" for name in names for what in ("power", "current", "voltage", "charge")]
    at = np.arange(0, len(flight.states), round(EVERY / STEP))
    before = np.maximum(at - 1, 0)
    columns = [flight.time[at], flight.leg[before], *flight.states[at][:, [NORTH, EAST, HEADING]].T]
    head += [f"thruster_power_{name}" for name in flight.boat.thruster_names]
    columns.append(flight.speed[at])
    for k in range(len(names)):
        columns += [packs.power[before, k], packs.current[before, k]]
        columns += [packs.voltage[at, k], packs.charge[at, k]]
    columns += list(flight.thrusters[before].T)
    write_rows(path, head, zip(*columns, strict=True))


def report(flight: Flight) -> str:
    """The Markdown report."""
    names, found = pack_names(flight.boat), summary(flight)
    head = ["leg", "speed asked, m/s", "made, m/s", "min", "m"]
    head += [f"{what}, {name}" for name in names for what in ("W", "Wh", "charge at the end")]
    rows = []
    for leg in leg_figures(flight):
        cells = [str(leg.number), f"{leg.asked:g}", f"{leg.speed:.3f}", f"{leg.duration / 60.0:.1f}"]
        cells.append(f"{leg.distance:.0f}")
        for k in range(len(names)):
            cells += [f"{leg.power[k]:.1f}", f"{leg.energy[k] / WATT_HOUR:.1f}", f"{leg.charge[k]:.3f}"]
        rows.append(cells)
    early = _ended_early(flight)
    ended = f"\n\n**{early}**" if early else ""
    return (
        f"# Mission {in_markdown(flight.mission.name)} of {in_markdown(flight.boat.name)}\n\n"
        f"Simulated. {in_markdown(flight.mission.description)}"
        f"{ended}\n\n"
        + "\n".join(f"* {in_markdown(line)}" for line in lines(flight))
        + "\n\n"
        + table(head, rows)
        + "\n\n"
        f"Greatest current of a pack: {max(found['current_max']):.2f} A. ![{PICTURE}]({PICTURE})\n"
    )


def _ended_early(flight: Flight) -> str:
    """Why and where the mission ended before its last leg; empty where it did not."""
    if flight.aground is not None:
        return f"{flight.aground}: the rest was not sailed"
    if flight.emptied is None:
        return ""
    return (
        f"A pack was empty after {flight.emptied:.0f} s and {flight.way[-1]:.0f} m, in "
        f"legs.{flight.leg[-1]}: the rest was not sailed"
    )


def lines(flight: Flight) -> list[str]:
    """What the command line prints."""
    found = summary(flight)
    energy = ", ".join(f"{name} {joule / WATT_HOUR:.1f}" for name, joule in _packs(flight, "energy"))
    charge = ", ".join(f"{name} {left:.3f}" for name, left in _packs(flight, "charge"))
    entries = [
        f"{found['time'] / 60.0:.1f} min, {found['distance']:.0f} m, {found['energy_per_metre']:.1f} J/m",
        f"energy in Wh: {energy}",
        f"state of charge at the end: {charge}",
    ]
    if early := _ended_early(flight):
        return [*entries, early]
    above = found["seconds_above_continuous_current"]
    if above > 0.0:
        entries.append(f"a pack gives more than its continuous current for {above:.0f} s")
    if found["range_left"] is not None:
        entries.append(f"range left above the reserve: {found['range_left']:.0f} m")
    return entries


def _packs(flight: Flight, key: str) -> list[tuple[str, float]]:
    return list(zip(pack_names(flight.boat), np.array(summary(flight)[key]).tolist(), strict=True))

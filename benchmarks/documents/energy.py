"""Measured parts of docs/energy.md and its picture.

python -m benchmarks.documents.energy
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from benchmarks.validation.energy import (
    DESIGN,
    FINAL_CHARGE,
    MISSIONS,
    PRINTED_POWER,
    SPEEDS,
    USERS,
    charge_by_the_tables_rule,
    fitted_power,
    flown,
    propulsion_power,
    watt_hours,
)
from swamp_rl.boat import Boat, load_boat
from swamp_rl.energy.best_range import best_range_speed, energy_per_metre_at
from swamp_rl.errors import UserError
from swamp_rl.figure_style import sheet
from swamp_rl.files import write_beside
from swamp_rl.simulator.reference import reference_of

PICTURE = "energy.png"
COLOURS = {DESIGN: "#2b6ca3", "swamp": "#c0562f", "swamp-light": "#5b8c3a"}


def power_table() -> str:
    """Power of one hull's jets at the speeds of table 6.3."""
    rows = [
        [f"{speed:g}", f"{printed:.0f}", *cells(speed, propulsion_power)]
        for speed, printed in zip(SPEEDS, PRINTED_POWER, strict=True)
    ]
    return table(["speed, m/s", "printed, W", *(f"{name}, W" for name in COLOURS)], rows)


def range_table() -> str:
    """Energy per metre of both hulls, and the speed at which it is least."""
    rows = [
        [f"{speed:g} m/s", f"{2.0 * (power + USERS) / speed:.0f}", *cells(speed, energy_per_metre_at)]
        for speed, power in zip(SPEEDS, PRINTED_POWER, strict=True)
    ]
    best = [f"{best_range_speed(load_boat(name)):.2f}" for name in COLOURS]
    return table(["J/m", "printed", *COLOURS], [*rows, ["least at, m/s", "1.0", *best]])


def cells(speed: float, of: Callable[[Boat, float], float]) -> list[str]:
    """A number of each boat at a speed, a dash where the boat cannot reach it."""
    found = []
    for name in COLOURS:
        try:
            found.append(f"{of(load_boat(name), speed):.0f}")
        except UserError:
            found.append("–")
    return found


def mission_table() -> str:
    """Energy and final charge of the three missions, flown."""
    head = ["mission", "printed, Wh", "simulated, Wh", "difference"]
    head += ["printed charge", "simulated", "by the table's rule"]
    rows = []
    for name, printed in MISSIONS.items():
        flight = flown(name)
        energy = watt_hours(flight)
        charges = (float(flight.packs.charge[-1].mean()), charge_by_the_tables_rule(flight))
        off = f"{100.0 * (energy / printed - 1.0):+.1f} %"
        row = [f"`{name}`", f"{printed:.0f}", f"{energy:.1f}", off, f"{FINAL_CHARGE:g}"]
        rows.append([*row, *(f"{charge:.3f}" for charge in charges)])
    return table(head, rows)


def draw(path: Path) -> None:
    """Write a PNG: energy per metre against the speed, and the charge over the three missions."""
    with sheet(path, 9.0, 3.8) as canvas:
        metre, charge = canvas.subplots(1, 2)
        for name, colour in COLOURS.items():
            boat = load_boat(name)
            speeds = np.linspace(0.35, 0.995 * reference_of(boat).speed, 40)
            values = [energy_per_metre_at(boat, float(speed)) for speed in speeds]
            metre.plot(speeds, values, color=colour, lw=1.4, label=name)
        printed = [2.0 * (power + USERS) / speed for power, speed in zip(PRINTED_POWER, SPEEDS, strict=True)]
        metre.plot(SPEEDS, printed, "o", color="black", ms=5, label="thesis, table 6.3")
        metre.set(xlabel="speed [m/s]", ylabel="both hulls [J/m]", ylim=(0.0, None))
        metre.legend()
        for name, style in zip(MISSIONS, ("-", "--", ":"), strict=True):
            flight = flown(name)
            minutes, left = flight.time[::60] / 60.0, flight.packs.charge[::60, 0]
            charge.plot(minutes, left, style, color="#2b6ca3", label=f"mission {name[-1]}")
        charge.axhline(FINAL_CHARGE, color="black", lw=0.8, label="printed at the end")
        charge.set(xlabel="time [min]", ylabel="state of charge [1]", ylim=(0.0, 1.0))
        charge.legend()


def main() -> None:
    """Write the tables and the picture."""
    idle, coefficient = fitted_power()
    fit = table(["P_0, W", "k, W/N^1.5"], [[f"{idle:.3f}", f"{coefficient:.4f}"]])
    parts = {"fit": fit, "power": power_table(), "range": range_table(), "missions": mission_table()}
    write_parts(DOCS / "energy.md", parts)
    with write_beside(DOCS / PICTURE) as part:
        draw(part)


if __name__ == "__main__":
    main()

"""The picture of a flown mission: speed, power, current and charge over time."""

from pathlib import Path

import numpy as np

from swamp_rl.energy.fly import Flight, reserve_of
from swamp_rl.energy.power import pack_names
from swamp_rl.figure_style import sheet

COLOURS, STYLES = ("#2b6ca3", "#c0562f"), ("-", "--")
MOST = 4000  # points of a curve


def draw_mission(path: Path, flight: Flight) -> None:
    """Write a PNG: one row for each quantity, a curve for each pack, a line where a leg begins."""
    packs, every = flight.packs, max(1, len(flight.leg) // MOST)
    minutes = flight.time / 60.0
    with sheet(path, 7.2, 7.2) as canvas:
        speed, power, current, charge = canvas.subplots(4, 1, sharex=True)
        speed.plot(minutes[::every], flight.speed[::every], color="#444444", lw=1.2)
        for k, name in enumerate(pack_names(flight.boat)):
            style = {"color": COLOURS[k], "ls": STYLES[k], "lw": 1.3, "label": name}
            power.plot(minutes[1::every], packs.power[::every, k], **style)
            current.plot(minutes[1::every], packs.current[::every, k], **style)
            charge.plot(minutes[::every], packs.charge[::every, k], **style)
        charge.axhline(reserve_of(flight.boat, flight.mission), color="#888888", lw=0.8)
        for axes in (speed, power, current, charge):
            for start in np.flatnonzero(np.diff(flight.leg)) + 1:
                axes.axvline(minutes[start], color="#cccccc", lw=0.8)
            axes.set_ylim(bottom=0.0)
        speed.set(ylabel="speed [m/s]")
        power.set(ylabel="power [W]")
        current.set(ylabel="current [A]")
        charge.set(ylabel="state of charge [1]", xlabel="time [min]", ylim=(0.0, 1.0))
        power.legend(loc="best")
        canvas.suptitle(f"Mission {flight.mission.name} of {flight.boat.name}", fontweight="bold")

"""Pictures of a followed path, a held station and a boat's capability."""

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.figure_style import sheet
from swamp_rl.guidance.capability import Capability
from swamp_rl.guidance.curve import Curve
from swamp_rl.guidance.flight import Flight
from swamp_rl.simulator.state import EAST, NORTH

Array = NDArray[np.float64]

PATH, BOAT = "#9aa4ad", "#2b6ca3"
OTHER = "#c0562f"
LEAST_LENGTHS, LEAST_TURN = 0.01, 1.0  # lengths of the boat, deg: an axis reaches at least so far


def draw_track(path: Path, flight: Flight, curve: Curve, across: Array, title: str) -> None:
    """Write a PNG: the path and the track from above; cross-track error over time."""
    with sheet(path, 7.2, 7.2) as canvas:
        above, error = canvas.subplots(2, 1, height_ratios=(3, 1))
        above.plot(curve.places[:, 1], curve.places[:, 0], color=PATH, lw=3.0, label="path")
        above.plot(flight.track[:, EAST], flight.track[:, NORTH], color=BOAT, lw=1.2, label="boat")
        above.set(xlabel="east [m]", ylabel="north [m]", aspect="equal")
        above.legend(loc="best")
        error.plot(flight.time, across, color=BOAT, lw=1.0)
        reach_at_least(error, LEAST_LENGTHS * flight.boat.length)
        error.set(xlabel="time [s]", ylabel="cross-track error [m]")
        canvas.suptitle(title, fontweight="bold")


def draw_station(path: Path, flight: Flight, away: Array, turned: Array, title: str) -> None:
    """Write a PNG: the track about the station; distance and heading error over time."""
    least = LEAST_LENGTHS * flight.boat.length
    with sheet(path, 7.2, 7.2) as canvas:
        above, distance, heading = canvas.subplots(3, 1, height_ratios=(3, 1, 1))
        above.plot(flight.track[:, EAST], flight.track[:, NORTH], color=BOAT, lw=1.0)
        above.plot([0.0], [0.0], "+", color=OTHER, ms=12)
        above.set(xlabel="east [m]", ylabel="north [m]", aspect="equal")
        above.set_adjustable("datalim")
        reach_at_least(above, least)
        distance.plot(flight.time, away, color=BOAT, lw=1.0)
        reach_at_least(distance, least)
        distance.set(ylabel="distance [m]", ylim=(0.0, None))
        heading.plot(flight.time, np.degrees(turned), color=BOAT, lw=1.0)
        reach_at_least(heading, LEAST_TURN)
        heading.set(xlabel="time [s]", ylabel="heading error [deg]")
        canvas.suptitle(title, fontweight="bold")


def reach_at_least(axes: Any, least: float) -> None:
    """Widen the vertical axis to ±least: rounding errors about 0 are no curve."""
    axes.update_datalim([(0.0, -least), (0.0, least)])
    axes.autoscale_view()


def draw_capability(path: Path, found: Capability, title: str) -> None:
    """Write a PNG: polar plots of the current and of the wind that is held, by where it comes from off the
    bow."""
    angles = np.append(found.direction, 2.0 * math.pi)
    with sheet(path, 8.4, 4.6) as canvas:
        both = canvas.subplots(1, 2, subplot_kw={"projection": "polar"})
        pairs = (("current [m/s]", found.current, BOAT), ("wind [m/s]", found.wind, OTHER))
        for axes, (label, values, colour) in zip(both, pairs, strict=True):
            closed = np.append(values, values[0])
            axes.plot(angles, closed, color=colour, lw=1.4)
            axes.fill(angles, closed, color=colour, alpha=0.15)
            axes.set_theta_zero_location("N")
            axes.set_theta_direction(-1)
            axes.set_rlim(0.0, max(1.05 * float(values.max()), 0.1))
            axes.set_title(label)
        canvas.suptitle(title, fontweight="bold")

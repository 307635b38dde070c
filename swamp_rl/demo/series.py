"""What is plotted over time of each run: commands, speed, distance to go, wind and current."""

import math
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.course import Course, gate_table
from swamp_rl.course.geometry import crosses_gate
from swamp_rl.course.progress import distance_to_go
from swamp_rl.runs import Run

Array = NDArray[np.float64]
Series = dict[str, dict[str, Array]]
"""By panel, then by line (empty, where the run has one only): values (T,)."""

LEVERS = {"throttle lever [1]": "joy_thrust", "angle lever [1]": "joy_angle"}
COMMANDS = {
    "throttle [1]": "throttle",
    "azimuth [rad]": "azimuth",
    "propeller [rps]": "propeller",
    "rudder [rad]": "rudder",
}
SPEED, TO_GO = "speed over ground [m/s]", "distance to go [m]"
WIND, CURRENT = "wind [m/s]", "current [m/s]"


def series_of(run: Run, course: Course | None) -> Series:
    """Every panel that the run has something for, in the order they are shown."""
    found: Series = {
        panel: {"": run.columns[column]} for panel, column in LEVERS.items() if column in run.columns
    }
    if not found:
        for panel, kind in COMMANDS.items():
            lines = {
                name.split("_", 1)[1]: values
                for name, values in run.columns.items()
                if re.fullmatch(rf"{kind}_\w+", name)
            }
            if lines:
                found[panel] = lines
    found[SPEED] = {"": speed(run)}
    if course is not None:
        found[TO_GO] = {"": to_go(run, course)}
    for panel, vector in ((WIND, wind(run)), (CURRENT, current(run))):
        if vector is not None:
            found[panel] = {"": np.hypot(*vector.T)}
    return found


def speed(run: Run) -> Array:
    """(T,) m/s over ground: as recorded, else the slope of the track."""
    if {"surge", "sway"} <= set(run.columns):
        return np.hypot(run.columns["surge"], run.columns["sway"])
    return np.hypot(np.gradient(run.columns["north"], run.time), np.gradient(run.columns["east"], run.time))


def to_go(run: Run, course: Course) -> Array:
    """(T,) m through the gates that are left."""
    gates, pose = gate_table(course), run.pose
    passed, way = 0, np.empty(len(pose))
    for t, (north, east, _) in enumerate(pose):
        if t and passed < len(gates):
            before = pose[t - 1]
            passed += crosses_gate(before[0], before[1], north, east, *gates[passed])
        way[t] = distance_to_go(north, east, passed, gates)
    return way


def wind(run: Run) -> Array | None:
    """(T, 2) north and east [m/s] of where the wind blows to: as recorded, else the mean that was set."""
    if {"wind_speed", "wind_from"} <= set(run.columns):
        speed, angle = run.columns["wind_speed"], run.columns["wind_from"]
    else:
        entry = _effect(run, "wind")
        if entry is None:
            return None
        speed, angle = np.full(len(run.time), entry["speed"]), entry["from"]
    return np.stack([-speed * np.cos(angle), -speed * np.sin(angle)], axis=-1)


def current(run: Run) -> Array | None:
    """(T, 2) north and east [m/s] of where the water flows to, where it was set."""
    entry = _effect(run, "current")
    if entry is None:
        return None
    return np.tile([entry.get("north", 0.0), entry.get("east", 0.0)], (len(run.time), 1))


def _effect(run: Run, name: str) -> dict[str, Any] | None:
    """The last entry of that name with finite numbers; a level's name alone tells no numbers."""
    drawn = run.meta.disturbances
    found = [entry for entry in drawn if entry.get("effect") == name] if isinstance(drawn, list) else []
    numbers = [value for entry in found[-1:] for key, value in entry.items() if key != "effect"]
    usable = all(isinstance(value, int | float) and math.isfinite(value) for value in numbers)
    if not found or not usable or (name == "wind" and not {"speed", "from"} <= set(found[-1])):
        return None
    return found[-1]

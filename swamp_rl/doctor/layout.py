"""Forces and moments that commands ask for, by where the thrusters are; commands as actuators follow them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, PropellerRudder

Array = NDArray[np.float64]

SIDE = re.compile(r"(?:^|_)(left|port|p|l)(?:_|$)|(?:^|_)(right|starboard|s|r)(?:_|$)")


@dataclass(frozen=True)
class Place:
    """A thruster: its columns (angle or None, level), its place [lengths of the boat], and how its actuators
    follow: `rate` [rad/s] and `lag` [s] of the angle, `level_lag` [s]. rudder: its angle is one; reverses:
    its level may be negative."""

    name: str
    angle: str | None
    level: str
    x: float
    y: float
    fixed: float = 0.0
    rate: float = np.inf
    lag: float = 0.0
    level_lag: float = 0.0
    rudder: bool = False
    reverses: bool = False

    def without_lags(self) -> "Place":
        """The same, whose actuators follow at once."""
        return replace(self, rate=np.inf, lag=0.0, level_lag=0.0)


def places_of(boat: Boat | None, columns: Mapping[str, Array]) -> list[Place]:
    """The thrusters whose commands are in the columns: from the boat, else by the sides in their names."""
    if boat is None:
        return [place for name in columns if (place := _by_name(name)) is not None]
    found = []
    for thruster in boat.thrusters:
        angle, level = thruster.command_columns
        if level not in columns or (angle is not None and angle not in columns):
            continue
        if isinstance(thruster, PropellerRudder):
            found.append(
                Place(
                    thruster.name,
                    angle,
                    level,
                    thruster.rudder.x / boat.length,
                    0.0,
                    rate=thruster.rudder_rate,
                    lag=thruster.rudder_time_constant,
                    level_lag=thruster.revolutions_time_constant,
                    rudder=True,
                    reverses=thruster.throttle_min < 0.0,
                )
            )
            continue
        found.append(
            Place(
                thruster.name,
                angle,
                level,
                thruster.x / boat.length,
                thruster.y / boat.length,
                fixed=thruster.azimuth_min if angle is None else 0.0,
                rate=thruster.azimuth_rate,
                lag=thruster.azimuth_time_constant,
                level_lag=thruster.pump_time_constant,
                reverses=thruster.throttle_min < 0.0,
            )
        )
    return found


def _by_name(column: str) -> Place | None:
    """A fixed thruster on the side that its name says."""
    if not column.startswith("throttle_"):
        return None
    side = SIDE.search(column.removeprefix("throttle_"))
    return None if side is None else Place(column[9:], None, column, 0.0, -0.25 if side[1] else 0.25)


def followed(columns: Mapping[str, Array], places: list[Place], step: float) -> dict[str, Array]:
    """Command columns as the actuators of the boat file follow them."""
    found = {}
    for place in places:
        found[place.level] = lagged(columns[place.level], place.level_lag, np.inf, step)
        if place.angle is not None:
            angle = columns[place.angle]
            turned = angle if place.rudder else np.unwrap(angle)
            found[place.angle] = lagged(turned, place.lag, place.rate, step)
    return found


def lagged(values: Array, lag: float, rate: float, step: float) -> Array:
    """Values (T,) through a limit of rate [1/s] and a first-order lag [s]."""
    if lag < 0.5 * step and not np.isfinite(rate):
        return values
    most, share = rate * step, 1.0 if lag < 0.5 * step else 1.0 - float(np.exp(-step / lag))
    found = np.empty(len(values))
    now = float(values[0])
    for i, goal in enumerate(values.tolist()):
        now += min(max(share * (goal - now), -most), most)
        found[i] = now
    return found


def demanded(columns: Mapping[str, Array], places: list[Place]) -> tuple[Array, Array]:
    """(T, 2) force ahead and (T, 2) yaw moment that commands ask for, in units of their own.

    Thrust as the level (a drive whose thrust is controlled) and as its square (propeller law at rest): curves
    of thrust lie between them. Moments with lengths of the boat; a rudder's as the sine of its angle in a
    stream half of which is the propeller's race.
    """
    total, moment = np.zeros((1, 2)), np.zeros((1, 2))
    for place in places:
        level = columns[place.level]
        size = float(np.abs(level).max()) or 1.0 if place.rudder else 1.0
        thrust = np.column_stack([level, np.abs(level) * level / size]) / size
        angle = np.full(len(level), place.fixed) if place.angle is None else columns[place.angle]
        ahead, aside = np.cos(angle)[:, None], np.sin(angle)[:, None]
        if place.rudder:
            total = total + thrust
            moment = moment - place.x * aside * (0.5 + 0.5 * np.abs(thrust))
            continue
        total = total + thrust * ahead
        moment = moment + thrust * (place.x * aside - place.y * ahead)
    return total, moment

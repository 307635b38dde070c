"""The strongest current and wind that a boat can hold from each direction: its capability plot."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation import Jets, largest_multiple
from swamp_rl.boat import Boat
from swamp_rl.guidance.drive import Drive
from swamp_rl.guidance.holding import RESERVE, in_flow, steady_force_of
from swamp_rl.guidance.weathervane import margin_of, pushes_sideways, unsteadiness
from swamp_rl.simulator import parameters, tank
from swamp_rl.simulator.reference import reference_of

Array = NDArray[np.float64]

DIRECTIONS = 36
COARSE, FINE = 24, 14  # steps of the search upwards, and halvings
MOST_WIND = 60.0  # m/s, beyond any wind; a jet boat that holds it is reported as holding this
STRAIGHT = 1e-3  # share of the whole force that a sway force may have without being one


@dataclass(frozen=True)
class Capability:
    """direction: (n,) [rad] off the bow that the weather comes from; current, wind: (n,) [m/s] that is held.

    Each is held with a reserve of a tenth, the other one being 0 or `beside` [m/s] from the same direction.
    """

    direction: Array
    current: Array
    wind: Array
    most: tuple[float, float] = (math.inf, math.inf)
    "The greatest current and wind [m/s] that were tried."


def capability(
    boat: Boat, drive: Drive, wind: float = 0.0, current: float = 0.0, directions: int = DIRECTIONS
) -> Capability:
    """The capability of a boat at rest over ground with its bow at 0.

    wind, current [m/s]: steady ones that come from the same direction as the other, which is sought. A drive
    without sway force holds only what comes from straight ahead or astern.
    """
    angles = np.arange(directions) * 2.0 * math.pi / directions
    sideways = pushes_sideways(drive)
    top = 1.5 * reference_of(boat).speed

    def held(angle: float, current: float, wind: float) -> bool:
        return holds(boat, drive, angle, current, wind, sideways)

    return Capability(
        angles,
        np.array([strongest(partial(held, angle, wind=wind), top) for angle in angles]),
        np.array([strongest(partial(held, angle, current), MOST_WIND) for angle in angles]),
        (top, MOST_WIND),
    )


def holds(boat: Boat, drive: Drive, angle: float, current: float, wind: float, sideways: bool) -> bool:
    """Whether the force against a current and a wind [m/s] that come from `angle` [rad] can be had, and a
    tenth more, at a heading that the bow keeps."""
    record, curves = in_weather(parameters(boat), angle, current, wind)[0], tank(boat)
    needed = steady_force_of(record, curves, 0.0)
    size = float(np.hypot(*needed[:2]))
    if size == 0.0:
        return True
    flow = np.array([current * math.cos(angle), current * math.sin(angle), 0.0])
    if sideways and isinstance(drive, Jets):
        return largest_multiple(in_flow(drive, current), needed) >= RESERVE
    if abs(needed[1]) > STRAIGHT * size:
        return False
    return margin_of(drive, needed, flow) >= RESERVE and not unsteadiness(drive, record, curves, 0.0)


def in_weather(record: NDArray[Any], angle: float, current: float, wind: float) -> NDArray[Any]:
    """The record with a current and a wind [m/s] that come from `angle` [rad] clockwise from north."""
    record["current_north"], record["current_east"] = -current * math.cos(angle), -current * math.sin(angle)
    record["wind_speed"], record["wind_from"] = wind, angle
    return record


def strongest(held: Callable[[float], bool], most: float) -> float:
    """The greatest speed [m/s] up to `most` below which all are held: a search upwards, then bisection."""
    low, step = 0.0, most / COARSE
    while low < most and held(low + step):
        low += step
    if low >= most:
        return most
    if low == 0.0 and not held(0.0):
        return 0.0
    high = low + step
    for _ in range(FINE):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if held(middle) else (low, middle)
    return low

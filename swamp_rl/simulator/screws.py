"""What the parameter record holds of propellers and tables that give a thruster its thrust."""

import math
from itertools import chain
from typing import Any

from swamp_rl.boat import Boat, Thruster
from swamp_rl.boat.screw import OPEN_WATER, Disc, FourQuadrant, Linear, ThrustTable
from swamp_rl.physics.propulsion import OF_SCREW
from swamp_rl.physics.screw import TABLE

NEUTRAL = {"wash_of": -1.0, "throttle_rate": math.inf}  # of a thruster without such a number, where not 0
NUMBERS = "screw_numbers"
ROOM = 24
"""Numbers of a series or a table that the record holds for each thruster, at least; what is left is 0."""
WIDER = 4
"""Factor on them for longer ones, as often as needed."""


def room_of(field: str, longest: int) -> int:
    """Numbers that the record holds of the list `field`, the longest of which has that many.

    In few steps, for numba compiles the boat's step for every length.
    """
    room = ROOM if field == NUMBERS else longest
    while room < longest:
        room *= WIDER
    return room


def screw_row(thruster: Thruster, boat: Boat) -> dict[str, Any]:
    """Of a thruster with a propeller or a table; nothing for a jet."""
    screw, table = thruster.propeller, thruster.thrust_table
    rate = thruster.greatest_throttle_rate(boat.water_density)
    if screw is None and table is None:
        return {} if rate is None else {"throttle_rate": rate}
    row: dict[str, Any] = {"drive": OF_SCREW, "level_min": thruster.throttle_min, "level_max": 1.0}
    row |= {"throttle_rate": NEUTRAL["throttle_rate"] if rate is None else rate}
    row |= {"wash_of": -1.0, "wash_share": 0.0, "screw_wake": 0.0, "screw_crossflow": 0.0, "screw_side": 0.0}
    row |= {"revolutions_max": 0.0, "revolutions_max_astern": 0.0}
    if screw is None:
        assert table is not None
        return row | empty_model() | table_row(table)
    if screw.wash is not None:
        row |= {"wash_of": float(boat.thruster_names.index(screw.wash.of)), "wash_share": screw.wash.share}
    row |= {"screw_wake": screw.wake, "screw_crossflow": screw.crossflow_loss, "screw_side": screw.side_share}
    row |= {"revolutions_max": screw.revolutions_max, "revolutions_max_astern": screw.revolutions_max_astern}
    return row | {"nozzle_area": screw.area} | model_row(screw.diameter, screw.open_water)


def empty_model() -> dict[str, Any]:
    """The fields of all models, without one."""
    row: dict[str, Any] = {
        "screw_model": 0.0,
        "screw_diameter": 0.0,
        "screw_pitch": 0.0,
        "screw_bollard": 0.0,
    }
    row |= {"screw_orders": 0.0, "table_throttles": 0.0, "table_speeds": 0.0}
    return row | {NUMBERS: (0.0,)}


def model_row(diameter: float, model: Disc | Linear | FourQuadrant) -> dict[str, Any]:
    """Of a propeller's model in open water."""
    row = empty_model() | {"screw_model": 1.0 + OPEN_WATER.index(model.kind), "screw_diameter": diameter}
    if isinstance(model, Disc):
        return row | {"screw_pitch": model.pitch_ratio}
    if isinstance(model, Linear):
        return row | {"screw_bollard": model.bollard_coefficient, "screw_pitch": model.null_advance}
    row |= {"screw_orders": float(len(model.cosines))}
    return row | {NUMBERS: tuple(chain.from_iterable(zip(model.cosines, model.sines, strict=True)))}


def table_row(table: ThrustTable) -> dict[str, Any]:
    """Of a measured table."""
    throttles, thrust = table.throttles, table.filled
    row: dict[str, Any] = {"screw_model": TABLE}
    row |= {"table_throttles": float(len(throttles)), "table_speeds": float(len(table.speed))}
    return row | {NUMBERS: (*throttles, *table.speed, *chain.from_iterable(thrust))}

"""Telemetry lines of the thruster modules: commands in force and what the motors have reached.

The thesis (6.2) says that the modules send telemetry and prints no fields of it. These are this project's:
ten whole numbers, the motors in the order of their numbers in the protocol.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat

Array = NDArray[np.float64]

MODULE_FIELDS = (
    "sender",
    "utc",
    "thrust_power",
    "thrust_enabled",
    "thrust_reference",
    "thrust_actual",
    "azimuth_power",
    "azimuth_enabled",
    "azimuth_reference",
    "azimuth_actual",
)
"""Sender: last byte of the module's address; utc [µs since 1970]; switches 0 or 1; thousandths of a percent
of the highest revolutions; steps. A reference is the one in force: 0, or the azimuth reached, of a motor that
is off."""
FULL = 100_000
"""Reference of a thrust motor at its highest revolutions: thousandths of a percent (thesis 6.2)."""
FIRST_MODULE = 201
"""Last byte of the address of the first thruster's module, the starboard bow's (thesis 6.2)."""
STEPS_PER_TURN = 495_411
"""Of the azimuth's encoder (thesis table 5.5, again in 7.2). Section 6.1 has 4096 steps times the gear,
483,328, and the example in 6.2 calls 41,284 steps 45 deg, of which table 5.5 makes 30.0 deg: docs/link.md."""


def azimuth_steps(azimuth: float, steps_per_turn: float = STEPS_PER_TURN) -> int:
    """Steps of an azimuth [rad], clockwise from ahead; any number of turns."""
    return round(azimuth / (2.0 * math.pi) * steps_per_turn)


def azimuth_angle(steps: float, steps_per_turn: float = STEPS_PER_TURN) -> float:
    """Azimuth [rad] of a number of steps."""
    return 2.0 * math.pi * steps / steps_per_turn


def command_columns(lines: Mapping[int, Array], time: Array, boat: Boat) -> dict[str, Array]:
    """Columns of a run from module lines: commands held over each row's interval, and what was applied.

    lines: (L, 10) rows of `MODULE_FIELDS` by sender, their `utc` replaced by the time [s] of the run and in
    order; time: (T,) [s] of the rows. A row's command is the one in force at the middle of its interval, for
    a pilot answers a row of telemetry a little later. NaN before the first line of a module.
    """
    columns: dict[str, Array] = {}
    middle = time + 0.5 * float(np.median(np.diff(time))) if len(time) > 1 else time
    for k, thruster in enumerate(boat.thrusters):
        if (own := lines.get(FIRST_MODULE + k)) is None:
            continue
        for prefix, what, instants in (("", "reference", middle), ("applied_", "actual", time)):
            throttle = last_reported(own, f"thrust_{what}", instants) / FULL
            azimuth = azimuth_angle(1.0) * last_reported(own, f"azimuth_{what}", instants)
            for name, values in zip(thruster.command_columns, (azimuth, throttle), strict=True):
                if name is not None:
                    columns[f"{prefix}{name}"] = values
    return columns


def last_reported(lines: Array, field: str, at: Array) -> Array:
    """(T,) a field of the last of lines (L, 10) at or before each time `at` (T,); NaN before the first."""
    index = np.searchsorted(lines[:, MODULE_FIELDS.index("utc")], at, side="right") - 1
    values = lines[np.maximum(index, 0), MODULE_FIELDS.index(field)]
    return np.where(index >= 0, values, np.nan)


def is_module_line(words: Sequence[str]) -> bool:
    """Whether the words of a line are as many as a module's."""
    return len(words) == len(MODULE_FIELDS)

"""Units of foreign columns, in those of the run format."""

import math

from swamp_rl.constants import FOOT, KNOT
from swamp_rl.errors import UserError
from swamp_rl.runs.columns import span_of

UNITS = {
    "deg": {"rad": math.pi / 180.0, "deg": 1.0},
    "deg/s": {"rad/s": math.pi / 180.0},
    "deg/min": {"rad/s": math.pi / 10800.0},
    "rpm": {"rps": 1.0 / 60.0, "rad/s": math.tau / 60.0},
    "percent": {"1": 0.01},
    "mm": {"m": 1e-3},
    "cm": {"m": 1e-2},
    "km": {"m": 1e3},
    "ft": {"m": FOOT},
    "kn": {"m/s": KNOT},
    "km/h": {"m/s": 1.0 / 3.6},
    "mm/s": {"m/s": 1e-3},
    "cm/s": {"m/s": 1e-2},
    "ft/s": {"m/s": FOOT},
    "s": {"s": 1.0},
    "ms": {"s": 1e-3},
    "us": {"s": 1e-6},
    "ns": {"s": 1e-9},
    "min": {"s": 60.0},
    "h": {"s": 3600.0},
    "d": {"s": 86_400.0},
}
"""What one of each is in the units of our columns that it may be given for."""
IN_DEGREES = ("latitude", "longitude")


def factor(name: str, unit: str, column: str | None = None) -> float:
    """What one `unit`, a key of UNITS, is in the unit of a column of the run format.

    column: what the quantity `name` becomes, by default a column of that name. One that the format does not
    know has the first of the unit's values. UserError where the two measure different quantities.
    """
    ours, factors = _unit_of(column or name), UNITS[unit]
    if ours is None:
        return next(iter(factors.values()))
    if ours not in factors:
        known = ", ".join(other for other, of in UNITS.items() if ours in of)
        if (ours, unit) == ("1", "us"):
            known += f", or map the pulse width, usually 1500 us ± 400: --map '{name}=(COLUMN-1500)/400'"
        raise UserError(f"column {name}: {unit} is not a unit of it; give one of {known}")
    return factors[ours]


def _unit_of(column: str) -> str | None:
    if column in IN_DEGREES:
        return "deg"
    span = span_of(column, None)
    return None if span is None else span.unit

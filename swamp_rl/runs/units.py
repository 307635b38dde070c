"""Units of foreign columns, in those of the run format."""

from swamp_rl.errors import UserError
from swamp_rl.runs.columns import span_of
from swamp_rl.units import UNITS

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

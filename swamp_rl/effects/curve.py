"""What an entry of `force_curve` holds: a force as a function of one variable, by knots or by a formula."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.explain import in_yaml, nearest
from swamp_rl.physics import force_curve as row

KEYS = ("component", "covariate", "formula", "knots", "values", "standard_errors")
COMPONENTS = row.COMPONENTS[1:]
COVARIATES = {
    "time": "s",
    "position_north": "m",
    "position_east": "m",
    "heading": "rad",
    "speed": "m/s",
    "surge": "m/s",
    "sway": "m/s",
    "yaw_rate": "rad/s",
    "azimuth": "rad",
    "throttle": "1",
}
OF_A_THRUSTER = ("azimuth", "throttle", "thrust")
ANGLES = ("heading", "azimuth")
COEFFICIENTS = {
    "proportional": ("{force}/({x})",),
    "square": ("{force}/({x})^2",),
    "cube": ("{force}/({x})^3",),
    "dead_zone": ("{force}/({x})", "{x}"),
    "outside_radius": ("{force}", "{x}"),
    "sine": ("{force}", "{x}"),
}
"""Units of each formula's coefficients, of the force's unit and the variable's."""


@dataclass(frozen=True)
class Curve:
    """A force as a function of a variable, zero outside the first and the last knot.

    formula: between them, or None where the values at the knots are joined by straight lines. places: the
    value of each knot by its place among the values; -1: zero. standard_errors: of what `listed` gives, none
    where they are not known.
    """

    component: str
    covariate: str
    knots: tuple[float, ...]
    formula: str | None = None
    places: tuple[int, ...] = ()
    standard_errors: tuple[float, ...] = ()

    @property
    def size(self) -> int:
        """How many values there are."""
        return len(COEFFICIENTS[self.formula]) if self.formula else max(self.places) + 1

    @property
    def value_names(self) -> tuple[str, ...]:
        """By which an entry holds the values."""
        return tuple(str(place) for place in range(self.size))

    @property
    def units(self) -> tuple[str, ...]:
        """Of the values."""
        force = "N m" if self.component == "yaw" else "N"
        if self.formula is None:
            return (force,) * self.size
        x = COVARIATES[self.covariate]
        return tuple(unit.format(force=force, x=x) for unit in COEFFICIENTS[self.formula])

    @property
    def needs_thruster(self) -> bool:
        """Whether it is of one thruster."""
        return self.component in OF_A_THRUSTER or self.covariate in OF_A_THRUSTER

    def listed(self, values: Mapping[str, Any]) -> list[float]:
        """The values as a file holds them: at each knot, or of each coefficient."""
        numbers = [float(values[name]) for name in self.value_names]
        return numbers if self.formula else [0.0 if place < 0 else numbers[place] for place in self.places]

    def mapping(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """The keys of an entry but its effect and thruster."""
        formula = {"formula": self.formula} if self.formula else {}
        ends = [self.knots[0], self.knots[-1]] if self.formula else list(self.knots)
        keys = {"component": self.component, "covariate": self.covariate}
        errors = {"standard_errors": list(self.standard_errors)} if self.standard_errors else {}
        return {**keys, **formula, "knots": ends, "values": self.listed(values), **errors}


def formulas_of(covariate: str) -> tuple[str, ...]:
    """Those whose units fit the variable: a sine takes an angle, powers and dead zones do not."""
    return tuple(name for name in COEFFICIENTS if (name == "sine") == (covariate in ANGLES))


def parse_curve(given: Mapping[str, Any], where: str) -> tuple[Curve, dict[str, float]]:
    """The curve of an entry's keys, and its values by name; UserError names the first fault."""
    component = _one_of(given, "component", COMPONENTS, where)
    covariate = _one_of(given, "covariate", tuple(COVARIATES), where)
    formula = _one_of(given, "formula", formulas_of(covariate), where) if "formula" in given else None
    knots = _numbers(given, "knots", where)
    values = _numbers(given, "values", where)
    if not 2 <= len(knots) <= row.KNOTS or any(b <= a for a, b in pairwise(knots)):
        raise UserError(f"{where}: knots must be 2 to {row.KNOTS} numbers that increase")
    if formula and len(knots) != 2:
        raise UserError(f"{where}: knots must be the two ends of the formula's range")
    wanted = len(COEFFICIENTS[formula]) if formula else len(knots)
    errors = _numbers(given, "standard_errors", where) if "standard_errors" in given else ()
    if any(error < 0.0 for error in errors):
        raise UserError(f"{where}: standard_errors must be at least 0")
    for name, numbers in (("values", values), ("standard_errors", errors or values)):
        if len(numbers) != wanted:
            of = f"of the formula {formula}" if formula else "as there are knots"
            raise UserError(f"{where}: {name} must be {wanted} numbers, as many {of}")
    places = () if formula else tuple(range(len(knots)))
    curve = Curve(component, covariate, knots, formula, places, errors)
    return curve, dict(zip(curve.value_names, values, strict=True))


def _one_of(given: Mapping[str, Any], key: str, known: tuple[str, ...], where: str) -> str:
    value = given.get(key)
    if not isinstance(value, str) or value not in known:
        message = f"unknown {key} {in_yaml(value)}" if key in given else f"{key} is missing"
        raise UserError(f"{where}: {message}{nearest(str(value), known)}")
    return value


def _numbers(given: Mapping[str, Any], key: str, where: str) -> tuple[float, ...]:
    numbers = given.get(key)
    if not isinstance(numbers, list | tuple) or not numbers or not all(map(_is_finite, numbers)):
        raise UserError(f"{where}: {key} must be a list of numbers")
    return tuple(float(number) for number in numbers)


def _is_finite(value: Any) -> bool:
    return (
        isinstance(value, int | float)
        and not isinstance(value, bool)
        and (not isinstance(value, int) or abs(value) < 2**63)
        and math.isfinite(value)
    )


def write_curve(
    field: NDArray[np.float64],
    curve: Curve,
    values: Mapping[str, Any],
    thruster: int,
    boats: NDArray[np.bool_],
) -> None:
    """Put a curve into the first empty row of each marked boat (n,) of `field` (n, CURVES, WIDTH), in place.

    values: name -> a number or one for each boat (n,). UserError where a boat has no empty row.
    """
    marked = np.flatnonzero(boats)
    used = (field[marked, :, row.COMPONENT] != 0.0).sum(axis=1)
    if (used >= row.CURVES).any():
        raise UserError(f"force_curve: a boat may have {row.CURVES} of them; remove one")
    rows = np.zeros((len(marked), row.WIDTH))
    rows[:, row.COMPONENT] = row.COMPONENTS.index(curve.component)
    rows[:, row.COVARIATE] = row.COVARIATES.index(curve.covariate)
    rows[:, row.THRUSTER] = thruster
    rows[:, row.FORMULA] = row.FORMULAS.index(curve.formula or row.FORMULAS[0])
    rows[:, row.COUNT] = len(curve.knots)
    rows[:, row.FIRST_KNOT : row.FIRST_KNOT + len(curve.knots)] = curve.knots
    places = curve.places or tuple(range(curve.size))
    for column, place in enumerate(places):
        if place >= 0:
            numbers = np.broadcast_to(np.asarray(values[str(place)], dtype=float), boats.shape)
            rows[:, row.FIRST_VALUE + column] = numbers[marked]
    field[marked, used] = rows

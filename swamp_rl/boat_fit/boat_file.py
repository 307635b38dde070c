"""The identified boat file: the start boat with the fitted numbers and their standard errors."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from swamp_rl.boat import Boat
from swamp_rl.boat.mapping import boat_mapping
from swamp_rl.boat.quantity import SPREAD
from swamp_rl.boat_numbers.number import Number
from swamp_rl.boat_numbers.numbers import free_numbers
from swamp_rl.boat_numbers.start_effects import in_numbers, lies_at
from swamp_rl.effects import LIBRARY
from swamp_rl.effects.entries import entry_mapping

THRUST = "thrust_scale"  # effect on all thrusters
DIGITS = 5  # significant, of a number in the file
CORRELATION_DIGITS = 4  # after the point; errors of two numbers that scale alike nearly cancel
SHOWN = (
    0.7  # of the prior's standard deviation, below which a standard error says that the data show a number
)


@dataclass(frozen=True)
class Fitted:
    """A number at its fit. x: as the fit moves it; sd: standard deviation of x; jointly: row of the lower
    triangle of the joint covariance of the numbers in their order, none: independent.
    """

    number: Number
    x: float
    sd: float
    jointly: tuple[float, ...] = ()

    @property
    def value(self) -> float:
        """The number, in its unit."""
        return self.number.value(self.x)

    @property
    def standard_error(self) -> float:
        """Of the value, in its unit."""
        return self.number.spread(self.x, self.sd)

    @property
    def prior_sd(self) -> float:
        """Standard deviation of the prior about the start value, in the number's unit."""
        return self.number.spread(self.number.mean, self.number.sd)

    @property
    def shown(self) -> bool:
        """Whether the data say more of the number than its prior did."""
        return self.sd < SHOWN * self.number.sd

    @property
    def information(self) -> float:
        """Share of the posterior precision of x [1] that the runs gave."""
        return max(0.0, 1.0 - (self.sd / self.number.sd) ** 2)

    @property
    def distance(self) -> float:
        """Of x from its prior mean in standard deviations of the prior [1]."""
        return abs(self.x - self.number.mean) / self.number.sd


def identified_mapping(
    boat: Boat, name: str, fitted: Sequence[Fitted], fitted_to: str, level: float = 1.0
) -> dict[str, Any]:
    """The boat file of a fit; fitted_to: the datasets' names, for the sources; level: of the thrust [1].

    A number that the data show has provenance `fitted`; another one keeps its own. What the start boat's
    effects do to numbers that were fitted is in those numbers.
    """
    kept, places = in_numbers(boat, [one.number for one in fitted])
    made = boat_mapping(boat) | {"name": name, "effects": [entry_mapping(entry) for entry in kept]}
    names = {one.number.name for one in fitted}
    at_start = [Fitted(number, number.mean, number.sd) for number in free_numbers(boat, positions=True)]
    freed = [one for one in at_start if lies_at(one.number, places) and one.number.name not in names]
    for one in (*fitted, *freed):
        if one.number.name.startswith("effects."):
            _add_effect(made["effects"], boat, one)
        else:
            _set_number(made, boat, one, fitted_to)
    _scale_thrust(made["effects"], level)
    if not made["effects"]:
        del made["effects"]
    made.pop("covariance", None)
    return made | ({"covariance": _covariance(fitted, fitted_to)} if fitted else {})


def _covariance(fitted: Sequence[Fitted], fitted_to: str) -> dict[str, Any]:
    rows = [one.jointly or (*(0.0,) * i, one.sd**2) for i, one in enumerate(fitted)]
    sd = [math.sqrt(row[-1]) for row in rows]
    correlation = [
        [round(value / (sd[i] * sd[k]), CORRELATION_DIGITS) for k, value in enumerate(row[:-1])]
        for i, row in enumerate(rows)
    ]
    return {
        "source": f"identified from {fitted_to}",
        "numbers": [one.number.name for one in fitted],
        "standard_errors": [_rounded(size) for size in sd],
        "correlation": correlation,
    }


def _scale_thrust(effects: list[dict[str, Any]], level: float) -> None:
    """Multiply all thrust by the level, in one effect with that of the start file."""
    scales = [entry for entry in effects if entry["effect"] == THRUST]
    level *= math.prod(entry["scale"] for entry in scales)
    effects[:] = [entry for entry in effects if entry not in scales]
    if level != 1.0:
        effects.append({"effect": THRUST, "scale": _rounded(level)})


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _add_effect(effects: list[dict[str, Any]], boat: Boat, one: Fitted) -> None:
    """Append the effect of a number that has no key of its own, unless it does nothing."""
    _, effect, parameter, *_ = one.number.name.split(".")
    if one.value == LIBRARY[effect].parameter(parameter).neutral:
        return
    thrusters = one.number.thrusters
    selector = {} if thrusters is None else {"thruster": boat.thruster_names[thrusters[0]]}
    effects.append({"effect": effect, **selector, parameter: _rounded(one.value)})


def _set_number(made: dict[str, Any], boat: Boat, one: Fitted, fitted_to: str) -> None:
    """Put one number into the mapping, in every thruster that shares it."""
    keys = one.number.name.split(".")
    if keys == ["resistance", "table"]:
        _scale_table(made["resistance"], one, fitted_to)
        return
    if keys[0] != "thrusters":
        _replace(_inside(made, keys[:-1]), keys[-1], one, fitted_to)
        return
    for k in one.number.thrusters or ():
        section = next(item for item in made["thrusters"] if item["name"] == boat.thruster_names[k])
        _replace_part(section, keys[2:], one, fitted_to)


def _replace_part(section: dict[str, Any], keys: list[str], one: Fitted, fitted_to: str) -> None:
    if one.number.element is None:
        _replace(_inside(section, keys[:-1]), keys[-1], one, fitted_to)
        return
    inside, key, index = _inside(section, keys[:-2]), keys[-2], int(keys[-1])
    values = list(inside[key]["value"])
    values[index] = _rounded(one.value)
    source = inside[key]["source"] if inside[key]["provenance"] == "fitted" else ""
    new_source = _source(one, fitted_to) if fitted_to not in source else f"{source}; {_errors(one)}"
    inside[key] = {**inside[key], "value": values, "provenance": "fitted", "source": new_source}


def _inside(section: dict[str, Any], keys: list[str]) -> dict[str, Any]:
    for key in keys:
        section = section[key]
    return section


def _replace(section: dict[str, Any], key: str, one: Fitted, fitted_to: str) -> None:
    given = section.get(key)
    if isinstance(given, dict) and isinstance(given["value"], list):  # all of them scaled by one factor
        value: Any = [_rounded(item * one.value) for item in given["value"]]
        sd: Any = [_rounded(abs(item) * one.standard_error) for item in given["value"]]
    else:
        value, sd = _rounded(one.value), _rounded(one.standard_error)
    if not one.shown and isinstance(given, dict):
        listed = isinstance(given["value"], list)
        own = listed or math.isclose(given["value"], one.number.start)
        origin = {} if own else {"provenance": "assumed", "source": "the start file with its effects"}
        section[key] = {**given, "value": value} | origin
        section[key]["source"] += f"; not identifiable from {fitted_to}{_moved(one, listed)}"
        return
    section[key] = {
        "value": value,
        "unit": one.number.unit,
        "provenance": "fitted",
        "source": _source(one, fitted_to),
        SPREAD: sd,
    }


def _moved(one: Fitted, listed: bool) -> str:
    """What the fit did to a number that the data do not show, which follows those that they show."""
    if _rounded(one.value) == _rounded(one.number.start):
        return ""
    start = f"{one.number.start:.4g}"
    return f", times {one.value:.4g} by the fit" if listed else f", moved from {start} by the fit"


def _scale_table(resistance: dict[str, Any], one: Fitted, fitted_to: str) -> None:
    for curve in resistance["table"]:
        given = curve["resistance"]
        values = [_rounded(item * one.value) for item in given["value"]]
        source = f"{given['source']}, times {one.value:.4g}; {_source(one, fitted_to)}"
        sd = [_rounded(abs(item) * one.standard_error) for item in given["value"]]
        curve["resistance"] = {"value": values, "unit": given["unit"], "provenance": "fitted"}
        curve["resistance"] |= {"source": source, SPREAD: sd}


def _errors(one: Fitted) -> str:
    return f"standard error {one.standard_error:.2g}"


def _source(one: Fitted, fitted_to: str) -> str:
    return f"identified from {fitted_to}, {_errors(one)}, prior {one.prior_sd:.2g}"

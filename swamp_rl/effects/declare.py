"""What an effect is: a named departure from the boat file, with parameters that land in the boat's record."""

import math
from dataclasses import dataclass
from typing import Literal

Combine = Literal["add", "multiply", "replace"]
ActsOn = Literal["force", "actuator", "sensor", "command"]

FULL_TURN = 2.0 * math.pi

LIBRARY: dict[str, "Effect"] = {}


@dataclass(frozen=True)
class Parameter:
    """One number of an effect.

    field: where it lands in the simulator's record of a boat. neutral: the value that changes nothing, None
    where that is the boat file's own. low, high [unit]: what is allowed, both included unless `above_low`;
    limit: why, for the message. required: an entry must give it, even though it has a neutral value.
    """

    name: str
    unit: str
    neutral: float | None
    field: str
    low: float = -math.inf
    high: float = math.inf
    above_low: bool = False
    limit: str = ""
    required: bool = False

    def allows(self, value: float) -> bool:
        """Whether `value` [unit] is finite and within the bounds."""
        above = value > self.low if self.above_low else value >= self.low
        return math.isfinite(value) and above and value <= self.high

    @property
    def allowed(self) -> str:
        """The bounds in words."""
        low = "above" if self.above_low else "at least"
        parts = [f"{low} {self.low:.6g}"] if self.low > -math.inf else []
        parts += [f"at most {self.high:.6g}"] if self.high < math.inf else []
        bounds = " and ".join(parts) or "any finite number"
        return f"{bounds} [{self.unit}]" + (f" ({self.limit})" if self.limit else "")


@dataclass(frozen=True)
class Effect:
    """A named departure.

    thruster: entries name one or `all`, and the fields have a column for each. swaps: entries name two, whose
    numbers in this per-thruster field of the boat are exchanged; such an effect has no parameters.
    """

    name: str
    parameters: tuple[Parameter, ...]
    acts_on: ActsOn
    combine: Combine
    description: str
    source: str
    thruster: bool = False
    swaps: str = ""

    def parameter(self, name: str) -> Parameter:
        """The parameter of that name; KeyError if there is none."""
        return {parameter.name: parameter for parameter in self.parameters}[name]

    @property
    def selects(self) -> bool:
        """Whether entries have the key `thruster`."""
        return self.thruster or bool(self.swaps)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names in the order of declaration."""
        return tuple(parameter.name for parameter in self.parameters)


def declare(
    name: str,
    *parameters: Parameter,
    acts_on: ActsOn,
    combine: Combine,
    description: str,
    source: str,
    thruster: bool = False,
    swaps: str = "",
) -> None:
    """Add an effect to LIBRARY; ValueError if the name is taken."""
    if name in LIBRARY:
        raise ValueError(f"effect {name!r} is declared twice")
    LIBRARY[name] = Effect(name, parameters, acts_on, combine, description, source, thruster, swaps)


def neutral_fields() -> dict[str, tuple[float, bool]]:
    """Record fields of the library that have a neutral value: field -> (value, whether one per thruster).

    A simulator's record starts from these, save where the boat file has the field: there its number counts.
    So an effect that needs a new field gets it from its declaration alone.
    """
    return {
        parameter.field: (parameter.neutral, effect.thruster)
        for effect in LIBRARY.values()
        for parameter in effect.parameters
        if parameter.neutral is not None
    }

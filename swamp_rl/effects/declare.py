"""What an effect is: a named departure from the boat file, with parameters that land in the boat's record."""

import math
from dataclasses import dataclass
from typing import Any, Literal

from swamp_rl.effects.search import Search

Combine = Literal["add", "multiply", "replace"]
ActsOn = Literal["force", "actuator", "sensor", "command"]
Scope = Literal["boat", "day", "run"]
Needs = Literal["", "azimuth", "astern", "rudder"]
Begin = Literal["score", "grid", "spectral", "changepoint"]

FULL_TURN = 2.0 * math.pi

LIBRARY: dict[str, "Effect"] = {}


@dataclass(frozen=True)
class Parameter:
    """One number of an effect.

    field: where it lands in the simulator's record of a boat. neutral: the value that changes nothing, None
    where that is the boat file's own. low, high [unit]: what is allowed, both included unless `above_low`;
    limit: why, for the message. required: an entry must give it, even though it has a neutral value.
    search: how a diagnosis fits it.
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
    search: Search | None = None

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
    numbers in this per-thruster field of the boat are exchanged; reverses: whose number in this per-thruster
    field changes its sign; such effects have no parameters. curve: entries hold a `Curve` and no parameters.
    needs: what a thruster must be able to do, or have; a boat without such a thruster has no such effect.
    weather: of the surroundings, such as wind, current or a towed line, and not of the boat.

    The rest says how a diagnosis searches for it. scope: the least that may have a value of its own.
    begin: what the fit's starts come from: the parameters' own, the best point of their grid, a scan of
    frequencies or of instants; None: never a cause, being random or another's doing. vector: size and
    direction that are fitted as the components of a vector, whose searches stand with the two; half_turn:
    direction and phase, of which both turned by half a turn say the same. moves_actuators: changes how the
    actuators follow their commands. steady: whether steady motion shows it. all_together: may act on all
    thrusters at once. alone_equals: what it is called on a boat with one thruster. contains:
    effects that are this one with some of its parameters equal or neutral, and so no rivals of it. sudden:
    may begin while the boat sails, so that a live monitor looks for its onset. battery: acts through the
    charge of the boat's battery, which the episodes of an environment alone count. beside: an effect without
    which it changes nothing.
    """

    name: str
    parameters: tuple[Parameter, ...]
    acts_on: ActsOn
    combine: Combine
    description: str
    source: str
    thruster: bool = False
    swaps: str = ""
    reverses: str = ""
    curve: bool = False
    needs: Needs = ""
    weather: bool = False
    scope: Scope = "boat"
    begin: Begin | None = "score"
    vector: tuple[str, str] | None = None
    half_turn: tuple[str, str] | None = None
    moves_actuators: bool = False
    steady: bool = True
    all_together: bool = False
    alone_equals: str = ""
    contains: tuple[str, ...] = ()
    sudden: bool = False
    battery: bool = False
    beside: str = ""

    def parameter(self, name: str) -> Parameter:
        """The parameter of that name; KeyError if there is none."""
        return {parameter.name: parameter for parameter in self.parameters}[name]

    @property
    def selects(self) -> bool:
        """Whether entries have the key `thruster`."""
        return self.thruster or bool(self.swaps)

    @property
    def nuisance(self) -> bool:
        """Whether no boat has exactly the file's numbers, each of which has a prior."""
        return bool(self.parameters) and all(p.search and p.search.prior for p in self.parameters)

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
    **more: Any,
) -> None:
    """Add an effect to LIBRARY; more: the other fields of `Effect`. ValueError if the name is taken, or a
    number that a diagnosis should fit has no `search`.
    """
    effect = Effect(name, parameters, acts_on, combine, description, source, **more)
    if name in LIBRARY:
        raise ValueError(f"effect {name!r} is declared twice")
    if effect.begin is not None and any(parameter.search is None for parameter in parameters):
        raise ValueError(f"effect {name!r} has a number without a search")
    LIBRARY[name] = effect


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

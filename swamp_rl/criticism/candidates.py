"""What may be wrong: every effect of the library, on every thruster, as numbers that a fit can move."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.effects import LIBRARY, Effect, EffectEntry, apply_effects
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]
Values = dict[str, Any]

NOT_CAUSES = ("gusts", "thruster_kick")  # random, or somebody else's doing: not to be foretold
WAVES, FAILURE = "waves", "thruster_failure"  # what `score` looks for in ways of their own
LAGS = ("azimuth_lag", "pump_lag")
NUISANCE = "hull_coefficients"
NUISANCE_SD = 0.12  # a regression's linear derivative against the boat's, one standard deviation
HULL_LIMIT = 1.6


@dataclass(frozen=True)
class Spec:
    """How a fit moves one number: typical size, least and most, step of its finite difference, where to
    start.
    """

    scale: float
    low: float
    high: float
    starts: tuple[float, ...]
    step: float | None = None
    prior: float | None = None

    @property
    def difference(self) -> float:
        """Step of the finite difference, in the parameter's unit."""
        return self.step if self.step is not None else 1e-6 * self.scale


def around(scale: float, low: float, high: float, *starts: float) -> Spec:
    """Spec of a smooth number."""
    return Spec(scale, low, high, starts)


SPECS: dict[str, tuple[Spec, ...]] = {
    "current": (around(0.1, -1.5, 1.5, 0.0), around(0.1, -1.5, 1.5, 0.0)),
    "drifting_current": (
        around(0.1, -1.5, 1.5, 0.0),
        around(0.1, -1.5, 1.5, 0.0),
        around(0.002, -0.05, 0.05, 0.0),
        around(0.002, -0.05, 0.05, 0.0),
    ),
    "wind": (around(2.0, -20.0, 20.0, 0.0), around(2.0, -20.0, 20.0, 0.0)),
    "shallow_water": (around(1.0, 1.5, 9.0, 1.8, 3.0),),
    "thruster_gain": (around(0.2, 0.0, 2.5, 0.8),),
    "thruster_failure": (Spec(5.0, 0.0, 1e4, (), step=0.2),),
    "azimuth_offset": (around(0.1, -1.6, 1.6, 0.0),),
    "azimuth_lag": (around(0.2, 0.0, 4.0, 0.4, 1.2),),
    "command_delay": (Spec(0.2, 0.0, 2.0, (0.25, 0.7), step=0.02),),
    "pump_lag": (around(0.2, 0.0, 4.0, 0.4, 1.2),),
    "thrust_scale": (around(0.2, 0.1, 3.0, 0.9),),
    "advance_thrust_loss": (around(0.2, 0.0, 5.0, 0.3),),
    "crossflow_thrust_loss": (around(5.0, 0.0, 250.0, 5.0, 25.0),),
    "thrust_sag": (around(0.002, 0.0, 0.05, 0.002),),
    "resistance": (around(0.2, 0.05, 6.0, 1.1),),
    "linear_drag": (around(3.0, -40.0, 80.0, 2.0),),
    "mass": (around(8.0, 20.0, 150.0),),
    "centre_of_gravity": (around(0.05, -0.5, 0.5, 0.0),),
    "yaw_inertia": (around(0.2, 0.2, 5.0, 1.1),),
    "sway_drag": (around(0.2, 0.0, 6.0, 1.1),),
    "yaw_damping": (around(0.3, -3.0, 8.0, 1.1),),
    "hull_asymmetry": (around(1.0, -30.0, 30.0, 0.0),),
    "external_force": (around(1.0, -30.0, 30.0, 0.0), around(1.0, -30.0, 30.0, 0.0)),
    "heading_bias": (around(0.05, -1.5, 1.5, 0.0),),
    "position_delay": (Spec(0.2, 0.0, 2.0, (0.3,), step=0.02),),
    "position_lever_arm": (around(0.2, -2.0, 2.0, 0.0), around(0.2, -2.0, 2.0, 0.0)),
}


@dataclass(frozen=True)
class Atom:
    """One candidate: an effect, on the thrusters it names, with the numbers x (p,) that a fit may move.

    values: x -> the effect's parameters.
    starts: points (p,) that a fit is begun from; grid: points that are only looked at, the best being
    polished.
    """

    effect: Effect
    selectors: tuple[str, ...]
    specs: tuple[Spec, ...]
    starts: tuple[tuple[float, ...], ...]
    grid: tuple[tuple[float, ...], ...] = ()
    names: tuple[str, ...] = ()
    values: Callable[[Array], Values] = field(default=dict, hash=False, compare=False)

    @property
    def label(self) -> str:
        """Name with its thrusters, unique among candidates."""
        return " ".join((self.effect.name, *self.selectors))

    @property
    def size(self) -> int:
        """How many numbers are fitted."""
        return len(self.specs)

    @property
    def moves_actuators(self) -> bool:
        """Whether the actuators' own course changes with it, not only what they push."""
        return self.effect.acts_on == "command" or self.effect.name in LAGS


@dataclass(frozen=True)
class Hypothesis:
    """Atoms that act together; no atom: the boat file is right."""

    atoms: tuple[Atom, ...] = ()

    @property
    def specs(self) -> tuple[Spec, ...]:
        """Of all numbers, atom after atom."""
        return tuple(spec for atom in self.atoms for spec in atom.specs)

    @property
    def size(self) -> int:
        """How many numbers are fitted."""
        return len(self.specs)

    @property
    def label(self) -> str:
        """Atoms' labels joined."""
        return " + ".join(atom.label for atom in self.atoms) or "nothing"

    @property
    def accused(self) -> str:
        """Labels of the atoms less the hull's derivatives, which no file has exactly, unless they are all."""
        named = [atom.label for atom in self.atoms if atom.effect.name != NUISANCE]
        return " + ".join(named) or self.label

    @property
    def moves_actuators(self) -> bool:
        """Whether the actuators' own course changes with it."""
        return any(atom.moves_actuators for atom in self.atoms)

    def with_atom(self, atom: Atom) -> "Hypothesis":
        """This hypothesis and one more atom, effects in an order of their own so that equal sets are
        equal.
        """
        return Hypothesis(tuple(sorted((*self.atoms, atom), key=lambda one: one.label)))

    def without(self, label: str) -> "Hypothesis":
        """This hypothesis less the atom of that label."""
        return Hypothesis(tuple(atom for atom in self.atoms if atom.label != label))

    def bounds(self) -> tuple[Array, Array]:
        """(p,) least and (p,) most."""
        return np.array([s.low for s in self.specs]), np.array([s.high for s in self.specs])

    def prior(self) -> tuple[Array, Array]:
        """(p,) prior mean and (p,) precision, 0 where there is none; the mean is 1: scales of
        coefficients.
        """
        precision = np.array([0.0 if s.prior is None else s.prior**-2 for s in self.specs])
        return np.ones(self.size), precision

    def parts(self, x: Array) -> list[tuple[Atom, Array]]:
        """Each atom with its own columns of x (..., p)."""
        ends = list(itertools.accumulate((atom.size for atom in self.atoms), initial=0))
        return [(atom, x[..., ends[i] : ends[i + 1]]) for i, atom in enumerate(self.atoms)]

    def entries(self, x: Array) -> list[EffectEntry]:
        """The effects with their numbers; x: (p,) or (V, p) for V boats at once."""
        return [entry for atom, own in self.parts(x) for entry in entries_of(atom, own)]

    def records(self, boat: Boat, x: Array, plain: NDArray[Any] | None = None) -> NDArray[Any]:
        """(V,) parameter records of the boat with x (V, p); plain: (1,) the boat's own, if at hand."""
        record = np.repeat(parameters(boat) if plain is None else plain, len(x))
        apply_effects(record, self.entries(x), boat.thruster_names)
        return record


def entries_of(atom: Atom, x: Array) -> list[EffectEntry]:
    """One atom as effect entries; x: (..., p)."""
    values = (
        atom.values(x)
        if atom.values is not dict
        else dict(zip(atom.names, np.moveaxis(x, -1, 0), strict=True))
    )
    thruster = atom.selectors if atom.effect.swaps else atom.selectors[0] if atom.selectors else None
    return [EffectEntry(atom.effect, thruster, values)]  # type: ignore[arg-type]


def wind_values(x: Array) -> Values:
    """Wind from its vector: components [m/s] towards where it comes from."""
    return {"speed": np.hypot(x[..., 0], x[..., 1]), "from": np.arctan2(x[..., 1], x[..., 0])}


def wave_values(x: Array) -> Values:
    """Waves from frequency [Hz], push towards south and west [N] and phase [rad]; of the two ways to say the
    same, the one whose phase lies within a quarter turn of 0.
    """
    turned = np.cos(x[..., 3]) < 0.0
    coming = np.arctan2(x[..., 2], x[..., 1]) + np.pi * turned
    return {
        "force": np.hypot(x[..., 1], x[..., 2]),
        "frequency": x[..., 0],
        "from": np.arctan2(np.sin(coming), np.cos(coming)),
        "phase": np.arctan(np.tan(x[..., 3])),
    }


def clipped(spec: Spec, effect: Effect, name: str) -> Spec:
    """The spec within what the library allows."""
    parameter = effect.parameter(name)
    low = max(spec.low, parameter.low + (1e-6 * spec.scale if parameter.above_low else 0.0))
    return Spec(spec.scale, low, min(spec.high, parameter.high), spec.starts, spec.step, spec.prior)


def candidates(boat: Boat, duration: float) -> list[Atom]:
    """Every atom for a boat; duration [s] of the longest run bounds what happens at an instant."""
    found: list[Atom] = []
    for effect in LIBRARY.values():
        if effect.name in NOT_CAUSES or effect.name == NUISANCE:
            continue
        special = SPECIAL.get(effect.name)
        found += special(effect, boat, duration) if special else plain(effect, boat)
    return found


def plain(effect: Effect, boat: Boat) -> list[Atom]:
    """Atoms of an effect whose parameters are fitted as they are."""
    given = SPECS.get(effect.name) or tuple(guessed(effect, name) for name in effect.parameter_names)
    specs = tuple(clipped(s, effect, n) for s, n in zip(given, effect.parameter_names, strict=True))
    starts = tuple(itertools.product(*(s.starts for s in specs)))
    return [
        Atom(effect, chosen, specs, starts, names=effect.parameter_names)
        for chosen in selectors(effect, boat)
    ]


def guessed(effect: Effect, name: str) -> Spec:
    """A spec for a parameter that this file does not know: about its neutral value."""
    neutral = effect.parameter(name).neutral or 0.0
    scale = 0.2 * abs(neutral) or 0.1
    return Spec(scale, neutral - 20 * scale, neutral + 20 * scale, (neutral,))


def selectors(effect: Effect, boat: Boat) -> list[tuple[str, ...]]:
    """Whom an effect may name: nobody, each thruster, two of them; a mounting error also all."""
    if effect.swaps:
        return list(itertools.combinations(boat.thruster_names, 2))
    if not effect.thruster:
        return [()]
    each: list[tuple[str, ...]] = [(name,) for name in boat.thruster_names]
    if effect.name == "thruster_gain" and len(each) == 1:  # that is `thrust_scale`, by another name
        return []
    return [*each, ("all",)] if effect.name == "azimuth_offset" and len(each) > 1 else each


def _wind(effect: Effect, boat: Boat, duration: float) -> list[Atom]:
    grid = tuple(
        (speed * math.cos(a), speed * math.sin(a))
        for speed in (1.2, 3.0, 7.0)
        for a in np.arange(8) * math.pi / 4
    )
    return [Atom(effect, (), SPECS["wind"], (), grid, ("speed", "from"), wind_values)]


def _waves(effect: Effect, boat: Boat, duration: float) -> list[Atom]:
    """Its starts are found by a scan of the data, see `harmonic`."""
    push, angle = around(2.0, -200.0, 200.0), around(0.5, -math.inf, math.inf)
    specs = (Spec(0.02, 0.01, 3.0, ()), push, push, angle)
    return [Atom(effect, (), specs, (), (), ("force", "frequency", "from", "phase"), wave_values)]


def _failure(effect: Effect, boat: Boat, duration: float) -> list[Atom]:
    spec = SPECS["thruster_failure"][0]
    spec = Spec(spec.scale, 0.0, duration, (), spec.step)
    return [Atom(effect, (name,), (spec,), (), (), ("time",)) for name in boat.thruster_names]


def _mass(effect: Effect, boat: Boat, duration: float) -> list[Atom]:
    spec = Spec(0.15 * boat.mass, 0.4 * boat.mass, 2.5 * boat.mass, (boat.mass,))
    return [Atom(effect, (), (spec,), ((boat.mass,),), names=("mass",))]


def _centre_of_gravity(effect: Effect, boat: Boat, duration: float) -> list[Atom]:
    spec = Spec(0.04 * boat.length, -0.4 * boat.length, 0.4 * boat.length, (boat.x_g,))
    return [Atom(effect, (), (spec,), ((boat.x_g,),), names=("x_g",))]


def _thrust_deduction(effect: Effect, boat: Boat, duration: float) -> list[Atom]:
    own = parameters(boat)[0]
    start = (float(own["deduction_factor_low"]), float(own["deduction_factor_high"]))
    specs = tuple(Spec(0.15, 0.05, 1.5, (value,)) for value in start)
    return [Atom(effect, (), specs, (start,), names=effect.parameter_names)]


def _demihull_spacing(effect: Effect, boat: Boat, duration: float) -> list[Atom]:
    spec = Spec(0.2 * boat.breadth, 0.0, 2.0 * boat.breadth, (0.4 * boat.breadth, 0.9 * boat.breadth))
    return [Atom(effect, (), (spec,), tuple((start,) for start in spec.starts), names=("spacing",))]


SPECIAL: dict[str, Callable[[Effect, Boat, float], list[Atom]]] = {
    "wind": _wind,
    "waves": _waves,
    "thruster_failure": _failure,
    "mass": _mass,
    "centre_of_gravity": _centre_of_gravity,
    "thrust_deduction": _thrust_deduction,
    "demihull_spacing": _demihull_spacing,
}


def hull_nuisance() -> Atom | None:
    """The linear derivatives' scales, each with a prior about 1; None where the library has no such
    effect.
    """
    effect = LIBRARY.get(NUISANCE)
    if effect is None:
        return None
    spec = Spec(0.1, 1.0 / HULL_LIMIT - 0.2, HULL_LIMIT, (1.0,), prior=NUISANCE_SD)
    specs = tuple(spec for _ in effect.parameters)
    return Atom(effect, (), specs, ((1.0,) * len(specs),), names=effect.parameter_names)


def by_label(atoms: Sequence[Atom]) -> Mapping[str, Atom]:
    """Atoms by their labels."""
    return {atom.label: atom for atom in atoms}

"""The posterior of a diagnosis as a level of disturbance, to train pilots with randomised parameters."""

import math
import os
from collections.abc import Sequence
from itertools import compress
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from swamp_rl.boat import load_boat
from swamp_rl.clipped import clipped
from swamp_rl.criticism.model.extended_boat import BOAT
from swamp_rl.criticism.nuisance.random_effect import widening
from swamp_rl.criticism.options import options
from swamp_rl.criticism.report.words import in_file_names
from swamp_rl.criticism.result import Cause, Diagnosis, Estimate, Extension
from swamp_rl.effects.declare import LIBRARY, Parameter
from swamp_rl.effects.entries import ALL, nearest_effect
from swamp_rl.effects.levels import Level, level_of, read_level
from swamp_rl.effects.random_entry import COMPONENTS, RandomEntry
from swamp_rl.errors import UserError
from swamp_rl.explain import explanations, nearest
from swamp_rl.files import read_yaml, write_yaml
from swamp_rl.json_text import model_in
from swamp_rl.ordinary import MOST_JSON, contents
from swamp_rl.printed_figures.result import FiguresDiagnosis
from swamp_rl.simulator.reference import size_of

REMEDY = "name a diagnosis.json of swamp-rl diagnose"


def write_posterior(diagnosis: Path, out: Path, among: str | None = None) -> dict[str, Any]:
    """Write the level of the causes in a `diagnosis.json` to `out`, a YAML file, and return it.

    Each parameter is normal with its estimate and standard error, truncated at the effect's bounds, and
    correlated as in the diagnosis. One at a bound of the fit, or that the runs do not determine, is constant:
    its standard error is meaningless. What differs between runs is drawn for another run: from the normal
    distribution of the runs, a vector by component, its variance that of the runs and of their mean, which
    Student's t does not widen; it is drawn by itself. among: a level whose start, other effects, and the same
    effects of other thrusters are included, in proportion to the boat of the `extended_boat.yaml` beside the
    diagnosis. A cause that does not carry over to held-out runs is left out, as it is of that file. A missing
    force that the file has is constant, with the effects that were fitted beside it. UserError where the
    diagnosis cannot be read or has no cause left, or that level cannot be read, has correlations of its own,
    or an effect of `all` thrusters that the diagnosis has of one.
    """
    found = _read(diagnosis)
    every, curves, correlation = _written(found)
    if not (curves or any(cause.carries_over for cause in found.causes)):
        none = "none that carries over to held-out runs" if found.causes else "no cause"
        raise UserError(f"{diagnosis}: names {none}, so there is nothing to draw; train in the boat itself")
    below, level_below = ({}, None) if among is None else _in_proportion(among, diagnosis.parent)
    if level_below and level_below.correlated:
        raise UserError(f"{among}: has correlated numbers of its own; name a level without them")
    causes = [cause for cause in every if cause.carries_over]
    entries = [_entry(cause, diagnosis) for cause in causes]
    pairs = zip(below.get("effects", []), level_below.entries, strict=True) if level_below else ()
    others = [kept for entry, read in pairs if (kept := _other_thrusters(entry, read, causes, f"{among}"))]
    beside = f", among the disturbances of {Path(among).stem}" if among else ""
    level = below | {
        "description": f"result of a diagnosis, with its standard errors{beside}; for the boat that was "
        f"diagnosed: {BOAT} has these effects already" + "".join(f"; {one}" for one in _limits(found)),
        "effects": entries + curves + others,
        **_correlated(entries, [bool(one.spread) for one in causes], _carried(correlation, every)),
    }
    level_of(level, f"{diagnosis}")
    write_yaml(out, level)
    return level


def posterior_limits(diagnosis: Path) -> list[str]:
    """What the level of a `diagnosis.json` leaves out, one line each; UserError as `write_posterior`."""
    return _limits(_read(diagnosis))


def _limits(found: Diagnosis | FiguresDiagnosis) -> list[str]:
    if found.verdict == "unexplained" and _force_of(found):
        return [
            "verdict unexplained: force_curve stands for what no effect explains, in the range of the runs"
        ]
    if found.verdict == "unexplained":
        return ["verdict unexplained: these effects explain a part of the model error, the rest is left out"]
    if found.verdict == "indistinguishable":
        others = [label for labels in found.indistinguishable for label in labels[1:]]
        return [f"verdict indistinguishable: the cause may also be {in_file_names(' or '.join(others))}"]
    return []


def _written(
    found: Diagnosis | FiguresDiagnosis,
) -> tuple[list[Cause], list[dict[str, Any]], list[list[float]]]:
    """The estimates that the extended boat has, its missing force as entries, and the correlations."""
    force = _force_of(found)
    if force is None:
        return [*found.causes, *found.nuisance], [], found.correlation
    curves = [one.model_dump(exclude={"units"}, exclude_none=True) for one in force.curves]
    return force.beside, [{"effect": "force_curve", **one} for one in curves], []


def _force_of(found: Diagnosis | FiguresDiagnosis) -> Extension | None:
    """The missing force that the extended boat has, if any."""
    force = found.extension if isinstance(found, Diagnosis) else None
    return force if force and force.written else None


def diagnosed_boat(diagnosis: Path) -> str | None:
    """The boat of a diagnosis, by name or file, by the `extended_boat.yaml` beside it; None if none."""
    extended = diagnosis.parent / BOAT
    base = read_yaml(extended).get("extends") if extended.is_file() else None
    if not isinstance(base, str):
        return None
    beside = Path(os.path.normpath(diagnosis.parent / base))
    return str(beside) if beside.is_file() else base


def _in_proportion(among: str, folder: Path) -> tuple[dict[str, Any], Level]:
    """A level for the extended boat in a folder, as it stands where there is none."""
    boat_file = folder / BOAT
    if not boat_file.is_file():
        return read_level(among)
    boat = load_boat(boat_file)
    return read_level(among, size_of(boat), boat.thruster_names)


def _other_thrusters(
    entry: dict[str, Any], read: RandomEntry, causes: Sequence[Cause], where: str
) -> dict[str, Any] | None:
    """An entry of a level for the thrusters of which no cause is the same effect; None where none is left."""
    same = [_names(cause.thruster) for cause in causes if cause.effect == read.effect.name]
    taken = set[str]().union(*same)
    if taken and ALL in read.selectors and ALL not in taken:
        message = f"{read.effect.name} of all thrusters includes {' and '.join(sorted(taken))}"
        raise UserError(f"{where}: {message}, which the diagnosis has; name the others one by one")
    kept = [one for one in read.selectors if ALL not in taken and not taken & _names(one)]
    if len(kept) == len(read.selectors):
        return entry
    choice = [list(one) if isinstance(one, tuple) else one for one in kept]
    return entry | {"thruster": {"choice": choice}} if kept else None


def _names(thruster: str | Sequence[str] | None) -> set[str]:
    """The thrusters that an effect is of; `all` where it names none."""
    return {thruster} if isinstance(thruster, str) else set(thruster or (ALL,))


def _read(path: Path) -> Diagnosis | FiguresDiagnosis:
    """A diagnosis of runs, or of printed figures, which has stages."""
    try:
        text = contents(path, MOST_JSON)
        model: type[Any] = FiguresDiagnosis if b'"stages"' in text else Diagnosis
        found: Diagnosis | FiguresDiagnosis = model_in(text, model)
        return found
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}; {REMEDY}") from error
    except ValidationError as error:
        where, message = explanations(error, model)[0]
        raise UserError(f"{path}: {where + ': ' if where else ''}{message}; {REMEDY}") from error
    except ValueError as error:
        raise UserError(f"{path}: is no JSON ({clipped(error)}); {REMEDY}") from error


def _entry(cause: Cause, where: Path) -> dict[str, Any]:
    effect = LIBRARY.get(cause.effect)
    if effect is None:
        raise UserError(f"{where}: no effect {cause.effect!r}{nearest_effect(cause.effect)}")
    for name, found in cause.parameters.items():
        if name not in effect.parameter_names:
            raise UserError(f"{where}: {cause.effect}: no {name!r}{nearest(name, effect.parameter_names)}")
        if found.standard_error < 0.0:
            raise UserError(f"{where}: {cause.effect}: {name}: its error is negative; diagnose again")
    thruster = {} if cause.thruster is None else {"thruster": cause.thruster}
    if cause.spread and effect.vector:
        return {"effect": cause.effect, **thruster, COMPONENTS: _between_runs(cause, *effect.vector)}
    numbers = {
        name: _drawn(effect.parameter(name), _of_another_run(cause, name)) for name in cause.parameters
    }
    return {"effect": cause.effect, **thruster, **numbers}


def _of_another_run(cause: Cause, name: str) -> Estimate:
    """A parameter as it is for another run: its mean, the variance that of the runs and of the mean."""
    found = cause.parameters[name]
    if name not in cause.spread:
        return found
    size = math.hypot(found.standard_error / _widening(cause), cause.spread[name].value)
    return found.model_copy(update={"standard_error": size, "at_bound": False})


def _widening(cause: Cause) -> float:
    """By what factor Student's t widened the standard errors of the mean over runs or days."""
    differs = any(one.value > 0.0 for one in cause.spread.values())
    return widening(len(cause.groups), len(cause.spread)) if differs else 1.0


def _between_runs(cause: Cause, size: str, direction: str) -> dict[str, Any]:
    """The components of a vector that differs between runs, by name, each drawn."""
    length, angle = (cause.parameters[name] for name in (size, direction))
    along, across = length.standard_error, length.value * angle.standard_error
    drawn = {}
    for name, part, other in (("north", math.cos, math.sin), ("east", math.sin, math.cos)):
        mean = length.value * part(angle.value)
        of_mean = math.hypot(along * part(angle.value), across * other(angle.value)) / _widening(cause)
        deviation = math.hypot(of_mean, cause.spread[name].value)
        reach = options().posterior_reach * deviation
        ends = [mean - reach, mean + reach]
        drawn[name] = {"normal": [mean, deviation, *ends]} if deviation > 0.0 else mean
    return drawn


def _carried(matrix: list[list[float]], causes: Sequence[Cause]) -> list[list[float]]:
    """The correlations of the parameters of the causes that carry over."""
    stays = [cause.carries_over for cause in causes for _ in cause.parameters]
    rows = [list(compress(row, stays)) for row in compress(matrix, stays)]
    return rows if len(matrix) == len(stays) else []


def _correlated(
    entries: list[dict[str, Any]], differs: list[bool], matrix: list[list[float]]
) -> dict[str, Any]:
    """The key `correlated` of the random parameters, but of entries that differ between runs; nothing where
    none are correlated.
    """
    every = [
        (f"{place}.{name}", isinstance(value, dict) and not differs[place])
        for place, entry in enumerate(entries)
        for name, value in (entry | entry.get(COMPONENTS, {})).items()
        if name not in ("effect", "thruster", COMPONENTS)
    ]
    drawn = [i for i, (_, is_drawn) in enumerate(every) if is_drawn]
    square = len(matrix) == len(every) and all(len(row) == len(every) for row in matrix)
    if not square or len(drawn) < 2:
        return {}
    chosen = [[matrix[i][j] for j in drawn] for i in drawn]
    return {"correlated": {"numbers": [every[i][0] for i in drawn], "matrix": chosen}}


def _drawn(parameter: Parameter, found: Estimate) -> float | dict[str, list[float]]:
    value, doubt = found.value, found.standard_error
    if found.at_bound or not found.identifiable or not doubt > 0.0:
        return value
    lowest = math.nextafter(parameter.low, math.inf) if parameter.above_low else parameter.low
    reach = options().posterior_reach * doubt
    low, high = max(value - reach, lowest), min(value + reach, parameter.high)
    return {"normal": [value, doubt, low, high]}

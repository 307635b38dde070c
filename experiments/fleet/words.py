"""The findings of a fleet in words, as its report and the terminal have them."""

import math
from collections.abc import Collection, Sequence

from swamp_rl.experiments.fleet.labels import explanations_with, least_doubtful
from swamp_rl.experiments.fleet.result import BoatCauses, Change, Drift, Fleet, MemberCause, SharedCause

from swamp_rl.counted import counted, few
from swamp_rl.criticism.report.words import in_degrees, readable
from swamp_rl.criticism.result import Estimate
from swamp_rl.digits import digits, known
from swamp_rl.html_page import minus, places_of

DIFFERS = {"day": "another on each day", "run": "another in each run"}


def effect_words(label: str) -> str:
    """`thruster gain (port)` of `thruster_gain port`."""
    name, _, curve = label.partition(" ")
    return f"force: {curve.replace('_', ' ')}" if name == "force_curve" else readable(label)


def listed(labels: Sequence[str]) -> str:
    """Causes in words, one after another."""
    return ", ".join(effect_words(one) for one in labels)


def weather_words(one: MemberCause) -> str:
    """An effect of weather, with its values where all runs share them."""
    if one.scope == "boat":
        return cause_words(one)
    return f"{effect_words(one.cause)} by {one.scope}".replace(" ", "\N{NO-BREAK SPACE}")


def cause_words(one: MemberCause) -> str:
    """A cause with its values and standard errors; means, of one that differs between runs or days."""
    name, parts = effect_words(one.cause), []
    if one.scope in DIFFERS:
        name, parts = f"{name}, {DIFFERS[one.scope]}", ["mean"] if one.parameters else []
    if list(one.parameters) == [one.cause]:  # mass 38.9 kg, of the effect mass
        parts.append(estimate_words(one.parameters[one.cause]))
        return " ".join([name, *parts])
    values = [f"{key.replace('_', ' ')} {estimate_words(one)}" for key, one in one.parameters.items()]
    return ": ".join([name, " ".join([*parts, ", ".join(values)])]) if values else name


def estimate_words(given: Estimate) -> str:
    """Value, standard error and unit, angles in degrees; no error at a bound of the fit."""
    factor, unit = in_degrees(given.unit)
    value, error = factor * given.value, factor * given.standard_error
    if not given.identifiable:
        return "not determined by these runs"
    if given.at_bound:
        side = f"{given.limit.replace('_', ' ')} " if given.limit else "at the bound of the fit, "
        return minus(f"{side}{digits(value, 3)} {unit}".strip())
    if not (0.0 < error < math.inf):
        return minus(f"{digits(value, 4)} {unit}".strip())
    return f"{minus(value_and_error(value, error))} {unit}".strip().replace(" ", "\N{NO-BREAK SPACE}")


def value_and_error(value: float, error: float) -> str:
    """A value and its standard error, to the second digit of that."""
    if error < 1e-4:
        return f"{known(value, error, 6)} ± {digits(error, 2)}"
    places = places_of(error, 2)
    return f"{value:.{places}f} ± {error:.{places}f}"


def equivalents(explanations: Sequence[str]) -> str:
    """What explanations that cannot be distinguished do not have in common, joined by `or`."""
    sets = [one.split(" + ") for one in explanations]
    common = set(sets[0]).intersection(*sets)
    parts = [[readable(part) for part in one if part not in common] for one in sets]
    return " or ".join(" + ".join(part) or "neither" for part in parts)


def weather_sentence(fleet: Fleet) -> str:
    """The weather of the runs, which is no cause of a boat's; empty where none was found."""
    if not fleet.weather:
        return ""
    listed = (f"{effect_words(one.cause)} ({', '.join(one.boats)})" for one in fleet.weather)
    return f"Weather, which is not the boats' and is left out: {'; '.join(listed)}."


def shared_words(one: SharedCause, fleet: Fleet) -> str:
    """A shared cause and what it is likely to be."""
    words = f"{len(one.boats)} of {counted(len(fleet.boats), 'boat')} share {effect_words(one.cause)}"
    return f"{words}, likely an error of their common boat file" if one.in_boat_file else words


def warning_sentence(fleet: Fleet) -> str:
    """Where the boat file predicts no better than a trivial predictor; empty if it is better everywhere.

    Where one file serves all and does better in most datasets, it is the others that differ from it.
    """
    warned = [one for one in fleet.members if one.warning]
    diagnosed = [one for one in fleet.members if one.verdict]
    if not warned:
        return ""
    sentence = (
        f"In {len(warned)} of {counted(len(diagnosed), 'dataset')} ({few([one.name for one in warned])}) the "
        "boat file predicts "
        "positions no better than a trivial predictor"
    )
    if len({one.boat_file for one in diagnosed} - {None}) == 1 and len(warned) < len(diagnosed) / 2:
        return f"{sentence}, in the others better: these boats differ from it most."
    example = min(warned, key=lambda one: one.verdict == "cause")  # of a cause that explains it if none else
    return f"{sentence}. {example.name}: {example.warning}"


def change_words(one: Change) -> str:
    """A cause of some days."""
    found, absent = ", ".join(one.found_in), ", ".join(one.absent_in)
    return f"{one.boat}: {effect_words(one.cause)} found in {found}, not in {absent}"


def causes_of_boat(boat: BoatCauses, fleet: Fleet) -> str:
    """The causes of a boat, with the number of explanations that have one where each dataset has equivalent
    ones without it."""
    own = [one for one in fleet.members if one.boat == boat.boat]
    found = []
    for cause in boat.causes:
        has = [one.indistinguishable for one in own if cause in {each.cause for each in one.causes}]
        those, every = least_doubtful(explanations_with(cause, one) for one in has)
        found.append(
            effect_words(cause) + (f" [in {those} of {every} explanations]" if those < every else "")
        )
    return ", ".join(found)


def drift_values(one: Drift) -> list[tuple[str, str]]:
    """Each dataset and its value with the standard error, angles in degrees."""
    factor, _ = in_degrees(one.unit)
    errors = {name: factor * error for name, error in one.standard_errors.items()}
    return [(name, value_and_error(factor * value, errors[name])) for name, value in one.values.items()]


def drift_words(one: Drift) -> str:
    """What differs between the datasets of a boat, with its unit and values."""
    _, unit = in_degrees(one.unit)
    name, parameter = effect_words(one.cause), one.parameter.replace("_", " ")
    if not one.cause.split()[0].endswith(one.parameter):  # mass, not mass mass
        name += f" {parameter}"
    values = ", ".join(map(" ".join, drift_values(one)))
    return f"{one.boat}: {name} differs{f' [{unit}]' if unit else ''}: {values}"


def boat_lines(fleet: Fleet) -> list[str]:
    """The causes of each boat that has any, and the boats without."""
    lines = [f"{one.boat}: {causes_of_boat(one, fleet)}" for one in fleet.boats if one.causes]
    lesser = [f"{one.boat} ({listed(one.lesser)})" for one in fleet.boats if one.lesser and not one.causes]
    lines += [f"only minor causes, or not kept ones: {'; '.join(lesser)}"] if lesser else []
    healthy = [one.boat for one in fleet.boats if not one.causes and not one.lesser]
    return lines + ([f"no cause of their own: {', '.join(healthy)}"] if healthy else [])


def not_kept(fleet: Fleet) -> Collection[tuple[str, str]]:
    """Dataset and label of each cause that does not stand at the false discovery rate."""
    return {(one.name, one.cause) for one in fleet.findings if not one.kept}


def outcome_lines(fleet: Fleet) -> list[str]:
    """What the terminal says of a fleet, a line each."""
    lines = boat_lines(fleet)
    lines += [f"{shared_words(one, fleet)}: {', '.join(one.boats)}" for one in fleet.shared]
    lines += [drift_words(one) for one in fleet.drifts]
    lines += [change_words(one) for one in fleet.changes]
    lines += [one for one in (weather_sentence(fleet), warning_sentence(fleet)) if one]
    failed = [one.name for one in fleet.members if one.verdict is None]
    return lines + ([f"not diagnosed, see above or fleet.html: {few(failed)}"] if failed else [])

"""A diagnosis in words that need no knowledge of the code."""

import math
from collections.abc import Sequence

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.criticism.data import CHANNELS, UNITS
from swamp_rl.criticism.result import Cause, Diagnosis, Estimate, Limit
from swamp_rl.effects import LIBRARY

Z95 = 1.959964


def spoken(label: str) -> str:
    """`azimuth_lag + thruster_gain bs` as `azimuth lag and thruster gain (bs)`."""
    if label == "nothing":
        return "nothing added"
    found = []
    for part in label.split(" + "):
        name, *thrusters = part.split()
        found.append(name.replace("_", " ") + (f" ({', '.join(thrusters)})" if thrusters else ""))
    return " and ".join([", ".join(found[:-1]), found[-1]] if len(found) > 1 else found)


def causes(found: Diagnosis) -> str:
    """The causes by name, joined."""
    labels = []
    for cause in found.causes:
        on = [cause.thruster] if isinstance(cause.thruster, str) else list(cause.thruster or ())
        labels.append(" ".join([cause.effect, *on]))
    return spoken(" + ".join(labels)) if labels else "nothing"


def headline(found: Diagnosis) -> str:
    """The verdict as one sentence."""
    if found.verdict == "nothing_wrong":
        return "The simulation is as right as these sensors can tell."
    if found.verdict == "cause":
        return (
            f"The simulation misses one thing: {causes(found)}."
            if len(found.causes) == 1
            else (f"The simulation misses {len(found.causes)} things: {causes(found)}.")
        )
    if found.verdict == "indistinguishable":
        names = [spoken(name) for name in found.indistinguishable[0]] if found.indistinguishable else []
        if len(names) > 2:
            which = f"which of {len(names)} it is: {either(names)}"
            return f"The misfit is real, but these data cannot tell {which}."
        return f"The misfit is real, but these data cannot tell {' from '.join(names)}."
    return "Something is at work that no known effect explains." + partly(found)


def either(names: Sequence[str]) -> str:
    """Explanations, each perhaps of several effects, as alternatives."""
    if any(" and " in name for name in names):
        return "; or ".join(names)
    return f"{', '.join(names[:-1])} or {names[-1]}"


def partly(found: Diagnosis) -> str:
    """What stands out from a misfit that stays unexplained, and what would do as well."""
    if not found.causes:
        return ""
    others = [spoken(name) for group in found.indistinguishable for name in group[1:]]
    instead = f", or just as well {others[0]}" if others else ""
    if len(others) > 1:
        instead = f", or one of {len(others)} others that predict as well (see below)"
    return f" Part of the misfit is {causes(found)}{instead}."


def meaning(found: Diagnosis) -> str:
    """What the verdict means for whoever has the boat."""
    if found.verdict == "nothing_wrong":
        return (
            "What its predictions miss is what the sensors' noise makes of a perfect simulation. Nothing "
            "need be added to the boat file. What these data could not show is listed below."
        )
    if found.verdict == "cause":
        added = "it" if len(found.causes) == 1 else "them"
        told = (
            f"With {added}, what remains is sensor noise. The numbers below are fitted and can be used at "
            "once: extended_boat.yaml is the boat file with them."
        )
        if any(one.at_bound for cause in found.causes for one in cause.parameters.values()):
            told += (
                " One ended at the edge of what is tried, so its effect may stand in for another: look twice."
            )
        return told
    if found.verdict == "indistinguishable":
        return (
            "Each of these explanations brings the misfit down to sensor noise, so choosing one would be a "
            "guess. extended_boat.yaml holds the one that fits best; predictions of runs like these are safe "
            "with it, others are not. A trial that would decide is named below."
        )
    tried = "Every effect of the library was tried, alone and beside others, and more than noise remains. "
    if not found.leftover:
        return tried + "Nor does what is missing go with any one thing that was recorded."
    return tried + "Which force is missing, and what it goes with, stands below: look there on the real boat."


def force_name(force: str) -> str:
    """`yaw` as `yaw moment`, `thrust of bs` as it is."""
    return force if " " in force else f"{force} {'moment' if force == 'yaw' else 'force'}"


def leftover_sentence(found: Diagnosis) -> str:
    """Where the largest of what remains lives."""
    first = found.leftover[0]
    what = "a lack or an excess of " if first.force.startswith("thrust of") else "a "
    return (
        f"Most of it is {what}{force_name(first.force)} that goes with {first.variable}: on runs that this "
        f"was not told from, {first.variable} foretells {first.explained:.0%} of its power."
    )


def rest_sentence(found: Diagnosis) -> str:
    """Where what remains lives, or that it is not to be told."""
    if found.leftover:
        return leftover_sentence(found)
    return (
        "No single variable explains a share of the missing forces worth naming on runs that this was not "
        "told from. It may be somebody's hand, a place, or two things at once: look at the missing forces "
        "above."
    )


def shape_sentence(found: Diagnosis) -> str:
    """What the pictures of missing forces show."""
    beside = found.leftover[0].beside
    file = f"the boat file with {spoken(' + '.join(beside))}" if beside else "the boat file"
    return (
        f"Their shapes, as all runs tell them: what {file} lacks, counted positive ahead, to starboard, to "
        "the north or to the east, and of a moment that turns to starboard. The band is the 95 % interval if "
        "nothing else is missing. A step, a kink or a slope here is what the missing effect should have."
    )


def gain_sentence(found: Diagnosis) -> str:
    """That what was found predicts no better, where that is so."""
    gain = next((one for one in found.gain if one.horizon_s == 10.0 and one.position_rmse_m), None)
    if gain is None or gain.position_rmse_m is None or not found.causes:
        return ""
    low, high = gain.position_rmse_m.ci95
    if low > 0.0:
        return ""
    if high < 0.0:
        return "With it positions 10 s ahead are predicted worse: do not predict with extended_boat.yaml. "
    return "Of positions 10 s ahead the change is within chance. "


def wandering_sentence(found: Diagnosis) -> str:
    """Errors that last, where some were found: a receiver's, or the model's own."""
    if not found.wandering:
        return ""
    parts = []
    for name, one in found.wandering.items():
        unit = dict(zip(CHANNELS, UNITS, strict=True))[name]
        factor, shown = (180.0 / math.pi, unit.replace("rad", "degrees")) if "rad" in unit else (1.0, unit)
        parts.append(f"{name.replace('_', ' ')} {rounded(factor * one.standard_deviation)} {shown}")
    seconds = max(one.time_constant_s for one in found.wandering.values())
    whose = (
        "Beside that noise positions wander"
        if set(found.wandering) <= {"north", "east"}
        else "Beside that noise the simulation itself is off, for seconds at a time"
    )
    return f"{whose} (standard deviation): {', '.join(parts)}; such errors fade over {seconds:.2g} s."


def closeness(verdict: str) -> str:
    """What the columns of the table of explanations say."""
    if verdict == "unexplained":
        return (
            "None of these explains all, so none is judged by how well it fits: they are here because "
            "windows that they were not fitted to are predicted no worse by one than by another, but for "
            "chance."
        )
    return (
        "The last column is what remains when each is fitted to clean data made with the other; next to "
        "noise, less than about 9 does not show."
    )


TRIALS = {
    "spin": "turning on the spot, all thrusters across at 60 %",
    "astern": "straight astern, 60 %",
    "sideways": "sideways, all thrusters abeam at 60 %",
}
"""Trials of which only thrusters that turn all the way are capable."""
OTHERS = {
    "differential thrust": "straight ahead, the thrusters of either side pushing harder in turn",
    "adrift": "ten seconds ahead at 80 %, then adrift",
}


def trial_words(name: str, boat: Boat) -> str:
    """What a manoeuvre is, where its name does not say it: a rudder that cannot go round is put hard over."""
    from swamp_rl.simulator import parameters

    if name not in TRIALS:
        return OTHERS.get(name, name)
    record = parameters(boat)[0]
    reach = float(max(np.abs(record["azimuth_min"]).max(), np.abs(record["azimuth_max"]).max()))
    if reach >= math.pi / 2:
        return TRIALS[name]
    return f"hard over ({math.degrees(reach):.0f}°) at 60 %" if reach > 0.0 else "straight ahead, 60 %"


GAINED_ON = {
    "each_run_in_turn": "on each run in turn, with numbers fitted to the other runs alone",
    "other_runs": "on the runs held out, which had no part in the fit",
    "same_run": "on the very run that the numbers were fitted to, since there is no other: they flatter",
}


def unseen_of(found: Diagnosis, boat: Boat) -> str:
    """Candidates that the data cannot show, those of one effect together."""
    places: dict[str, list[str]] = {}
    for label in found.unseen:
        name, *thrusters = label.split()
        places.setdefault(name, []).append(" and ".join(thrusters))
    count = len(boat.thrusters)
    every = {1, count, count * (count - 1) // 2}
    parts = []
    for name, where in places.items():
        whole = not where[0] or (len(where) in every and len(where) > 1)
        parts.append(name.replace("_", " ") + ("" if whole else f" ({', '.join(where)})"))
    return ", ".join(parts)


def cause_rows(causes: Sequence[Cause], boat: Boat) -> list[tuple[str, ...]]:
    """Effect, what it is, parameter, value, interval, unit, and what the boat file has."""
    rows: list[tuple[str, ...]] = []
    for cause in causes:
        effect = LIBRARY[cause.effect]
        on = cause.thruster if isinstance(cause.thruster, str) else " and ".join(cause.thruster or ())
        name = cause.effect.replace("_", " ") + (f" ({on})" if on else "")
        first = (name, effect.description)
        for parameter, estimate in cause.parameters.items():
            neutral = neutral_value(cause.effect, parameter, boat)
            rows.append((*first, parameter.replace("_", " "), *number_cells(estimate), neutral))
            first = ("", "")
        if not cause.parameters:
            rows.append((*first, "", "", "", "", ""))
    return rows


def number_cells(estimate: Estimate) -> tuple[str, str, str]:
    """Value, 95 % interval and unit, angles in degrees; at the edge of what is tried there is no interval."""
    factor, unit = (180.0 / math.pi, "degrees") if estimate.unit == "rad" else (1.0, estimate.unit)
    if estimate.at_bound:
        ended = plain(factor * estimate.value)
        return ended, edge(estimate.limit, ended), written(unit)
    value, reach = factor * estimate.value, factor * Z95 * estimate.standard_error
    places = 2 if reach <= 0.0 or not math.isfinite(reach) else max(0, 1 - math.floor(math.log10(reach)))
    places = min(places, 6)
    low, middle, high = (minus(f"{v:.{places}f}") for v in (value - reach, value, value + reach))
    return middle, f"{low} to {high}", written(unit)


def written(unit: str) -> str:
    """A unit as one writes it, nothing for a plain number; on one line."""
    return "" if unit == "1" else unit.replace("2", "²").replace("3", "³").replace(" ", "\N{NO-BREAK SPACE}")


def edge(limit: Limit | None, value: str) -> str:
    """What to make of a number that ended at the edge of what is tried."""
    way = f": {limit.replace('_', ' ')} {value}" if limit else ", no interval"
    return f"at the edge of what is tried{way}"


def plain(value: float) -> str:
    """Three significant digits without zeros at the end."""
    return minus(f"{float(f'{value:.3g}') + 0.0:g}")


def minus(digits: str) -> str:
    """Numbers with the sign that is as wide as a plus."""
    return digits.replace("-", "−")


def neutral_value(effect: str, parameter: str, boat: Boat) -> str:
    """What the boat file has for it."""
    from swamp_rl.simulator import parameters

    given = LIBRARY[effect].parameter(parameter)
    if given.neutral is not None:
        return "none" if math.isinf(given.neutral) else f"{given.neutral:g}"
    value = parameters(boat)[0][given.field]
    return f"{float(value if value.ndim == 0 else value[0]):g}"


def places_of(value: float) -> int:
    """Decimals that show three digits of a value."""
    if value == 0.0 or not math.isfinite(value):
        return 0
    return min(max(0, 2 - math.floor(math.log10(abs(value)))), 5)


def rounded(value: float) -> str:
    """Three significant digits, without powers of ten."""
    return f"{value:.{places_of(value)}f}"


def names_of(found: Diagnosis) -> str:
    """The names that the boat file uses for what was found."""
    effects = ", ".join(dict.fromkeys(cause.effect for cause in found.causes))
    return f"There the effects are called {effects}." if effects else ""

"""Sentences of the diagnosis report."""

import math
from collections.abc import Sequence

from swamp_rl.boat import Boat
from swamp_rl.constants import Z95
from swamp_rl.criticism.data.run_set import CHANNELS, UNITS
from swamp_rl.criticism.model.candidates import selectors
from swamp_rl.criticism.result import Cause, Diagnosis, Estimate
from swamp_rl.effects import LIBRARY
from swamp_rl.html_page import minus, plain, rounded

EQUAL = 9.0  # held-out chi2 within which two functions of the residual force are not separated
ENOUGH = 3.0  # standard errors that distinguish two explanations
REPETITIONS = 100  # of a manoeuvre; one that needs more of them separates nothing
DIFFERS = {"by_run": "another in each run", "by_day": "another on each day"}


def readable(label: str) -> str:
    """`azimuth_lag + thruster_gain bs` as `azimuth lag and thruster gain (bs)`."""
    if label == "nothing":
        return "nothing added"
    found = []
    for part in label.split(" + "):
        name, *more = part.split()
        more = [DIFFERS.get(one, one) for one in more]
        found.append(name.replace("_", " ") + (f" ({', '.join(more)})" if more else ""))
    return " and ".join([", ".join(found[:-1]), found[-1]] if len(found) > 1 else found)


def in_file_names(label: str) -> str:
    """Names as boat files have them, the scope in words: `wind by_run` as `wind (another in each run)`."""
    for scope, words in DIFFERS.items():
        label = label.replace(f" {scope}", f" ({words})")
    return label


def causes(found: Diagnosis) -> str:
    """The causes by name, joined."""
    return readable(" + ".join(cause.label for cause in found.causes)) if found.causes else "nothing"


def is_extended(found: Diagnosis) -> bool:
    """Whether the extended boat differs from the boat file."""
    return bool(found.causes or (found.extension and found.extension.written))


def headline(found: Diagnosis) -> str:
    """The verdict as one sentence."""
    if found.verdict == "nothing_wrong":
        if any(cause.within_boat_errors for cause in found.minor):
            return "No model error matters: what is found may be an error of the boat file's fitted numbers."
        if found.minor:
            return "No model error matters: what is significant changes no prediction."
        return "No model error is detectable: the residuals are measurement noise."
    if found.verdict == "cause":
        count = "one effect" if len(found.causes) == 1 else f"{len(found.causes)} effects"
        return f"The model lacks {count}: {causes(found)}."
    if found.verdict == "indistinguishable":
        names = [readable(name) for group in found.indistinguishable for name in group]
        if len(names) > 2:
            return f"The model error is not attributable to one of {len(names)} effects: {either(names)}."
        return f"The model error is not attributable to one effect: {' or '.join(names)}."
    if found.causes:
        return f"The model error is explained in part by {causes(found)}{instead(found)}."
    return "The model error is not explained by any effect of the library."


def either(names: Sequence[str]) -> str:
    """Explanations, each perhaps of several effects, as alternatives."""
    if any(" and " in name for name in names):
        return "; or ".join(names)
    return f"{', '.join(names[:-1])} or {names[-1]}"


def instead(found: Diagnosis) -> str:
    """The alternatives of the causes found in an unexplained model error."""
    others = [readable(name) for group in found.indistinguishable for name in group[1:]]
    which = others[0] if len(others) == 1 else f"one of {len(others)} others (see below)"
    return f", or equally {which}" if others else ""


def separates(found: Diagnosis) -> bool:
    """Whether a manoeuvre was found that distinguishes the explanations, repeated where needed."""
    trial = found.separating_trial
    return trial is not None and trial.separation * math.sqrt(REPETITIONS) >= ENOUGH


def separating_sentence(found: Diagnosis) -> str:
    """The manoeuvre that separates the explanations, in a line; empty where there is nothing to separate."""
    trial = found.separating_trial
    if trial is None:
        return ""
    apart = f"{trial.separation:.1f} standard errors apart"
    if separates(found):
        return f"separating manoeuvre: {trial.manoeuvre} ({apart})"
    return f"separating manoeuvre: none of those tried ({apart} at most)"


def meaning(found: Diagnosis) -> str:
    """The meaning of the verdict, and what may be done with it."""
    if found.verdict == "nothing_wrong":
        if any(cause.within_boat_errors for cause in found.minor):
            return (
                "The boat file's standard errors allow for the difference. To reduce them, fit the boat file "
                "to these runs as well (swamp-rl identify boat)."
            )
        if found.minor:
            return "Without causes that change no prediction, the boat file needs no addition."
        return (
            "The prediction errors are those of a perfect model under the estimated measurement noise. The "
            "boat file needs no addition. Effects that these data cannot identify are listed below."
        )
    if found.verdict == "cause":
        added = "it" if len(found.causes) == 1 else "them"
        text = f"With {added}, the residuals are measurement noise. {files_sentence(found)}"
        if any(one.at_bound for cause in found.causes for one in cause.parameters.values()):
            text += " One value ended at a bound of the fit, so its effect may be a substitute for another "
            text += "cause: check it."
        return text
    if found.verdict == "indistinguishable":
        proposed = " A manoeuvre that separates them is proposed below." if separates(found) else ""
        return (
            "Each of these explanations leaves only measurement noise. extended_boat.yaml holds the one with "
            f"the lowest χ²: it is valid for motions like those of these runs, not beyond.{proposed}"
        )
    names = dict.fromkeys(label.split()[0].replace("_", " ") for label in found.discrete)
    jumps = f", among them the {len(found.discrete)} without a number ({', '.join(names)})" if names else ""
    tried = (
        f"Every effect of the library was score-tested and {found.hypotheses} sets of effects were fitted"
        f"{jumps}; the residuals of the best exceed the noise. "
    )
    if not found.leftover:
        return tried + "The residual force is not a function of any single recorded variable."
    return tried + "The residual force and the variable that it depends on are given below."


def force_name(force: str) -> str:
    """`yaw` as `yaw moment`, `thrust of bs` as it is."""
    return force if " " in force else f"{force} {'moment' if force == 'yaw' else 'force'}"


def residual_force_sentence(found: Diagnosis) -> str:
    """The largest residual force and its variable."""
    first = found.leftover[0]
    what = "an error of the " if first.force.startswith("thrust of") else "a "
    sentence = (
        f"The largest residual is {what}{force_name(first.force)} as a function of {first.variable}, which "
        f"explains {first.explained:.0%} of the residual force's variance on held-out runs."
    )
    equal = [
        f"{force_name(one.force)} against {one.variable}"
        for one in found.leftover[1:]
        if first.gain - one.gain < EQUAL
        and not (first.variable.startswith("position") and one.variable.startswith("position"))
    ]
    return sentence + (f" These data do not separate it from: {'; '.join(equal)}." if equal else "")


def rest_sentence(found: Diagnosis) -> str:
    """The residual force and its variable, or that none is found."""
    if found.leftover:
        return residual_force_sentence(found)
    return (
        "No single variable explains a significant share of the residual forces' variance on held-out runs. "
        "An external action, a dependence on place, or two causes at once are possible: see the missing "
        "forces above."
    )


def shape_sentence(found: Diagnosis) -> str:
    """Caption of the missing forces."""
    beside = found.leftover[0].beside
    file = f"the boat file with {readable(' + '.join(beside))}" if beside else "the boat file"
    return (
        f"Estimates from all runs of the force that {file} lacks, positive ahead, to starboard, to the north "
        "or to the east; of a moment, positive to starboard. The band is the 95 % interval if nothing else "
        "is missing. The missing effect should have the same steps, kinks and slopes."
    )


def gain_sentence(found: Diagnosis) -> str:
    """A sentence where the extended boat predicts no better."""
    gain = next((one for one in found.gain if one.horizon_s == 10.0 and one.position_rmse_m), None)
    if gain is None or gain.position_rmse_m is None or not is_extended(found):
        return ""
    low, high = gain.position_rmse_m.ci95
    if low > 0.0:
        return ""
    if high < 0.0:
        return (
            "The extended boat predicts positions 10 s ahead worse: do not predict with extended_boat.yaml. "
        )
    return "The change of the position error 10 s ahead is not significant. "


def noise_sentence(found: Diagnosis) -> str:
    """Gauss-Markov errors, where some were found: of the receiver, or of the model."""
    if not found.wandering:
        return ""
    parts = []
    for name, one in found.wandering.items():
        factor, shown = shown_unit(name)
        parts.append(f"{name.replace('_', ' ')} {rounded(factor * one.standard_deviation)} {shown}")
    seconds = max(one.time_constant_s for one in found.wandering.values())
    whose = (
        "In addition the position noise has a Gauss-Markov part"
        if set(found.wandering) <= {"north", "east"}
        else "In addition the model has errors that are correlated in time"
    )
    return f"{whose} (standard deviation): {', '.join(parts)}; time constant {seconds:.2g} s."


def shown_unit(channel: str) -> tuple[float, str]:
    """Factor from SI and unit that a channel is shown in."""
    unit = UNITS[CHANNELS.index(channel)]
    return (180.0 / math.pi, unit.replace("rad", "degrees")) if "rad" in unit else (1.0, unit)


def in_degrees(unit: str) -> tuple[float, str]:
    """Factor from a parameter's unit, and the unit that it is written in: degrees for an angle."""
    return (180.0 / math.pi, "degrees") if unit == "rad" else (1.0, written(unit))


def closeness(verdict: str) -> str:
    """The reading of the table of explanations."""
    if verdict == "unexplained":
        return (
            "None of these explains the whole error. They are listed because their prediction errors on "
            "held-out segments do not differ significantly."
        )
    return (
        "The last column is the χ² that remains when each is fitted to noise-free data simulated with the "
        "other; less than about 9 is not detectable in noise."
    )


MANOEUVRES = {
    "spin": "turning on the spot, 60 %",
    "astern": "straight astern, 60 %",
    "sideways": "sideways to starboard, 60 %",
    "differential thrust": "straight ahead, the thrusters of either side with alternating thrust",
    "adrift": "ten seconds ahead at 80 %, then without thrust",
}


def manoeuvre_words(name: str) -> str:
    """Description of a manoeuvre."""
    return MANOEUVRES.get(name, name)


GAINED_ON = {
    "each_run_in_turn": "on each run in turn, with values fitted to the other runs alone (leave-one-run-out)",
    "other_runs": "on the held-out runs",
    "same_run": "on the run that the values were fitted to, since there is no other: they are optimistic",
}


def effects_listed(labels: Sequence[str], boat: Boat) -> str:
    """Effects by their labels, one entry for each effect, whether all runs share its parameters or not."""
    places: dict[str, list[str]] = {}
    for label in labels:
        name, *more = label.split()
        place = " and ".join(one for one in more if one not in DIFFERS)
        if place not in places.setdefault(name, []):
            places[name].append(place)
    parts = []
    for name, where in places.items():
        whole = not where[0] or len(where) == len(selectors(LIBRARY[name], boat))
        parts.append(name.replace("_", " ") + ("" if whole else f" ({', '.join(where)})"))
    return ", ".join(parts)


def parameter_sets(cause: Cause) -> list[tuple[str, dict[str, Estimate]]]:
    """The parameters of a cause: those that all runs share, or the mean and those of each group by name."""
    own = [(f", {name}", parameters) for name, parameters in cause.groups.items()]
    return [(", mean" if own else "", cause.parameters), *own]


def spread_sets(cause: Cause) -> list[tuple[str, str, str, str]]:
    """Name, value, 95 % interval and unit of each standard deviation between groups."""
    rows = []
    for name, one in cause.spread.items():
        factor, unit = in_degrees(one.unit)
        value, low, high = (plain(factor * number) for number in (one.value, one.low, one.high))
        between = "days" if cause.scope == "day" else "runs"
        label = f"standard deviation of {name.replace('_', ' ')} between {between}"
        rows.append((label, value, f"{low} to {high}", unit))
    return rows


def cause_rows(causes: Sequence[Cause], boat: Boat) -> list[tuple[str, ...]]:
    """Effect, description, parameter, value, interval, unit, and the boat file's value."""
    rows: list[tuple[str, ...]] = []
    for cause in causes:
        effect = LIBRARY[cause.effect]
        on = cause.thruster if isinstance(cause.thruster, str) else " and ".join(cause.thruster or ())
        name = cause.effect.replace("_", " ") + (f" ({on})" if on else "")
        name += f", {DIFFERS[f'by_{cause.scope}']}" if cause.groups else ""
        first = (name, effect.description)
        for where, parameters in parameter_sets(cause):
            for parameter, estimate in parameters.items():
                neutral = neutral_value(cause.effect, parameter, boat)
                label = parameter.replace("_", " ") + where
                rows.append((*first, label, *number_cells(estimate), neutral))
                first = ("", "")
        rows += [("", "", *cells, "") for cells in spread_sets(cause)]
        if not cause.parameters:
            rows.append((*first, "", "", "", "", ""))
    return rows


def number_cells(estimate: Estimate) -> tuple[str, str, str]:
    """Value, 95 % interval and unit, angles in degrees; without an interval at a bound of the fit, and where
    the runs do not determine it. An interval of an angle is at most the whole circle.
    """
    factor, unit = in_degrees(estimate.unit)
    shown = plain(factor * estimate.value)
    if not estimate.identifiable:
        return shown, "not determined by these runs", unit
    if estimate.at_bound:
        way = f": {estimate.limit.replace('_', ' ')} {shown}" if estimate.limit else ", no interval"
        return shown, f"at the bound of the fit{way}", unit
    value, reach = factor * estimate.value, factor * Z95 * estimate.standard_error
    known = reach > 0.0 and math.isfinite(reach)
    places = min(6, max(0, 1 - math.floor(math.log10(reach)))) if known else 2
    low, middle, high = (minus(f"{v:.{places}f}") for v in (value - reach, value, value + reach))
    whole = estimate.unit == "rad" and Z95 * estimate.standard_error >= math.pi
    return middle, "the whole circle" if whole else f"{low} to {high}", unit


def written(unit: str) -> str:
    """A unit with superscripts on one line, nothing for 1."""
    return "" if unit == "1" else unit.replace("2", "²").replace("3", "³").replace(" ", "\N{NO-BREAK SPACE}")


def neutral_value(effect: str, parameter: str, boat: Boat) -> str:
    """The boat file's value of an effect's parameter."""
    from swamp_rl.simulator import parameters

    given = LIBRARY[effect].parameter(parameter)
    if given.neutral is not None:
        return "none" if math.isinf(given.neutral) else f"{given.neutral:g}"
    value = parameters(boat)[0][given.field]
    return f"{float(value if value.ndim == 0 else value[0]):g}"


def own_value(effect: str, parameter: str, boat: Boat) -> str:
    """The boat file's value of a parameter that replaces a number of it; empty for one that changes nothing
    at a neutral value.
    """
    replaces = LIBRARY[effect].parameter(parameter).neutral is None
    return neutral_value(effect, parameter, boat) if replaces else ""


def of_boat(cause: Cause) -> bool:
    """Whether it belongs to the boat and is the same in every run."""
    return not (cause.groups or LIBRARY[cause.effect].weather)


def files_sentence(found: Diagnosis) -> str:
    """Which file each cause was written to, by the names that effects have there."""
    written = [cause for cause in (*found.causes, *found.minor, *found.nuisance) if cause.carries_over]
    force: list[str] = []
    if found.extension and found.extension.written:
        written, force = found.extension.beside, ["force_curve"]
    apart = [cause for cause in written if not of_boat(cause)]
    own = [cause.effect for cause in written if of_boat(cause)]
    called = [", ".join(dict.fromkeys(part)) for part in ([*own, *force], (one.effect for one in apart))]
    sentence = f"extended_boat.yaml is the boat file with {called[0] or 'no effect added'}."
    if apart:
        file = "conditions/RUN.yaml of each run" if any(c.groups for c in apart) else "conditions.yaml"
        sentence += f" What may differ between runs is in {file}: {called[1]}."
    return sentence

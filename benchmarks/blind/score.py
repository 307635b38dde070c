"""Results of blind diagnoses: rates of correct names and false positives, and coverage of the intervals."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from swamp_rl.experiments.synthetic.cases import POWER, ROUGH

from swamp_rl.angles import wrapped_below
from swamp_rl.constants import Z95

Judged = Mapping[str, Any]
AT_MOST = 3  # explanations in a set that still counts as an answer, or that are the first of a set
WITHIN = 1.5  # of the Cramér-Rao bound


def judged(truth: Judged, found: Judged | None) -> dict[str, Any]:
    """One answer against the truth; None is a process that failed.

    At level P, where effects are as small as they may be, a minor cause counts as named.
    """
    by_run = {effect["effect"] for run in truth.get("by_run", ()) for effect in run}
    true = sorted([*(effect["effect"] for effect in truth["effects"]), *by_run])
    verdict = found["verdict"] if found else "failed"
    causes = found["causes"] if found else []
    if found and truth["level"] == POWER:
        causes = [*causes, *found["minor"]]
        verdict = verdict_with_minor(found)
    named = sorted(cause["effect"] for cause in causes)
    sets = [
        sorted(names_in(label)) for group in (found or {}).get("indistinguishable", []) for label in group
    ]
    verdicts = ("cause", "unexplained") if truth["level"] == ROUGH else ("cause",)
    alone = verdict in verdicts and named == true
    among = verdict == "indistinguishable" and true in sets
    small = among and len(sets) <= AT_MOST
    right = rightly(truth, verdict, named, alone or small)
    outside = truth["kind"] == "outside" and found
    return {
        "level": truth["level"],
        "kind": truth["kind"],
        "truth": " + ".join(true) or (truth["outside"] or {}).get("what", "nothing"),
        "size": truth["size"],
        "verdict": verdict,
        "named": " + ".join(named) or "nothing",
        "rivals": [" + ".join(one) for one in sets],
        "alone": alone,
        "small_set": alone or small,
        "in_a_set": among,
        "among_first": alone or (among and true in sets[:AT_MOST]),
        "trial": bool((found or {}).get("separating_trial")),
        "right": right,
        "place": same_places(truth, causes) if alone else None,
        "variable_named": names_variable(truth, found, 4) if outside and found else None,
        "variable_named_first": names_variable(truth, found, 1) if outside and found else None,
        "estimates": estimates(truth, causes) if alone else [],
        "run_estimates": run_estimates(truth, causes),
        "elapsed_s": found["elapsed_s"] if found else None,
    }


def verdict_with_minor(found: Judged) -> str:
    """The verdict if minor causes had a part in it."""
    if found["verdict"] == "nothing_wrong" and found["minor"]:
        return "indistinguishable" if found["indistinguishable"] else "cause"
    return str(found["verdict"])


def rightly(truth: Judged, verdict: str, named: Sequence[str], effects: bool) -> bool:
    """Whether the verdict is correct; `effects`: whether the true effects were named. At level R no model is
    right, so that `unexplained` is too, beside no cause but the true one.
    """
    if truth["kind"] == "outside":
        return verdict == "unexplained"
    if truth["kind"] == "clean" and truth["level"] == ROUGH:
        return not named
    if truth["kind"] == "clean":  # where it is off, nothing but its hull's derivatives
        hull = bool(truth["hull"]) and verdict == "cause" and named == ["hull_coefficients"]
        return verdict == "nothing_wrong" or hull
    return effects


def names_in(label: str) -> list[str]:
    """Effects of a label such as `thruster_gain bs + current`, without the thrusters."""
    return [part.split()[0] for part in label.split(" + ") if part != "nothing"]


def same_places(truth: Judged, causes: Sequence[Judged]) -> bool | None:
    """Whether every thruster is correct; None where the effects have none."""
    chosen = {e["effect"]: e["thruster"] for e in truth["effects"] if "thruster" in e}
    named = {c["effect"]: c["thruster"] for c in causes if c["effect"] in chosen}
    if not chosen:
        return None
    return all(sorted(named[name]) == sorted(place) for name, place in chosen.items())


def names_variable(truth: Judged, found: Judged, first: int) -> bool:
    """Whether one of the first so many residual forces is a function of the correct variable."""
    wanted = truth["outside"]["variables"]
    variables = [str(left["variable"]).replace(" ", "_") for left in found.get("leftover", [])[:first]]
    return any(variable in wanted or variable.split("_")[0] in wanted for variable in variables)


def estimates(truth: Judged, causes: Sequence[Judged]) -> list[dict[str, Any]]:
    """Every parameter of correctly named causes: value, standard error, and error in standard errors."""
    found = []
    for effect in truth["effects"]:
        for cause in causes:
            if cause["effect"] != effect["effect"]:
                continue
            for name, number in cause["parameters"].items():
                error = number["standard_error"]
                if name not in effect or error <= 0 or not number.get("identifiable", True):
                    continue
                difference = number["value"] - effect[name]
                if number["unit"] == "rad":
                    difference = wrapped_below(difference)
                one = {"effect": effect["effect"], "parameter": name, "value": number["value"]}
                found.append(one | {"standard_error": error, "away": float(difference / error)})
    return found


def run_estimates(truth: Judged, causes: Sequence[Judged]) -> list[dict[str, Any]]:
    """Every parameter of the weather of each run, where it was named by run: its error in standard errors."""
    found = []
    named = {cause["effect"]: cause.get("groups", {}) for cause in causes}
    for number, run in enumerate(truth.get("by_run", ())):
        for effect in run:
            estimates = named.get(effect["effect"], {}).get(f"run_{number}", {})
            for name, one in estimates.items():
                away = one["value"] - effect[name]
                if one["unit"] == "rad":
                    away = wrapped_below(away)
                if one["standard_error"] > 0:
                    found.append(
                        {"parameter": name, "run": number, "away": float(away / one["standard_error"])}
                    )
    return found


def share(flags: Sequence[bool]) -> dict[str, float] | None:
    """Rate of flags with Wilson's 95 % interval, None of none."""
    n = len(flags)
    if not n:
        return None
    rate, z2 = float(np.mean(flags)), Z95**2
    centre = (rate + z2 / (2 * n)) / (1 + z2 / n)
    half = Z95 * float(np.sqrt(rate * (1 - rate) / n + z2 / (4 * n * n))) / (1 + z2 / n)
    return {"rate": rate, "low": max(centre - half, 0.0), "high": min(centre + half, 1.0), "of": n}


def summary(results: Sequence[Judged]) -> dict[str, Any]:
    """Rates of one level; None where no case counts."""
    of = {kind: [r for r in results if r["kind"] == kind] for kind in {r["kind"] for r in results}}
    single, pair, triple = (of.get(kind, []) for kind in ("single", "pair", "triple"))
    clean, outside = of.get("clean", []), of.get("outside", [])
    confounded = of.get("confounded", [])
    undecided = [r for r in confounded if r["in_a_set"]]
    numbers = [number for r in results for number in r["estimates"]]
    ratios = [n["standard_error"] / n["bound"] for n in numbers if n.get("bound")]
    busy = [r["processor_s"] for r in results if r.get("processor_s") is not None]
    alone = [r.get("alone_s") or r["processor_s"] for r in results if r.get("processor_s") is not None]
    times = [r["elapsed_s"] for r in results if r["elapsed_s"] is not None]
    return {
        "cases": len(results),
        "single_named_alone": share([r["alone"] for r in single]),
        "single_in_a_small_set": share([r["small_set"] for r in single]),
        "pair_named_alone": share([r["alone"] for r in pair]),
        "pair_in_a_small_set": share([r["small_set"] for r in pair]),
        "triple_named_alone": share([r["alone"] for r in triple]),
        "triple_in_a_small_set": share([r["small_set"] for r in triple]),
        "thruster_right_where_named": share([r["place"] for r in results if r["place"] is not None]),
        "clean_false_positive": share([is_false_positive(r) for r in clean]),
        "clean_unexplained": share([r["verdict"] == "unexplained" for r in clean]),
        "outside_unexplained": share([r["verdict"] == "unexplained" for r in outside]),
        "outside_variable_named": share([bool(r["variable_named"]) for r in outside]),
        "outside_variable_named_first": share([bool(r["variable_named_first"]) for r in outside]),
        "confounded_set_with_the_truth": share([r["in_a_set"] for r in confounded]),
        "confounded_trial_named": share([r["trial"] for r in undecided]),
        "interval_coverage": share([abs(n["away"]) <= Z95 for n in numbers]),
        "error_over_bound_median": float(np.median(ratios)) if ratios else None,
        "error_within_1.5_of_bound": share([ratio <= WITHIN for ratio in ratios]),
        "failed": sum(r["verdict"] == "failed" for r in results),
        "processor_s_median": float(np.median(busy)) if busy else None,
        "processor_s_longest": max(busy, default=None),
        "longest_s_slow_ones_alone": max(alone, default=None),
        "longest_s": max(times, default=None),
    }


def is_false_positive(result: Judged) -> bool:
    """Whether a boat without a fault was diagnosed with one, at level R also a part of one."""
    if result["level"] == ROUGH:
        return not result["right"]
    return result["verdict"] in ("cause", "indistinguishable") and not result["right"]

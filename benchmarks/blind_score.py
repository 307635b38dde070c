"""The score of blind diagnoses: who was named, who was accused wrongly, and whether the intervals hold."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

Judged = Mapping[str, Any]
Z95 = 1.959964
AT_MOST = 3  # explanations in a set that still counts as an answer


def judged(truth: Judged, found: Judged | None) -> dict[str, Any]:
    """One answer against the truth; an answer of None is a process that failed."""
    true = sorted(effect["effect"] for effect in truth["effects"])
    verdict = found["verdict"] if found else "failed"
    causes = found["causes"] if found else []
    named = sorted(cause["effect"] for cause in causes)
    sets = [
        sorted(names_in(label)) for group in (found or {}).get("indistinguishable", []) for label in group
    ]
    alone = verdict == "cause" and named == true
    small = verdict == "indistinguishable" and true in sets and len(sets) <= AT_MOST
    expected = {"clean": "nothing_wrong", "outside": "unexplained"}.get(truth["kind"])
    right = verdict == expected if expected else alone or small
    if truth["kind"] == "clean" and truth["hull"]:  # nothing but its hull's derivatives
        right = right or (verdict == "cause" and named == ["hull_coefficients"])
    pointed = pointed_at(truth, found) if truth["kind"] == "outside" and found else None
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
        "right": right,
        "pointed": pointed,
        "intervals": intervals(truth, causes) if alone else [],
        "elapsed_s": found["elapsed_s"] if found else None,
    }


def names_in(label: str) -> list[str]:
    """Effects of a label such as `thruster_gain bs + current`, without the thrusters."""
    return [part.split()[0] for part in label.split(" + ") if part != "nothing"]


def pointed_at(truth: Judged, found: Judged) -> bool:
    """Whether a residual force is said to go with the right variable."""
    wanted = truth["outside"]["variables"]
    variables = [str(left["variable"]) for left in found.get("leftover", [])]
    return any(variable in wanted or variable.split()[0] in wanted for variable in variables)


def intervals(truth: Judged, causes: Sequence[Judged]) -> list[float]:
    """(estimate - truth) / standard error of every number of the causes named rightly."""
    away = []
    for effect in truth["effects"]:
        for cause in causes:
            if cause["effect"] != effect["effect"]:
                continue
            for name, number in cause["parameters"].items():
                if name not in effect or number["standard_error"] <= 0:
                    continue
                difference = number["value"] - effect[name]
                if number["unit"] == "rad":
                    difference = (difference + np.pi) % (2 * np.pi) - np.pi
                away.append(float(difference / number["standard_error"]))
    return away


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
    """Rates of one level; None where no case tells."""
    of = {kind: [r for r in results if r["kind"] == kind] for kind in {r["kind"] for r in results}}
    single, pair, clean, outside = (of.get(k, []) for k in ("single", "pair", "clean", "outside"))
    away = [z for r in results for z in r["intervals"]]
    busy = [r["processor_s"] for r in results if r.get("processor_s") is not None]
    times = [r["elapsed_s"] for r in results if r["elapsed_s"] is not None]
    return {
        "cases": len(results),
        "single_named_alone": share([r["alone"] for r in single]),
        "single_in_a_small_set": share([r["small_set"] for r in single]),
        "pair_named_alone": share([r["alone"] for r in pair]),
        "pair_in_a_small_set": share([r["small_set"] for r in pair]),
        "confounded_in_a_small_set": share([r["small_set"] for r in of.get("confounded", [])]),
        "clean_accused": share(
            [r["verdict"] in ("cause", "indistinguishable") and not r["right"] for r in clean]
        ),
        "clean_said_unexplained": share([r["verdict"] == "unexplained" for r in clean]),
        "outside_admitted": share([r["verdict"] == "unexplained" for r in outside]),
        "outside_pointed_at": share([bool(r["pointed"]) for r in outside]),
        "interval_coverage": share([abs(z) <= Z95 for z in away]),
        "intervals": len(away),
        "failed": sum(r["verdict"] == "failed" for r in results),
        "processor_s_median": float(np.median(busy)) if busy else None,
        "processor_s_longest": max(busy, default=None),
        "longest_s": max(times, default=None),
    }


def markdown(scores: Mapping[str, Mapping[str, Any]]) -> str:
    """Scores as a table, a column for each level."""
    rows = list(next(iter(scores.values())))

    def cell(value: Any) -> str:
        if isinstance(value, dict):
            return f"{value['rate']:.3f} ({value['low']:.2f} to {value['high']:.2f}; {value['of']:.0f})"
        return "-" if value is None else f"{value:.3g}"

    lines = ["| | " + " | ".join(scores) + " |", "|---" * (len(scores) + 1) + "|"]
    lines += [
        f"| {row.replace('_', ' ')} | " + " | ".join(cell(s[row]) for s in scores.values()) + " |"
        for row in rows
    ]
    return "\n".join(lines) + "\n"


def figures(results: Sequence[Judged], out: Path) -> None:
    """Confusion matrix of the single effects, and the share found against the size of the effect."""
    from matplotlib.figure import Figure

    single = [r for r in results if r["kind"] in ("single", "clean")]
    rows = sorted({r["truth"] for r in single})
    said = {
        id(r): r["named"] if r["verdict"] in ("cause", "indistinguishable") else r["verdict"] for r in single
    }
    columns = sorted(set(rows) | set(said.values()))
    counts = np.zeros((len(rows), len(columns)))
    for r in single:
        counts[rows.index(r["truth"]), columns.index(said[id(r)])] += 1
    figure = Figure(figsize=(2 + 0.3 * len(columns), 2 + 0.3 * len(rows)), layout="constrained")
    axes = figure.subplots()
    axes.imshow(counts / np.maximum(counts.sum(axis=1, keepdims=True), 1), cmap="Blues", vmin=0, vmax=1)
    axes.set_xticks(range(len(columns)), columns, rotation=90)
    axes.set_yticks(range(len(rows)), rows)
    axes.set_xlabel("said")
    axes.set_ylabel("hidden")
    figure.savefig(out / "confusion.png", dpi=120)

    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.subplots()
    for level in sorted({r["level"] for r in results}):
        single = [r for r in results if r["level"] == level and r["kind"] == "single"]
        bins = np.clip(np.digitize([r["size"] for r in single], [0.75, 1.0, 1.25]), 0, 3)
        shares = [
            share([r["small_set"] for r, b in zip(single, bins, strict=True) if b == i]) for i in range(4)
        ]
        known = [(0.625 + 0.25 * i, one["rate"]) for i, one in enumerate(shares) if one is not None]
        axes.plot(*zip(*known, strict=True), "o-", label=level) if known else None
    axes.set_ylim(0, 1.05)
    axes.set_xlabel("size of the effect, against a typical one")
    axes.set_ylabel("named, alone or among three")
    axes.legend()
    figure.savefig(out / "power.png", dpi=120)

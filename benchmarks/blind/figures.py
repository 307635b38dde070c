"""Figures of the blind diagnoses: confusion matrix, and power against effect size."""

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.synthetic.cases import POWER as SMALL_ONES

from benchmarks.blind.score import AT_MOST, Judged, share

SETS = ("a set with it", "a set without it")
CONFUSION, POWER = "blind_confusion.png", "blind_power.png"
# bins of an effect's size against a typical one, and of its distance from nothing in least standard errors
SIZES = (3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 0.5, 0.75, 1.0, 1.25, 1.5)
EVIDENCES = (0.0, 2.0, 4.0, 6.0, 9.0, 15.0, 30.0, 100.0, 1000.0, np.inf)

# key, bins, name and labelled ticks of each decade
QUANTITIES = (
    ("size", SIZES, "size, against a typical one", (1.0,)),
    ("evidence", EVIDENCES, "evidence, standard errors", (1.0, 2.0, 5.0)),
)


def answer_of(result: Judged) -> str:
    """The answer in words: the names, `a set with it`, or the verdict."""
    if result["verdict"] == "cause":
        return str(result["named"])
    if result["verdict"] == "indistinguishable":
        return SETS[0] if result["in_a_set"] else SETS[1]
    return str(result["verdict"]).replace("_", " ")


def shares(results: Sequence[Judged], key: str, edges: Sequence[float]) -> list[dict[str, Any]]:
    """By bin of a quantity: how many single effects were named, alone or in a small set, of how many."""
    found = []
    for low, high in itertools.pairwise(edges):
        inside = [r for r in results if r.get(key) is not None and low <= r[key] < high]
        if rate := share([r["small_set"] for r in inside]):
            middle = float(np.exp(np.mean(np.log([max(r[key], 1e-6) for r in inside]))))
            silent = sum(r["verdict"] == "nothing_wrong" for r in inside)
            best = [r["best_rate"] for r in inside if r.get("best_rate") is not None]
            of_best = float(np.mean(best)) if best else None
            first = float(np.mean([r["among_first"] for r in inside]))
            own = {
                "from": low,
                "to": high,
                "middle": middle,
                "silent": silent,
                "best": of_best,
                "first": first,
            }
            found.append(own | rate)
    return found


def confusion_picture(results: Sequence[Judged], path: Path) -> None:
    """Rows: hidden single effects, none, or one outside the library; columns: the answer."""
    from matplotlib.figure import Figure

    shown = [r for r in results if r["kind"] in ("single", "clean", "outside") and r["level"] != SMALL_ONES]
    outside = {r["truth"] for r in shown if r["kind"] == "outside"}
    rows = [*sorted({r["truth"] for r in shown} - outside - {"nothing"}), "nothing", *sorted(outside)]
    rows = [row for row in rows if any(r["truth"] == row for r in shown)]
    words = ["several causes" if " + " in answer_of(r) else answer_of(r) for r in shown]
    verdicts = ["nothing wrong", *SETS, "several causes", "unexplained", "failed"]
    columns = [row for row in rows if row not in outside | {"nothing"}]
    columns += sorted(set(words) - set(columns) - set(verdicts))
    columns += [verdict for verdict in verdicts if verdict in words]
    counts = np.zeros((len(rows), len(columns)), dtype=int)
    for r, word in zip(shown, words, strict=True):
        counts[rows.index(r["truth"]), columns.index(word)] += 1
    figure = Figure(figsize=(2.2 + 0.27 * len(columns), 1.8 + 0.25 * len(rows)), layout="constrained")
    axes = figure.subplots()
    axes.imshow(counts / counts.sum(axis=1, keepdims=True), cmap="Blues", vmin=0, vmax=1.4)
    for row, column in zip(*np.nonzero(counts), strict=True):
        axes.text(column, row, str(counts[row, column]), ha="center", va="center", fontsize=7)
    axes.set_xticks(range(len(columns)), columns, rotation=90, fontsize=8)
    axes.set_yticks(range(len(rows)), rows, fontsize=8)
    axes.set_xlabel("diagnosed")
    axes.set_ylabel("true")
    figure.savefig(path, dpi=110)


def power_picture(results: Sequence[Judged], path: Path) -> None:
    """Rate of single effects named, alone or in a small set, against size and evidence."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, NullFormatter

    single = [r for r in results if r["kind"] == "single" and r["level"] != "X"]
    kept = [one for one in QUANTITIES if any(r.get(one[0]) is not None for r in single)] or [QUANTITIES[0]]
    figure = Figure(figsize=(4.5 * len(kept), 3.8), layout="constrained")
    panels = figure.subplots(1, len(kept), sharey=True, squeeze=False)[0]
    for number, level in enumerate(sorted({r["level"] for r in single})):
        mine = [r for r in single if r["level"] == level]
        for axes, (key, edges, *_) in zip(panels, kept, strict=True):
            found = shares(mine, key, edges)
            if found:
                places, rates = [one["middle"] for one in found], [one["rate"] for one in found]
                bars = [[one["rate"] - one["low"], one["high"] - one["rate"]] for one in found]
                axes.errorbar(
                    places,
                    rates,
                    np.maximum(bars, 0.0).T,
                    fmt="o-",
                    capsize=2,
                    color=f"C{number}",
                    label=level,
                )
    for axes, (*_, what, ticks) in zip(panels, kept, strict=True):
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=ticks))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel(what)
        axes.grid(alpha=0.3)
    panels[0].set_ylim(-0.03, 1.05)
    panels[0].set_ylabel(f"named, alone or among {AT_MOST}")
    lines, levels = panels[0].get_legend_handles_labels()
    figure.legend(lines, levels, title="level", loc="outside upper center", ncols=len(levels))
    figure.savefig(path, dpi=110)

"""Verdicts on the claims, as Markdown and as a table for the terminal."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from swamp_rl.experiments.reports.comparison import p_value
from swamp_rl.experiments.reports.experiment import table, titled

from swamp_rl.counted import counted

Results = Mapping[str, Any]


def report(results: Results) -> str:
    """The whole text."""
    parts = [opening(results), summary(results)]
    if results["too_few_draws"]:
        parts.append(f"**{results['too_few_draws']}.**")
    parts.append(method(results))
    parts += [claim(one) for one in results["claims"]]
    parts.append(f"It took {results['measured']['total_seconds']:.0f} s.")
    return "\n\n".join(parts) + "\n"


def opening(results: Results) -> str:
    """What was asked, and of which data."""
    data = results["data"]
    text = titled(f"{results['name']}: the claims of thesis 7.3.3, tested", results["description"])
    runs = counted(data["successful"], "successful run")
    if data["source"] != "scripted":
        return text + f"The data are {runs}, `{data['source']}`."
    driver = "that a program drove"
    if data["recorded_at"] is not None:
        driver = f"of the scripted pilot, a model of human drivers, at the level `{data['recorded_at']}`"
    return text + (
        f"**The data are `scripted`: {runs} {driver}; none is of a person.** The verdicts hold for pilots "
        "trained on it. Runs of people can be given as `data.folder`."
    )


def summary(results: Results) -> str:
    """One line for each claim."""
    rows = [[one["title"], f"**{one['verdict']}**"] for one in results["claims"]]
    return table(["claim", "verdict"], rows)


def method(results: Results) -> str:
    """Method of the tests."""
    plan, data = results["plan"], results["data"]
    scripted = "the scripted pilot in the same episodes"
    demonstrator = scripted if data["source"] == "scripted" else "the driver of the data, by these runs"
    drawn = "disjoint samples" if data["disjoint"] else "overlapping samples, as there are too few runs"
    first = ""
    if results["takeover"]:
        first = f" The scripted pilot steers for the first {results['takeover']:g} s, as a person did there."
    return (
        f"## Method\n\nThe pilot `{plan['pilot']}` ({results['kind']}) was trained {plan['draws']} times, "
        f"each time on another random sample of {plan['few']} runs ({drawn}) and another training seed, "
        f"and evaluated in the same {results['episodes']} seeded episodes.{first} The hypotheses and the "
        "smallest relevant effects are in the experiment's file. The effect is the mean over trainings and "
        "episodes; its 95 % interval is from a bootstrap over both and is not corrected for the number of "
        "hypotheses. p is from a one-sided sign-flip test of the trainings' mean differences from the "
        "bound, and is corrected by Holm over all hypotheses. "
        "*Supported*: the interval lies wholly beyond the bound and p is below 0.05. *Not supported*: it "
        "lies wholly short of it. Else *undecided*. A claim is supported if all its deciding hypotheses "
        "are, and not supported if one of them is not. *Demonstrator*: "
        f"{demonstrator}."
    )


def claim(found: Results) -> str:
    """A claim with its hypotheses."""
    head = f"## {found['title']}: {found['verdict']}\n\n"
    return head + hypotheses(found) + NOTES.get(found["claim"], "")


def hypotheses(found: Results) -> str:
    """The hypotheses of a claim: effect, p and verdict."""
    rows = []
    for one in found["hypotheses"]:
        text = one["text"] if one["decides"] else f"*{one['text']}* (does not decide)"
        reference = "–" if one["reference"] is None else shown(one["shown"], one["reference"])
        rows.append([text, effect(one), p_value(one["p_corrected"]), f"**{one['verdict']}**", reference])
    return table(["hypothesis", "effect (95 %, uncorrected)", "p (Holm)", "verdict", "demonstrator"], rows)


NOTES = {
    "copy": "\n\nDistance of two tracks: mean distance of points at equal shares of their lengths; of "
    "successful tracks only, averaged geometrically. 0 is a copy of a run; 1 is the typical distance of the "
    "data's runs from their nearest neighbour.",
    "elsewhere": "\n\nOnly starts outside the convex hull of all tracks that the pilot was trained on count.",
    "disturbed": "\n\nIf the data were recorded at the same disturbance level, this is no evidence for "
    "unseen disturbances.",
    "smoother": "\n\nMeans of logarithms over episodes in which both succeeded, as relative savings. The "
    "power is that of the thrusters' wake; see `swamp_rl/evaluation/metrics.py`.",
}


def effect(row: Results) -> str:
    """The effect with its interval, in words of its kind."""
    if row["value"] is None:
        return "no data"
    value, low, high = (shown(row["shown"], row[end]) for end in ("value", "low", "high"))
    return f"{value} ({low} to {high})"


def shown(kind: str, value: float) -> str:
    """A number as its kind is written."""
    if kind == "saving":
        return f"{-100.0 * math.expm1(-value):.1f} %"
    if kind == "ratio":
        return f"{math.exp(value):.2f}"
    return f"{100.0 * value:+.1f}" if kind == "points" else f"{100.0 * value:.1f} %"


def print_claims(results: Results, folder: Path) -> None:
    """Print the verdicts and the path of the report."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    shape = Table(title=f"{results['name']}: {results['data']['source']} runs", box=SIMPLE_HEAD)
    for head in ("claim", "verdict"):
        shape.add_column(head)
    for one in results["claims"]:
        shape.add_row(one["title"], one["verdict"])
    console = Console(markup=False)
    console.print(shape)
    console.print(f"{results['measured']['total_seconds']:.0f} s: see {folder}/report.md")

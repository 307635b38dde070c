"""The tables of the blind diagnoses in docs/criticism.md."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.synthetic.cases import EACH_RUN, LEVELS, ROUGH, TRIPLE
from swamp_rl.experiments.synthetic.cases import POWER as SMALL_ONES

from benchmarks.blind.figures import (
    CONFUSION,
    EVIDENCES,
    POWER,
    answer_of,
    confusion_picture,
    power_picture,
    shares,
)
from benchmarks.blind.rough import rough_table
from benchmarks.blind.score import WITHIN, Judged, summary
from benchmarks.blind.variants import VARIANT
from benchmarks.blind.weather import weather_table

TARGETS: dict[str, tuple[float | None, ...]] = {  # target rates, at levels A to D and X
    "single_named_alone": (0.98, 0.85, 0.92, 0.85, 0.90),
    "single_in_a_small_set": (0.99, 0.95, 0.97, 0.95, None),
    "pair_named_alone": (0.90, None, None, None, None),
    "clean_false_positive": (0.02, 0.02, 0.02, None, 0.05),
    "outside_unexplained": (0.95, 0.95, 0.95, 0.95, None),
    "outside_variable_named": (0.70, 0.70, 0.70, 0.70, None),
    "interval_coverage": (0.90, 0.90, 0.90, 0.90, None),
    "error_over_bound_median": (*(WITHIN,) * 4, None),
}
JUDGED = (*LEVELS, VARIANT)
COVER_AT_MOST = 0.98


def other_boats_table(results: Sequence[Judged]) -> str:
    """Rates and wrong answers of level X, whose cases are drawn apart from those of A to D."""
    return f"{scores_table({VARIANT: summary(results)})}\n\nWrong answers:\n\n{wrong_answers(results)}"


OWN = {
    EACH_RUN: ("blind weather", weather_table),
    ROUGH: ("blind rough", rough_table),
    VARIANT: ("blind other boats", other_boats_table),
}
"""Levels that have tables of their own, by marker."""


def parts(results: Sequence[Judged]) -> dict[str, str]:
    """The tables of docs/criticism.md by their markers; levels E, R and X have their own; only levels that
    were run have a column.
    """
    of = {level: [r for r in results if r["level"] == level] for level in OWN}
    own = {name: write(of[level]) for level, (name, write) in OWN.items() if of[level]}
    small = [r for r in results if r["level"] == SMALL_ONES]
    if small:
        own["blind power"] = power(small)
    by_level = {level: [r for r in results if r["level"] == level] for level in (*LEVELS, TRIPLE)}
    scores = {level: summary(mine) for level, mine in by_level.items() if mine}
    if scores:
        own |= {
            "blind scores": scores_table(scores),
            "blind wrong answers": wrong_answers([r for r in results if r["level"] in scores]),
            "blind by effect": by_effect(results),
        }
    return own


def pictures(results: Sequence[Judged], folder: Path) -> None:
    """Draw both figures into a folder, of all levels without a table of their own: the confusion matrix if
    one of A to D was run, the power if P was.
    """
    results = [r for r in results if r["level"] not in OWN]
    levels = {r["level"] for r in results}
    if levels - {SMALL_ONES}:
        confusion_picture(results, folder / CONFUSION)
    if SMALL_ONES in levels:
        power_picture(results, folder / POWER)


def cell(value: Any) -> str:
    """A rate with its interval, or a number."""
    if isinstance(value, dict):
        return f"{value['rate']:.3f} ({value['low']:.2f} to {value['high']:.2f}; {value['of']:.0f})"
    return "-" if value is None else f"{value:.3g}"


def judgement(row: str, level: str, value: Any) -> str:
    """`reached`, `short` where the interval contains the target, `missed` where it does not; empty without a
    target.
    """
    bar = TARGETS[row][JUDGED.index(level)] if row in TARGETS and level in JUDGED else None
    if bar is None or value is None:
        return ""
    if not isinstance(value, dict):
        return "reached" if value <= bar else "missed"
    if row == "clean_false_positive":
        return "reached" if value["rate"] <= bar else "missed" if value["low"] > bar else "short"
    if row == "interval_coverage" and value["rate"] > COVER_AT_MOST:
        return "missed" if value["low"] > COVER_AT_MOST else "short"
    return "reached" if value["rate"] >= bar else "missed" if value["high"] < bar else "short"


def scores_table(scores: Mapping[str, Mapping[str, Any]]) -> str:
    """Every rate with Wilson's 95 % interval and the number of cases, a column for each level."""
    rows = []
    for row in next(iter(scores.values())):
        cells = [
            " ".join(filter(None, (cell(score[row]), judgement(row, level, score[row]))))
            for level, score in scores.items()
        ]
        rows.append([row.replace("_", " "), *cells])
    return table(["", *scores], rows)


def wrong_answers(results: Sequence[Judged]) -> str:
    """Every wrong answer, counted, and the information criterion of the truth less the answer's: where it is
    positive, the data prefer the answer.
    """
    wrong: dict[tuple[str, ...], list[float | None]] = {}
    for r in results:
        if not r["right"]:
            key = r["level"], r["kind"], r["truth"], answer_of(r), r["named"]
            wrong.setdefault(key, []).append(r.get("truth_over_answer"))
    rows = [
        [*key, str(len(apart)), ", ".join("-" if one is None else f"{one:.0f}" for one in apart)]
        for key, apart in sorted(wrong.items())
    ]
    heads = ["level", "kind", "true causes", "answer", "named", "cases", "criterion, truth less answer"]
    return table(heads, rows)


def by_effect(results: Sequence[Judged]) -> str:
    """Of each single effect, how often it was named, alone or in a small set."""
    single = [r for r in results if r["kind"] == "single" and r["level"] in LEVELS]
    rows = []
    for name in sorted({r["truth"] for r in single}):
        cells = []
        for level in LEVELS:
            mine = [r["small_set"] for r in single if r["truth"] == name and r["level"] == level]
            cells.append(f"{sum(mine)} of {len(mine)}" if mine else "-")
        rows.append([name, *cells])
    return table(["true cause alone", *LEVELS], rows)


def power(results: Sequence[Judged]) -> str:
    """Rate of small effects named, by their evidence in least standard errors; results: of level P."""
    rows = []
    for one in shares(results, "evidence", EVIDENCES):
        high = f"to {one['to']:g}" if np.isfinite(one["to"]) else "and more"
        rates = (cell(one), cell(one["first"]), cell(one["best"]))
        rows.append([f"{one['from']:g} {high}", *rates, str(one["silent"])])
    heads = [
        "evidence, standard errors",
        "named, alone or in a set of at most three",
        "among the first three explanations",
        "Bayes classifier",
        "nothing wrong",
    ]
    return table(heads, rows)

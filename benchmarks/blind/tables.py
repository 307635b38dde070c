"""What the document says of the blind diagnoses, all of it written from their results."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.synthetic.cases import LEVELS
from swamp_rl.experiments.synthetic.cases import POWER as SMALL_ONES

from benchmarks.blind.figures import (
    CONFUSION,
    EVIDENCES,
    POWER,
    confusion_picture,
    power_picture,
    said,
    shares,
)
from benchmarks.blind.score import AT_MOST, WITHIN, Judged, summary

OTHER = "X"
# least rates, at levels A to D
BARS: dict[str, tuple[float | None, ...]] = {
    "single_named_alone": (0.98, 0.85, 0.92, 0.85),
    "single_in_a_small_set": (0.99, 0.95, 0.97, 0.95),
    "pair_named_alone": (0.90, None, None, None),
    "clean_accused": (0.02, 0.02, 0.02, None),
    "outside_admitted": (0.95, 0.95, 0.95, 0.95),
    "outside_pointed_at": (0.70, 0.70, 0.70, 0.70),
    "interval_coverage": (0.90, 0.90, 0.90, 0.90),
    "error_over_bound_median": (WITHIN,) * 4,
}
COVER_AT_MOST, LONGEST = 0.98, 60.0
FEW = 200  # cases that a level should have


def document(results: Sequence[Judged]) -> str:
    """The whole part, in Markdown."""
    by_level = {level: [r for r in results if r["level"] == level] for level in (*LEVELS, OTHER)}
    scores = {level: summary(mine) for level, mine in by_level.items() if mine}
    parts = [
        opening(scores),
        scores_table(scores),
        reached(scores),
        *wrong_answers([r for r in results if r["level"] in scores]),
        f"![Who was taken for whom, at all levels together]({CONFUSION})",
        by_effect(results),
        power(results),
        f"![How small a fault is still found]({POWER})",
    ]
    return "\n\n".join(part for part in parts if part)


def pictures(results: Sequence[Judged], folder: Path) -> None:
    """The two figures of the part."""
    confusion_picture(results, folder / CONFUSION)
    power_picture(results, folder / POWER)


def opening(scores: Mapping[str, Mapping[str, Any]]) -> str:
    """How many cases it stands on."""
    counts = ", ".join(f"{level} {score['cases']}" for level, score in scores.items())
    few = [level for level in LEVELS if scores.get(level, {"cases": 0})["cases"] < FEW]
    short = f" Levels with fewer than the {FEW} that the bars ask for: {', '.join(few)}." if few else ""
    return (
        f"Cases diagnosed: {counts}.{short} Rates with Wilson's 95 % interval and the number they stand on."
    )


def cell(value: Any) -> str:
    """A rate with its interval, or a number."""
    if isinstance(value, dict):
        return f"{value['rate']:.3f} ({value['low']:.2f} to {value['high']:.2f}; {value['of']:.0f})"
    return "-" if value is None else f"{value:.3g}"


def judgement(row: str, level: str, value: Any) -> str:
    """`reached`, `short` where chance may be to blame, `missed` where it hardly is; empty without a bar."""
    bar = BARS[row][LEVELS.index(level)] if row in BARS and level in LEVELS else None
    if bar is None or value is None:
        return ""
    if not isinstance(value, dict):
        return "reached" if value <= bar else "missed"
    if row == "clean_accused":
        return "reached" if value["rate"] <= bar else "missed" if value["low"] > bar else "short"
    if row == "interval_coverage" and value["rate"] > COVER_AT_MOST:
        return "missed" if value["low"] > COVER_AT_MOST else "short"
    return "reached" if value["rate"] >= bar else "missed" if value["high"] < bar else "short"


def scores_table(scores: Mapping[str, Mapping[str, Any]]) -> str:
    """Every rate, a column for each level."""
    lines = ["| | " + " | ".join(scores) + " |", "|---" * (len(scores) + 1) + "|"]
    for row in next(iter(scores.values())):
        cells = [
            " ".join(filter(None, (cell(score[row]), judgement(row, level, score[row]))))
            for level, score in scores.items()
        ]
        lines.append(f"| {row.replace('_', ' ')} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def reached(scores: Mapping[str, Mapping[str, Any]]) -> str:
    """Which bars are missed, which only perhaps."""
    found: dict[str, list[str]] = {"reached": [], "short": [], "missed": []}
    for row in BARS:
        for level, score in scores.items():
            if word := judgement(row, level, score[row]):
                value, bar = score[row], BARS[row][LEVELS.index(level)]
                rate = value["rate"] if isinstance(value, dict) else value
                found[word].append(f"{row.replace('_', ' ')} at {level} ({rate:.3f}, bar {bar:g})")
    barred = [score for level, score in scores.items() if level in LEVELS] or list(scores.values())
    busiest, alone = (
        max(score[row] or 0.0 for score in barred)
        for row in ("processor_s_longest", "longest_s_slow_ones_alone")
    )
    bars = sum(map(len, found.values()))
    sentences = [f"{len(found['reached'])} of {bars} bars are reached."] if bars else []
    if found["short"]:
        sentences.append(f"Short of the bar, by what may be chance: {'; '.join(found['short'])}.")
    if found["missed"]:
        sentences.append(f"Missed beyond chance: {'; '.join(found['missed'])}.")
    limit = "within" if alone <= LONGEST else "over"
    where = " at A to D" if any(level in LEVELS for level in scores) else ""
    time = f"The slowest diagnosis{where} took {busiest:.0f} s of one core"
    if alone < busiest:
        time += f"; the slow ones done again, alone on two cores, took {alone:.0f} s at most"
    sentences.append(f"{time}, {limit} the {LONGEST:.0f} s that a case may take.")
    return " ".join(sentences)


def wrong_answers(results: Sequence[Judged]) -> list[str]:
    """Every wrong answer, counted."""
    wrong = Counter(
        (r["level"], r["kind"], r["truth"], said(r), r["named"]) for r in results if not r["right"]
    )
    if not wrong:
        return ["No answer was wrong."]
    lines = ["| level | kind | hidden | said | named | times |", "|---|---|---|---|---|---|"]
    lines += [f"| {' | '.join(key)} | {times} |" for key, times in sorted(wrong.items())]
    total = sum(wrong.values())
    return [f"The {total} wrong answer{'s' * (total > 1)} of {len(results)}:", "\n".join(lines)]


def by_effect(results: Sequence[Judged]) -> str:
    """Of each single effect, how often it was named, alone or in a small set."""
    single = [r for r in results if r["kind"] == "single" and r["level"] in LEVELS]
    if not single:
        return ""
    lines = ["| hidden alone | " + " | ".join(LEVELS) + " |", "|---" * (len(LEVELS) + 1) + "|"]
    for name in sorted({r["truth"] for r in single}):
        cells = []
        for level in LEVELS:
            mine = [r["small_set"] for r in single if r["truth"] == name and r["level"] == level]
            cells.append(f"{sum(mine)} of {len(mine)}" if mine else "-")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return f"Named, alone or among {AT_MOST} at most:\n\n" + "\n".join(lines)


def power(results: Sequence[Judged]) -> str:
    """How often a small effect is found, by how many least standard errors it amounts to."""
    small = [r for r in results if r["level"] == SMALL_ONES]
    found = shares(small, "evidence", EVIDENCES)
    if not found:
        return ""
    sizes = [r["size"] for r in small]
    lines = [
        "| evidence, standard errors | named, alone or in a small set | nothing wrong |",
        "|---|---|---|",
    ]
    for one in found:
        high = f"to {one['to']:g}" if np.isfinite(one["to"]) else "and more"
        lines.append(f"| {one['from']:g} {high} | {cell(one)} | {one['silent']} |")
    sure = next((one["from"] for one in found if one["rate"] >= 0.9), None)
    said_so = f"From {sure:g} such standard errors on, nine of ten are found. " if sure is not None else ""
    return (
        f"Small faults: {len(small)} cases as at level A, of {min(sizes):.2g} to {max(sizes):.2g} times the "
        "typical size. Their evidence is how many of the least possible standard errors (Cramér and Rao) the "
        f"fault amounts to. {said_so}\n\n" + "\n".join(lines)
    )

"""Analysed trials as tables for people and as JSON for programmes."""

import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.reports.trial_figures import draw_trials

from swamp_rl.boat import Boat
from swamp_rl.clipped import in_markdown
from swamp_rl.counted import counted
from swamp_rl.manoeuvres.analysis.analyse import analyse_dataset
from swamp_rl.manoeuvres.analysis.figure import Figure, Result
from swamp_rl.manoeuvres.analysis.imo import title_for
from swamp_rl.manoeuvres.analysis.pairs import Pair, pairs
from swamp_rl.runs import Dataset
from swamp_rl.runs.schema import ANALYSIS
from swamp_rl.unfinished import folder_beside

JSON, REPORT = "analysis.json", "report.md"
COLUMNS = {  # of the tables, by manoeuvre: figure, heading, in lengths or not
    "turning-circle": (
        [
            "advance",
            "transfer",
            "tactical_diameter",
            "steady_diameter",
            "speed_loss",
            "drift_angle",
            "turning_rate",
        ]
    ),
    "zig-zag": [
        "first_overshoot",
        "second_overshoot",
        "overshoot",
        "initial_turning",
        "overshoot_time",
        "period",
    ],
    "spiral": [
        "residual_rate_there",
        "residual_rate_back",
        "loop_height",
        "loop_width",
        "neutral_angle",
        "bias_rate",
    ],
    "reverse-spiral": ["neutral_angle", "slope", "loop_width"],
    "pull-out": ["residual_rate_starboard", "residual_rate_port", "bias_rate"],
    "stopping": ["track_reach", "head_reach", "lateral_deviation", "stopping_time", "heading_change"],
    "straight": ["speed", "throttle", "heading_sd", "steering_mean"],
}


def analyse_trials(folder: Path, out: Path | None = None, boat: str | None = None) -> tuple[list[str], Path]:
    """Analyse a dataset of trials into `out`, by default DATASET/analysis; lines to print, and `out`.

    boat: as for `analyse_dataset`. UserError where no run of it holds a manoeuvre, or `out` holds something
    else.
    """
    dataset, vessel, results, refused = analyse_dataset(folder, boat)
    out = out or folder / ANALYSIS
    both = pairs(results, vessel.length)
    with folder_beside(out, replaces=JSON) as part:
        pictures = draw_trials(part, results, vessel.length)
        (part / JSON).write_text(as_json(dataset, vessel, results, both, refused), encoding="utf-8")
        text = report(dataset, vessel, results, both, refused, pictures)
        (part / REPORT).write_text(text, encoding="utf-8")
    return lines(results, vessel, both, refused), out


def as_json(
    dataset: Dataset, boat: Boat, results: Sequence[Result], both: Sequence[Pair], refused: Sequence[str]
) -> str:
    """Every figure, verdict and note."""
    content = {
        "boat": boat.name,
        "length": boat.length,
        "source": dataset.meta.source,
        "runs": [_plain(result) for result in results],
        "pairs": [asdict(pair) | {"wider": pair.wider} for pair in both],
        "not_analysed": list(refused),
    }
    return json.dumps(content, indent=1, allow_nan=False)


def _plain(result: Result) -> dict[str, Any]:
    return {
        "run": result.run,
        "manoeuvre": result.kind,
        "setting": {name: _finite(value) for name, value in result.setting.items()},
        "figures": {name: figure.as_json() for name, figure in result.figures.items()},
        "corrected": {name: figure.as_json() for name, figure in result.corrected.items()},
        "verdicts": result.verdicts,
        "imo": [criterion.as_json() for criterion in result.criteria],
        "notes": result.notes,
    }


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def report(
    dataset: Dataset,
    boat: Boat,
    results: Sequence[Result],
    both: Sequence[Pair],
    refused: Sequence[str],
    pictures: Sequence[str],
) -> str:
    """The Markdown report."""
    parts = [
        f"# Trials of {in_markdown(boat.name)}\n\n{counted(len(results), 'run')}, {dataset.meta.source}; "
        f"L = {boat.length:g} m. "
        "Angles in deg, positive to starboard; rates in deg/s, times in s, speeds in m/s. In brackets the "
        "95 % bootstrap interval of the value before them; left out where it is narrower than "
        "the last digit. sd: standard deviation over the turns or executes."
    ]
    for kind in COLUMNS:
        some = [result for result in results if result.kind == kind]
        if some:
            parts.append(f"## {kind}\n\n" + "\n\n".join(tables(some, boat.length)))
    if both:
        parts.append("## Port and starboard\n\n" + "\n".join(f"* {line}" for line in pair_lines(both)))
    judged = imo_table(results)
    if judged:
        parts.append(f"## {title_for(boat.length)}\n\n{judged}")
    noted = [f"{r.run}: {note}" for r in results for note in r.notes]
    remarks = [f"* {in_markdown(line)}" for line in (*noted, *refused)]
    if remarks:
        parts.append("## Deviations from the plan\n\n" + "\n".join(remarks))
    parts += [f"![{name}]({name})" for name in pictures]
    return "\n\n".join(parts) + "\n"


def tables(results: Sequence[Result], length: float) -> list[str]:
    """One table of the figures; for circles a second one with the drift removed."""
    kind = results[0].kind
    names = [name for name in COLUMNS[kind] if any(name in result.figures for result in results)]
    head = ["run", *(f"{name.replace('_', ' ')}, {_unit(results, name)}" for name in names)]

    def rows(which: str) -> list[list[str]]:
        return [
            [in_markdown(result.run), *(cell(getattr(result, which).get(name), length) for name in names)]
            for result in results
            if getattr(result, which)
        ]

    found = [table(head, rows("figures"))]
    if kind == "turning-circle":
        found[0] = "As recorded, over ground:\n\n" + found[0]
        corrected = rows("corrected")
        if corrected:
            head, rest = [*head, "drift, m/s"], [result for result in results if result.corrected]
            drifts = [cell(result.figures["drift_speed"], length) for result in rest]
            full = [[*row, drift] for row, drift in zip(corrected, drifts, strict=True)]
            found.append("With the drift of the centre removed:\n\n" + table(head, full))
    verdicts = [
        f"* {in_markdown(r.run)}: {name.replace('_', ' ')} {text}"
        for r in results
        for name, text in r.verdicts.items()
    ]
    return found + (["\n".join(verdicts)] if verdicts else [])


def _unit(results: Sequence[Result], name: str) -> str:
    unit = next(result.figures[name].unit for result in results if name in result.figures)
    return "L" if unit == "m" else "%" if unit == "1" else unit


def cell(figure: Figure | None, length: float) -> str:
    """A figure for a table: value [95 % interval], sd of its repetitions; lengths in place of metres."""
    if figure is None or not math.isfinite(figure.value):
        return "–"
    scale = 1.0 / length if figure.unit == "m" else 100.0 if figure.unit == "1" else 1.0
    text = f"{figure.value * scale:.2f}"
    low, high = (f"{end * scale:.2f}" for end in (figure.low, figure.high))
    if math.isfinite(figure.low) and low != high:
        text += f" [{low}, {high}]"
    return text + (f", sd {figure.sd * scale:.2f}" if math.isfinite(figure.sd) else "")


def imo_table(results: Sequence[Result]) -> str:
    """Every limit that applies to a run."""
    rows = [
        [in_markdown(result.run), c.name, f"{c.value:.2f} {c.unit}", f"{c.limit:.2f}", _passed(c.passed)]
        for result in results
        for c in result.criteria
    ]
    return table(["run", "limit", "value", "at most", "result"], rows) if rows else ""


def _passed(passed: bool | None) -> str:
    return {True: "pass", False: "fail", None: "no value"}[passed]


def pair_lines(both: Sequence[Pair]) -> list[str]:
    """Verdicts on pairs of circles, one line each."""
    return [
        f"{pair.angle:g} deg at {100 * pair.throttle:.3g} %: "
        + "; ".join(f"{name.replace('_', ' ')} {text}" for name, text in pair.verdicts.items())
        for pair in both
    ]


def lines(results: Sequence[Result], boat: Boat, both: Sequence[Pair], refused: Sequence[str]) -> list[str]:
    """What the command line prints: a line for each run, with what is judged and what went amiss."""
    found = []
    for result in results:
        names = [name for name in COLUMNS[result.kind][:4] if name in result.best]
        figures = ", ".join(
            f"{name.replace('_', ' ')} {_short(result.best[name], boat.length)}" for name in names
        )
        found.append(f"{result.run}: {figures or 'no figures'}")
        found += [f"  {name.replace('_', ' ')}: {text}" for name, text in result.verdicts.items()]
        failed = [c.name for c in result.criteria if c.passed is False]
        kept = sum(c.passed is True for c in result.criteria)
        if kept or failed:
            found.append(
                f"  {title_for(boat.length)}: {kept} of {len(result.criteria)} kept"
                + (f", not {', '.join(failed)}" if failed else "")
            )
        found += [f"  note: {note}" for note in result.notes]
    found += [f"port and starboard: {line}" for line in pair_lines(both)]
    return found + [f"not analysed: {line}" for line in refused]


def _short(figure: Figure, length: float) -> str:
    if not math.isfinite(figure.value):
        return "–"
    if figure.unit == "m":
        return f"{figure.value:.2f} m ({figure.value / length:.2f} L)"
    return f"{100 * figure.value:.1f} %" if figure.unit == "1" else f"{figure.value:z.2f} {figure.unit}"

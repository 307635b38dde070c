"""Write what pilots that learned by trying are worth into docs/learners.md, and draw their curves.

    python -m benchmarks.learners.training_spread --pilot ppo --out spread-ppo.json
    python -m benchmarks.learners.training_spread --experiment severe --pilot ppo-severe --out severe.json
    python -m benchmarks.learners.reinforcement ppo=spread-ppo.json ppo-severe=severe.json

Replaces what stands between its two marks in the document, or adds them at its end.
"""

import argparse
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.figures import learning_curves
from swamp_rl.experiments.training.curves import Curve

from swamp_rl.evaluation.seeds import interquartile_mean
from swamp_rl.files import write_beside

DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "learners.md"
PICTURE = "learners_trying.png"
BEGIN, END = "<!-- learning by trying: begin -->", "<!-- learning by trying: end -->"
SKILLED = 0.95
Spread = dict[str, Any]
"What benchmarks.learners.training_spread wrote: by seed."


def section(spreads: Mapping[str, Spread]) -> str:
    """The whole section, its marks included."""
    lines = [
        BEGIN,
        "## Learning by trying: figures",
        "",
        "Written by `python -m benchmarks.learners.reinforcement` from what "
        "`python -m benchmarks.learners.training_spread` measured. "
        "A row is one way of training at one level: success is the interquartile mean over "
        "training seeds with its 95 % bootstrap interval (none with one seed; too narrow with fewer than "
        "five), then the least and the most of any seed. Change is that of the levers per step, to be "
        "compared with the data's.",
        "",
        "| pilot | seeds | level | success | least to most | change | data's change |",
        "| --- | --- | --- | --- | --- | --- | --- |",
        *(row for name, spread in spreads.items() for row in _levels(name, spread)),
        "",
        f"| pilot | decisions | of which until {SKILLED:g} | seconds of training | success while trying, at "
        "a quarter, half and the end |",
        "| --- | --- | --- | --- | --- |",
        *(_pace(name, spread) for name, spread in spreads.items()),
        "",
        f"Until {SKILLED:g}: the point of the curve from which the episodes of a leg, driven with the noise "
        "of exploration and at the level trained in, first succeed so often; the median over the seeds that "
        "come to it. Seconds are of the wall clock, on two cores that other work shared.",
        "",
        f"![Learning curves]({PICTURE})",
        END,
    ]
    return "\n".join(lines)


def _levels(name: str, spread: Spread) -> list[str]:
    rows = []
    for level in next(iter(spread.values()))["levels"]:
        found = [seed["levels"][level] for seed in spread.values()]
        success = np.array([[one["success"]] for one in found])
        mean = interquartile_mean(success, np.random.default_rng(0))
        interval = f" ({mean.low:.3f} to {mean.high:.3f})" if len(found) > 1 else ""
        change = np.mean([one["command_change"] for one in found])
        data = np.mean([seed["data_command_change"] for seed in spread.values()])
        rows.append(
            f"| {name} | {len(found)} | {level} | {mean.value:.3f}{interval} | "
            f"{success.min():.3f} to {success.max():.3f} | {change:.3f} | {data:.3f} |"
        )
    return rows


def _pace(name: str, spread: Spread) -> str:
    curves = [seed["curve"] for seed in spread.values()]
    skilled = [
        next((point["step"] for point in curve if point["success"] >= SKILLED), None) for curve in curves
    ]
    reached = [step for step in skilled if step is not None]
    until = f"{np.median(reached):,.0f} ({len(reached)} of {len(curves)} seeds)" if reached else "not reached"
    seconds = [curve[-1]["seconds"] for curve in curves if "seconds" in curve[-1]]
    told = f"{np.median(seconds):.0f}" if seconds else "not logged"
    ends = [_at(curves, share) for share in (0.25, 0.5, 1.0)]
    return f"| {name} | {curves[0][-1]['step']:,} | {until} | {told} | {', '.join(ends)} |"


def _at(curves: list[list[dict[str, float]]], share: float) -> str:
    values = [float(np.interp(share * curve[-1]["step"], *(_curve(curve)))) for curve in curves]
    return f"{np.median(values):.2f}"


def _curve(points: list[dict[str, float]]) -> Curve:
    return np.array([point["step"] for point in points]), np.array([point["success"] for point in points])


def place(text: str) -> None:
    """Put a section into the document, in place of what stands between the same two marks."""
    begin, end = text.splitlines()[0], text.splitlines()[-1]
    document = DOCUMENT.read_text(encoding="utf-8") if DOCUMENT.exists() else "# Learners\n"
    if begin in document:
        before, _, rest = document.partition(begin)
        document = f"{before}{text}{rest.partition(end)[2]}"
    else:
        document = f"{document.rstrip()}\n\n{text}\n"
    with write_beside(DOCUMENT) as part:
        part.write_text(document, encoding="utf-8")


def main() -> None:
    """Write the document and its picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("spreads", nargs="+", metavar="NAME=FILE")
    args = parser.parse_args()
    named = [item.partition("=") for item in args.spreads]
    spreads = {name: json.loads(Path(file).read_text(encoding="utf-8")) for name, _, file in named}
    place(section(spreads))
    curves = {name: [_curve(seed["curve"]) for seed in spread.values()] for name, spread in spreads.items()}
    learning_curves(DOCUMENT.with_name(PICTURE), curves, "Success while trying")


if __name__ == "__main__":
    main()

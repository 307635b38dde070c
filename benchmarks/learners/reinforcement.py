"""Success of reinforcement learners by training seed: tables and curves of docs/learners.md.

python -m benchmarks.learners.training_spread --pilot ppo --out spread-ppo.json
python -m benchmarks.learners.training_spread --experiment severe --pilot ppo-severe --out severe.json
python -m benchmarks.learners.reinforcement ppo=spread-ppo.json ppo-severe=severe.json
"""

import argparse
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.learners.learning_curves import Curve, learning_curves
from benchmarks.markers import DOCS, write_parts
from swamp_rl.evaluation.seeds import interquartile_mean

PICTURE = "learners_trying.png"
SKILLED = 0.95
Spread = dict[str, Any]
"What benchmarks.learners.training_spread wrote: by seed."


def parts(spreads: Mapping[str, Spread]) -> dict[str, str]:
    """The two tables by their marks: success by level, and how soon it is learned."""
    success = [
        "pilot",
        "seeds",
        "level",
        "success",
        "range over seeds",
        "command change",
        "command change of the data",
    ]
    pace = ["pilot", "decisions", f"decisions to success {SKILLED:g}", "training time, s"]
    pace.append("success during training, at a quarter, half and the end")
    return {
        "reinforcement, success": table(success, [r for n, one in spreads.items() for r in _levels(n, one)]),
        "reinforcement, pace": table(pace, [_pace(name, spread) for name, spread in spreads.items()]),
    }


def _levels(name: str, spread: Spread) -> list[list[str]]:
    rows = []
    for level in next(iter(spread.values()))["levels"]:
        found = [seed["levels"][level] for seed in spread.values()]
        success = np.array([[one["success"]] for one in found])
        mean = interquartile_mean(success, np.random.default_rng(0))
        interval = f" ({mean.low:.3f} to {mean.high:.3f})" if len(found) > 1 else ""
        change = np.mean([one["command_change"] for one in found])
        data = np.mean([seed["data_command_change"] for seed in spread.values()])
        rows.append(
            [
                name,
                str(len(found)),
                level,
                f"{mean.value:.3f}{interval}",
                f"{success.min():.3f} to {success.max():.3f}",
                f"{change:.3f}",
                f"{data:.3f}",
            ]
        )
    return rows


def _pace(name: str, spread: Spread) -> list[str]:
    curves = [seed["curve"] for seed in spread.values()]
    skilled = [
        next((point["step"] for point in curve if point["success"] >= SKILLED), None) for curve in curves
    ]
    reached = [step for step in skilled if step is not None]
    until = f"{np.median(reached):,.0f} ({len(reached)} of {len(curves)} seeds)" if reached else "not reached"
    seconds = [curve[-1]["seconds"] for curve in curves if "seconds" in curve[-1]]
    message = f"{np.median(seconds):.0f}" if seconds else "not logged"
    ends = [_at(curves, share) for share in (0.25, 0.5, 1.0)]
    return [name, f"{curves[0][-1]['step']:,}", until, message, ", ".join(ends)]


def _at(curves: list[list[dict[str, float]]], share: float) -> str:
    values = [float(np.interp(share * curve[-1]["step"], *(_curve(curve)))) for curve in curves]
    return f"{np.median(values):.2f}"


def _curve(points: list[dict[str, float]]) -> Curve:
    return np.array([point["step"] for point in points]), np.array([point["success"] for point in points])


def main() -> None:
    """Write the document and its picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("spreads", nargs="+", metavar="NAME=FILE")
    args = parser.parse_args()
    named = [item.partition("=") for item in args.spreads]
    spreads = {name: json.loads(Path(file).read_text(encoding="utf-8")) for name, _, file in named}
    write_parts(DOCS / "learners.md", parts(spreads))
    curves = {name: [_curve(seed["curve"]) for seed in spread.values()] for name, spread in spreads.items()}
    learning_curves(DOCS / PICTURE, curves, "Success during training")


if __name__ == "__main__":
    main()

"""Write the tables of docs/learners.md from spreads over training seeds and from the choice of a reservoir.

    for p in reservoir reservoir-corrected cloning cloning-corrected gru; do
      python -m benchmarks.learners.training_spread --experiment learners --pilot $p \\
        --seeds 0 1 2 3 4 5 6 7 8 9 --episodes 300 --out spread-$p.json
    done
    python -m benchmarks.learners.reservoir_choice --out choice.json
    python -m benchmarks.learners.tables spread-*.json --choice choice.json

A spread is named spread-PILOT.json. Only the text between the marks is written.
"""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.config.learners import learner
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.reports.experiment import table

from benchmarks.learners.reservoir_choice import correlation
from benchmarks.markers import DOCS, write_parts

RESAMPLES = 10_000
SHARES = (0.0, 0.25, 0.5, 1.0)


def cards(spreads: dict[str, dict[str, Any]]) -> str:
    """One row a pilot: what it learned from, its training's processor time, success by level."""
    plans = load_experiment("learners").pilots
    rows = []
    for name, by_seed in spreads.items():
        seeds = list(by_seed.values())
        seconds = np.array([seed["training_cpu_seconds"] for seed in seeds])
        levels = [
            spread([seed["levels"][level]["success"] for seed in seeds]) for level in seeds[0]["levels"]
        ]
        result = learner(plans[name].kind).description(plans[name])
        rows.append([name, result, f"{np.median(seconds):.0f} s", str(len(seeds)), *levels])
    return table(["pilot", "learned from", "processor time", "seeds", *seeds[0]["levels"]], rows)


def curves(spreads: dict[str, dict[str, Any]]) -> str:
    """One row a pilot that tells how it learns: the mean over seeds, and the least and the greatest of them,
    at the first point, a quarter, half and the end of its training."""
    rows = []
    for name, by_seed in spreads.items():
        listed = [seed["curve"] for seed in by_seed.values() if seed["curve"]]
        logged = [set(point) for curve in listed for point in curve]
        quantity = next((one for one in ("success", "loss") if all(one in keys for keys in logged)), None)
        if quantity is None or not logged:
            continue
        ends = {f"{curve[-1]['step']:,}" for curve in listed}
        at = [[_value_at(curve, quantity, share) for curve in listed] for share in SHARES]
        cells = [f"{np.mean(values):.3g} ({min(values):.3g} to {max(values):.3g})" for values in at]
        rows.append([name, quantity, " or ".join(sorted(ends)), str(len(listed)), *cells])
    heads = [
        "pilot",
        "quantity",
        "steps",
        "seeds",
        "at the start",
        "at a quarter",
        "at half",
        "at the end",
    ]
    return table(heads, rows)


def _value_at(curve: list[dict[str, float]], quantity: str, share: float) -> float:
    """At a share of the way from the first point to the last, between points in a straight line."""
    steps = [point["step"] for point in curve]
    at = steps[0] + share * (steps[-1] - steps[0])
    return float(np.interp(at, steps, [point[quantity] for point in curve]))


def spread(success: list[float]) -> str:
    """Mean over training seeds, its bootstrap 95 % interval over them, and the least and the greatest."""
    values = np.array(success)
    if len(values) == 1:
        return f"{values[0]:.3f}"
    drawn = np.random.default_rng(0).choice(values, (RESAMPLES, len(values))).mean(axis=1)
    low, high = np.percentile(drawn, (2.5, 97.5))
    return f"{values.mean():.3f} ({low:.3f}–{high:.3f}), {values.min():.3f} to {values.max():.3f}"


def choice_tables(choice: dict[str, Any]) -> str:
    """Held-out errors against success, by dataset, and the time of a fit on one thread."""
    rows = [[f"dataset {name}", f"{value:.3f}"] for name, value in correlation(choice["grid"]).items()]
    rows.append(["settings and datasets", str(len(choice["grid"]))])
    rows.append(["fit of 500 units on 40 runs, s", f"{choice['fit_500_units_40_runs_s']:.2f}"])
    return table(["success at `standard` against held-out error", ""], rows)


def main() -> None:
    """Read the JSON files, write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("spreads", type=Path, nargs="*")
    parser.add_argument("--choice", type=Path)
    args = parser.parse_args()
    parts: dict[str, str] = {}
    if args.spreads:
        read = {
            p.stem.removeprefix("spread-"): json.loads(p.read_text(encoding="utf-8")) for p in args.spreads
        }
        parts |= {"cards": cards(read), "curves": curves(read)}
    if args.choice is not None:
        parts["choice"] = choice_tables(json.loads(args.choice.read_text(encoding="utf-8")))
    write_parts(DOCS / "learners.md", parts)


if __name__ == "__main__":
    main()

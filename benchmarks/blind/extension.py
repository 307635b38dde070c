"""Forces outside the library, estimated, and what they save on runs that nothing was fitted to.

    python -m benchmarks.blind.extension --cases 8 --out extension --into docs/criticism.md

Each case has one of a mooring line, a thruster that does not start below some throttle, and something in tow.
Five runs of 80 s with RTK noise are given to the estimate of the missing force, its verdict `unexplained`
taken as known; five more runs of the same boat measure the position error 10 s ahead. A case counts as
recovered where the force was written as a function of one of the true variables and that error falls.
"""

import argparse
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.synthetic.cases import (
    DT,
    RTK,
    Case,
    Rng,
    dead_zone,
    drogue,
    measure,
    mooring,
    voyages,
)

from benchmarks.blind.score import share
from benchmarks.markers import write_parts
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.cause_share import Witness
from swamp_rl.criticism.inference.force_extension import extend_by_force, prediction_shares
from swamp_rl.criticism.inference.force_regression import residual_force_functions
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import Hypothesis

FORCES = {"mooring": mooring, "dead_zone": dead_zone, "drogue": drogue}
NONE = np.zeros(0)


def sailed(case: Case, rng: Rng) -> RunSet:
    """Five runs as they were measured."""
    found = voyages(case, rng)
    seen = np.stack([measure(one, RTK, rng)[0] for one in found])
    seen[..., 2] = np.unwrap(seen[..., 2])
    commands = np.stack([one.commands for one in found])
    lengths = np.full(len(found), seen.shape[1])
    return RunSet(load_boat("swamp"), DT, tuple("abcde"), commands, seen, lengths)


def judged(what: str, number: int) -> dict[str, Any]:
    """One case: what was hidden, what was written, and the errors on the other runs."""
    begun = time.process_time()
    rng = np.random.default_rng([list(FORCES).index(what), number])
    size = float(rng.uniform(0.5, 1.5))
    case = Case("A", "outside", [], size, FORCES[what](rng, size, "A"))
    runs, others = sailed(case, rng), sailed(case, rng)
    weight, of_others = weights(runs, noise_levels(runs)), weights(others, noise_levels(others))
    leftover = residual_force_functions(runs, weight, [(Hypothesis(), NONE)])
    problem = Shooting(runs, weight, 10.0)
    base = fit(problem, Hypothesis(), NONE, problem.initial_states(), 2)
    on = Witness(runs, weight, False)
    found = extend_by_force(runs, weight, base, leftover, on, np.random.default_rng(0))
    entries = {"what": what, "number": number, "size": size, "written": False}
    if found is None:
        return entries | {"seconds": time.process_time() - begun}
    assert case.outside is not None
    shares = prediction_shares(
        found.problem, found.less, found.fit, Witness(others, of_others, True), np.random.default_rng(0)
    )
    error = next(one for one in shares if (one.horizon_s, one.quantity) == (10.0, "position_rmse_m"))
    variables = [f"{curve.covariate}_{curve.thruster or ''}".strip("_") for curve in found.result.curves]
    true = [
        variable in case.outside["variables"] or variable.split("_")[0] in case.outside["variables"]
        for variable in variables
    ]
    return entries | {
        "written": found.result.written,
        "curves": [curve.model_dump() for curve in found.result.curves],
        "right": any(true),
        "without": error.without,
        "with": error.with_cause,
        "ci95": error.ci95,
        "seconds": time.process_time() - begun,
    }


def recovered(one: dict[str, Any]) -> bool:
    """Whether the force was written as a function of a true variable and helps on other runs."""
    return bool(one["written"] and one["right"] and one["with"] < one["without"])


def extension_table(results: Sequence[dict[str, Any]]) -> str:
    """By force: how many were recovered, and the error with the force over that without it."""
    rows = []
    for name in [*FORCES, "all"]:
        mine = [one for one in results if name in (one["what"], "all")]
        written = [one for one in mine if one["written"]]
        rate = share([recovered(one) for one in mine])
        if rate is None:
            continue
        left = [one["with"] / one["without"] for one in written]
        formulas = sum(any(curve["formula"] for curve in one["curves"]) for one in written)
        rows.append(
            [
                name,
                f"{rate['rate']:.2f} ({rate['low']:.2f} to {rate['high']:.2f}; {rate['of']:.0f})",
                f"{np.median(left):.2f}" if left else "-",
                f"{sum(one['with'] > one['without'] for one in written)} of {len(written)}",
                str(formulas),
            ]
        )
    heads = ["hidden force", "recovered", "remaining error, median", "extended and worse", "as a formula"]
    return table(heads, rows)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the cases that are not yet stored, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cases", type=int, default=8, help="of each force")
    parser.add_argument("--minutes", type=float, default=np.inf, help="after which no case is begun")
    parser.add_argument("--out", type=Path, default=Path("extension"))
    parser.add_argument("--into", type=Path, help="a document that the table is written into")
    asked = parser.parse_args(arguments)
    asked.out.mkdir(parents=True, exist_ok=True)
    until = time.monotonic() + 60.0 * asked.minutes
    for number in range(asked.cases):
        for what in FORCES:
            kept = asked.out / f"{what}{number:03d}.json"
            if not kept.exists() and time.monotonic() < until:
                kept.write_text(json.dumps(judged(what, number), indent=1))
                print(kept.read_text(), flush=True)
    results = [json.loads(path.read_text()) for path in sorted(asked.out.glob("*.json"))]
    result = extension_table(results)
    if asked.into:
        write_parts(asked.into, {"blind extension": result})
    print(result)


if __name__ == "__main__":
    main()

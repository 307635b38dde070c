"""Write the golden cases: small stored datasets, and what a diagnosis must say of each.

    python -m benchmarks.blind.golden tests/criticism/golden [CASE ...]

A case is a folder of runs, `scripted`; `golden.yaml` says of each what is wrong, as it was put in, the
verdict and names that are asked for, and the least standard deviation (Cramér-Rao) of each number. Cases
whose truth is in no library effect are to be `unexplained`. `reason` marks those that today's diagnosis gets
wrong.
"""

import argparse
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.synthetic.cases import (
    Array,
    Case,
    Rng,
    deviations,
    drivers,
    measure,
    sail,
    voyages,
    write_runs,
)
from swamp_rl.experiments.synthetic.cases import table as columns_of
from swamp_rl.experiments.synthetic.drivers import Driver

from benchmarks.blind.bound import bound_of
from benchmarks.blind.golden_cases import GOLDEN, Golden
from benchmarks.blind.variants import TICK, held, rows_of
from swamp_rl.boat import Boat, load_boat
from swamp_rl.files import write_yaml

TRUTH = "golden.yaml"
HOLD = (3.0, 9.0)  # s for which a thruster of another boat is given one command
NAMES = ("effect", "thruster")


def write_golden(name: str, golden: Golden, folder: Path) -> None:
    """The runs of a case into a folder of its name, its positions and velocities in single precision."""
    own = folder / name
    boat = load_boat(own / golden.boat if golden.boat.endswith(".yaml") else golden.boat)
    tables = [single(columns, golden.faulty) for columns in tables_of(golden, boat)]
    own.mkdir(parents=True, exist_ok=True)
    for path in own.glob("*.parquet"):
        path.unlink()
    write_runs(own, golden.boat, boat, tables, "scripted", "parquet")


def tables_of(golden: Golden, boat: Boat) -> list[dict[str, Array]]:
    """The columns of every run."""
    rng, case = np.random.default_rng(golden.seed), golden.case
    if golden.instruments is not None:
        return [rows_of(boat, one, golden.instruments, rng) for one in sailed(golden, boat, rng)]
    found = []
    for voyage in voyages(case, rng, golden.runs, golden.seconds):
        measured, kept = measure(voyage, deviations(case.level), rng)
        columns = columns_of(boat, measured, voyage.commands, case.level != "B")
        found.append({key: values[kept] for key, values in columns.items()})
    return found


def sailed(golden: Golden, boat: Boat, rng: Rng) -> list[Any]:
    """Voyages in steps of `TICK`; another boat than SWAMP is driven by random steps of its thrusters."""
    assert golden.instruments is not None
    if golden.boat == "swamp":
        driven = drivers(golden.case, rng, golden.runs)
    else:
        driven = [(steps_of(boat, rng), np.zeros(3)) for _ in range(golden.runs)]
    period, steps = 1.0 / golden.instruments.rate, round(golden.seconds / TICK)
    return [
        sail(boat, golden.case.of_run(run), held(driver, period), start, steps, tick=TICK)
        for run, (driver, start) in enumerate(driven)
    ]


def steps_of(boat: Boat, rng: Rng) -> Driver:
    """Every thruster for itself, within half a turn or what it can turn, changed after some seconds."""
    azimuths = [np.clip([-math.pi / 2, math.pi / 2], t.azimuth_min, t.azimuth_max) for t in boat.thrusters]
    count = 100
    changes = np.cumsum(rng.uniform(*HOLD, count))
    angles = np.stack([rng.uniform(low, high, count) for low, high in azimuths], axis=1)
    levels = rng.uniform(0.2, 1.0, (count, len(boat.thrusters)))
    every = np.concatenate([angles, levels], axis=1)
    return lambda time, state: every[np.searchsorted(changes, time)]


def single(columns: Mapping[str, Array], faulty: str) -> dict[str, NDArray[Any]]:
    """Columns in single precision; `faulty`: one that is turned round."""
    turned = {faulty: -columns[faulty]} if faulty else {}
    return {key: values.astype(np.float32) for key, values in (dict(columns) | turned).items()}


def expected(golden: Golden) -> dict[str, Any]:
    """What the diagnosis of a case must say, from its truth alone."""
    meta: dict[str, Any] = {"family": golden.family, "boat": golden.boat, "verdict": golden.verdict}
    case = golden.case
    least = bounds(golden)
    if case.effects:
        meta["causes"] = [cause(effect, least) for effect in case.effects]
    if case.by_run:
        meta["by_run"] = [
            {effect["effect"]: {key: value for key, value in effect.items() if key not in NAMES}}
            for (effect,) in case.by_run
        ]
    if case.outside:
        meta["outside"] = case.outside
    if golden.instruments is not None and golden.instruments.wander:
        meta["wander"] = golden.instruments.wander
    meta |= {key: getattr(golden, key) for key in ("refused", "reason") if getattr(golden, key)}
    return meta


def cause(effect: Mapping[str, Any], least: Mapping[tuple[str, str], float]) -> dict[str, Any]:
    """An effect with each of its numbers: what it truly is, and the bound on its standard deviation."""
    numbers = {
        key: {"truth": float(value)} | ({"bound": least[effect["effect"], key]} if least else {})
        for key, value in effect.items()
        if key not in NAMES
    }
    return {key: effect[key] for key in NAMES if key in effect} | {"numbers": numbers}


def bounds(golden: Golden) -> dict[tuple[str, str], float]:
    """Of every number, where the noise is white and the boat SWAMP; else none."""
    case: Case = golden.case
    if golden.verdict != "cause" or golden.instruments is not None:
        return {}
    rng = np.random.default_rng(golden.seed)
    bound = bound_of(case, rng, golden.level != "B", golden.runs, golden.seconds)
    return {name: float(f"{size:.3g}") for name, size in zip(bound.names, bound.deviation, strict=True)}


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the cases that are named, or all, and what is asked of every case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("cases", nargs="*", metavar="CASE", help="those to be written anew, all by default")
    asked = parser.parse_args(arguments)
    if unknown := sorted(set(asked.cases) - set(GOLDEN)):
        parser.error(f"{unknown[0]}: is no golden case; choose among {', '.join(GOLDEN)}")
    for name in asked.cases or GOLDEN:
        write_golden(name, GOLDEN[name], asked.folder)
    write_yaml(asked.folder / TRUTH, {name: expected(golden) for name, golden in GOLDEN.items()})


if __name__ == "__main__":
    main()

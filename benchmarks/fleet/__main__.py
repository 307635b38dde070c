"""What `swamp-rl fleet` finds of known faults in a fleet, and how much faster several workers are.

    python -m benchmarks.fleet --logs 200 --workers 2

Writes the table of docs/fleet.md. Every boat sails on two days: half the boats have nothing, a quarter share
a weak port bow thruster, an eighth gains mass between the days, an eighth loses a thruster on the second.
"""

import argparse
import json
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.fleet import diagnose_fleet
from swamp_rl.experiments.fleet.result import Fleet
from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.synthetic.cases import Case, write_case

from benchmarks.markers import DOCS, write_parts

DAYS = ("may", "june")
RUNS, SECONDS = 3, 60.0
KINDS = ("none", "weak", "none", "mass", "none", "weak", "none", "failure")
LABEL = {"weak": "thruster_gain bp", "mass": "mass", "failure": "thruster_gain ss"}


def truth(number: int, day: int) -> list[dict[str, Any]]:
    """The effects of a boat on a day."""
    rng = np.random.default_rng([31, number])
    kind = KINDS[number % len(KINDS)]
    if kind == "weak":
        return [{"effect": "thruster_gain", "thruster": "bp", "gain": float(rng.uniform(0.75, 0.9))}]
    if kind == "mass":
        return [{"effect": "mass", "mass": float(rng.uniform(60.0, 63.0)) + 4.0 * day}]
    if kind == "failure" and day:
        # from the start of every run: a failure at an instant within a run would be another effect
        return [{"effect": "thruster_gain", "thruster": "ss", "gain": 0.0}]
    return []


def write_fleet(folder: Path, logs: int) -> list[Path]:
    """The datasets of a fleet, FOLDER/BOAT/DAY."""
    given = []
    for log in range(logs):
        number, day = divmod(log, len(DAYS))
        effects, rng = truth(number, day), np.random.default_rng([32, log])
        case = Case("A", "single" if effects else "clean", effects)
        given.append(folder / "logs" / f"boat{number:03}" / DAYS[day])
        given[-1].parent.mkdir(parents=True, exist_ok=True)
        write_case(case, rng, given[-1], folder / "truth" / f"{log}.json", RUNS, SECONDS)
    return given


def right_and_wrong(found: Fleet) -> Iterator[tuple[str, int, int]]:
    """What is counted, how many there are in truth, and how many of them the fleet tells."""
    boats = sorted({one.boat for one in found.members})
    own = {name: KINDS[int(name.removeprefix("boat")) % len(KINDS)] for name in boats}
    kept = [(one.boat, one.cause) for one in found.findings if one.kept]
    expected = {(one.boat, LABEL[own[one.boat]]) for one in found.members if own[one.boat] != "none"}
    yield "boats with a fault, whose fault is kept", len(expected), len(expected & set(kept))
    shared = next((one.boats for one in found.shared if one.cause == LABEL["weak"]), [])
    weak = [name for name in boats if own[name] == "weak"]
    yield "boats with the shared weak thruster", len(weak), len(set(weak) & set(shared))
    heavy = {name for name in boats if own[name] == "mass"}
    yield "boats whose mass differs by day", len(heavy), len(heavy & {one.boat for one in found.drifts})
    lost = {name for name in boats if own[name] == "failure"}
    yield "boats that lose a thruster by day", len(lost), len(lost & {one.boat for one in found.changes})
    false = [pair for pair in kept if pair not in expected]
    yield "causes kept; of these, false", len(kept), len(false)


def seconds_of(given: Sequence[Path], out: Path, workers: int) -> float:
    """Wall time of a fleet."""
    begun = time.perf_counter()
    diagnose_fleet(given, out, workers=workers)
    return time.perf_counter() - begun


def main(arguments: Sequence[str] | None = None) -> None:
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    asked.add_argument("--logs", type=int, default=200)
    asked.add_argument("--workers", type=int, default=2)
    asked.add_argument("--timed", type=int, default=40, help="logs that one worker does again, for the ratio")
    options = asked.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="swamp-rl-fleet-") as name:
        folder = Path(name)
        given = write_fleet(folder, options.logs)
        few = given[: options.timed]
        alone = seconds_of(few, folder / "alone", 1)
        ratio = alone / seconds_of(few, folder / "together", options.workers)
        diagnose_fleet(given, folder / "whole", workers=options.workers)
        found = Fleet.model_validate(json.loads((folder / "whole" / "fleet.json").read_text()))
    rows = [list(map(str, row)) for row in right_and_wrong(found)]
    rows.append(
        [
            "logs without a diagnosis",
            str(options.logs),
            str(sum(one.verdict is None for one in found.members)),
        ]
    )
    rows.append([f"speed-up with {options.workers} workers", f"{len(few)} logs", f"{ratio:.2f}"])
    write_parts(
        DOCS / "fleet.md", {"fleet": table([f"of {options.logs} logs", "true", "in fleet.json"], rows)}
    )


if __name__ == "__main__":
    main()

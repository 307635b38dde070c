"""How long a step of each pilot takes and where an evaluation's time goes, written into docs/models.md.

    swamp-rl train camogli --out results/speed --set pilots.ppo.options.decisions=100000
    python -m benchmarks.speed.pilots results/speed

Of the pilots stored in a folder of results. How well PPO has learned changes how long its episodes last, and
not how long its step takes. `--only steps` or `--only evaluations` writes one of the tables.
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.errors import UserError
from swamp_rl.evaluation.rollout import drive
from swamp_rl.export import OnnxPilot, greatest_difference, write_onnx
from swamp_rl.export.timing import step_microseconds
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.store import load_pilot

EPISODES, LEVEL = 1000, "standard"
FIRST_EPISODE = 3_000_000
"Of episodes that no experiment evaluates."


def step_row(name: str, pilot: Pilot, folder: Path) -> list[str]:
    """Of the table of steps: what it takes in NumPy, and what its ONNX file is like."""
    rng, file = np.random.default_rng(0), folder / f"{name}.onnx"
    pilot.reset(1)
    plain = f"{step_microseconds(pilot.act, len(pilot.senses), rng):.0f}"
    try:
        write_onnx(pilot, file)
    except UserError:
        return [name, pilot.kind, plain, "—", "—", "—"]
    difference = greatest_difference(pilot, file, rng)
    exported = OnnxPilot(file)
    exported.reset(1)
    first = np.zeros((1, 2)) if exported.wants_first else None
    there = step_microseconds(lambda seen: exported.act(seen, first), len(exported.senses), rng)
    kib = file.stat().st_size / 1024
    return [name, pilot.kind, plain, f"{there:.0f}", f"{difference:.0e}", f"{kib:.0f}"]


class Timed:
    """A pilot or boats with the wall time of one method added up; all else is the thing's own."""

    def __init__(self, thing: Any, method: str) -> None:
        self._thing, self.seconds = thing, 0.0
        setattr(self, method, self._timed(getattr(thing, method)))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._thing, name)

    def _timed(self, work: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*given: Any) -> Any:
            begin = time.perf_counter()
            try:
                return work(*given)
            finally:
                self.seconds += time.perf_counter() - begin

        return timed


def evaluation_row(name: str, pilot: Pilot) -> list[str]:
    """Of the table of evaluations: the time of all episodes in one batch, and its shares."""
    boats: list[Timed] = []

    def make(n: int, senses: tuple[str, ...]) -> Any:
        boats.append(Timed(GatesVectorEnv(n, disturbances=LEVEL, observation=senses), "step"))
        return boats[-1]

    driver, begin, processor = Timed(pilot, "act"), time.perf_counter(), time.process_time()
    rollout = drive(driver, make, FIRST_EPISODE + np.arange(EPISODES))
    wall, processor = time.perf_counter() - begin, time.process_time() - processor
    shares = [100.0 * part / wall for part in (driver.seconds, boats[0].seconds)]
    shares.append(100.0 - sum(shares))
    steps = rollout.pose.shape[1] - 1
    return [name, f"{wall:.1f}", f"{processor:.1f}", str(steps), *(f"{share:.0f}" for share in shares)]


def steps_table(pilots: Mapping[str, Pilot]) -> str:
    """A row for each pilot."""
    head = ["pilot", "kind", "NumPy [µs]", "onnxruntime [µs]", "greatest difference", "file [KiB]"]
    with tempfile.TemporaryDirectory() as folder:
        return table(head, [step_row(name, pilot, Path(folder)) for name, pilot in pilots.items()])


def evaluations_table(pilots: Mapping[str, Pilot]) -> str:
    """A row for each pilot, after one episode by which all is compiled."""
    drive(
        next(iter(pilots.values())),
        lambda n, s: GatesVectorEnv(n, disturbances=LEVEL, observation=s),
        np.zeros(1, int),
    )
    head = ["pilot", "wall [s]", "processor [s]", "steps", "pilot [%]", "boats [%]", "rest [%]"]
    return table(head, [evaluation_row(name, pilot) for name, pilot in pilots.items()])


TABLES = {"steps": steps_table, "evaluations": evaluations_table}


def main() -> None:
    """Measure every pilot of a folder of results, and rewrite the page's tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path)
    parser.add_argument("--only", choices=TABLES)
    asked = parser.parse_args()
    folders = [folder for folder in sorted((asked.results / "pilots").iterdir()) if folder.is_dir()]
    pilots = {folder.name: load_pilot(folder) for folder in folders}
    for name in [asked.only] if asked.only else TABLES:
        write_parts(DOCS / "models.md", {name: TABLES[name](pilots)})


if __name__ == "__main__":
    main()

"""Diagnoses of an identified boat on another day, with and without the errors of its file.

    python -m benchmarks.boat_fit.then_diagnose 8 9

Eight boats from seed 9, as of `benchmarks.boat_fit.coverage`, in calm weather. Each is identified from one
day and diagnosed on another: as it was, and with less thrust.
"""

import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.reports.experiment import table

from benchmarks.boat_fit.coverage import drawn_boat, sailed
from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat_fit.boat_file import identified_mapping
from swamp_rl.boat_fit.fit import fit_boat
from swamp_rl.boat_fit.hypothesis import FreeBoat
from swamp_rl.boat_fit.identify import numbers_of
from swamp_rl.constants import Z95
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.diagnose import examine
from swamp_rl.criticism.model.candidates import ONE_RUN
from swamp_rl.criticism.result import Cause, Diagnosis
from swamp_rl.effects.apply import apply_effects
from swamp_rl.effects.entries import parse_effects
from swamp_rl.files import write_yaml
from swamp_rl.one_thread import one_thread

CAUSE, SCALE = "thrust_scale", 0.9
FILES = "with `covariance`", "as exact"


@dataclass(frozen=True)
class Weaker(FreeBoat):
    """The boat with SCALE of its thrust."""

    def records(
        self,
        boat: Boat,
        x: NDArray[np.float64],
        plain: NDArray[Any] | None = None,
        runs: NDArray[np.int64] = ONE_RUN,
    ) -> NDArray[Any]:
        """As `FreeBoat.records`."""
        made = super().records(boat, x, plain, runs)
        entries = parse_effects([{"effect": CAUSE, "scale": SCALE}], "weaker", boat.thruster_names)
        apply_effects(made, entries, boat.thruster_names)
        return made


def identified(boat: Boat, plain: FreeBoat, runs: RunSet) -> Boat:
    """The boat of the file that the fit to these runs writes."""
    made = fit_boat(runs, weights(runs, noise_levels(runs)), plain, plain.start())
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "identified.yaml"
        write_yaml(file, identified_mapping(boat, "identified", numbers_of(made), "day 1"))
        return load_boat(file)


def scale_of(cause: Cause) -> tuple[float, float] | None:
    """Value and standard error of a cause that is the hidden one; None of another."""
    if cause.effect != CAUSE:
        return None
    (own,) = cause.parameters.values()
    return own.value, own.standard_error


def judged(found: Diagnosis, hidden: bool) -> list[float]:
    """Whether a diagnosis is right of a healthy day; whether it explains the other day by what is hidden,
    names that at all, with an interval that holds it, and names another effect. NaN: no question of that day.
    """
    scales = [scale_of(cause) for cause in found.causes]
    own = next((one for one in scales if one), None)
    if not hidden:
        return [float(found.verdict == "nothing_wrong"), np.nan, np.nan, np.nan, np.nan]
    explained = found.verdict == "cause" and own is not None
    holds = abs(own[0] - SCALE) < Z95 * own[1] if own else np.nan
    others = any(one is None for one in scales)
    return [np.nan, float(explained), float(own is not None), float(holds), float(others)]


@one_thread()
def days(number: int, seed: int) -> tuple[str, dict[str, list[list[float]]]]:
    """A line on boat `number`, and by the file what `judged` says of the healthy and of the weaker day."""
    kind, boat, plain, truth, runs = drawn_boat(2 * number, seed)  # every other one sails in gusts
    began = time.process_time()
    file = identified(boat, plain, runs)
    entries: dict[str, list[list[float]]] = {name: [] for name in FILES}
    lines = []
    for hidden in (False, True):
        hypothesis = Weaker(plain.instances, plain.numbers) if hidden else plain
        day = sailed(hypothesis, boat, truth, False, np.random.default_rng([seed, number, 2]))
        for name, known in zip(FILES, (file.covariance, None), strict=True):
            of = replace(day, boat=file.model_copy(update={"covariance": known}))
            found = examine(of, None, np.random.default_rng(seed)).diagnosis
            entries[name].append(judged(found, hidden))
            lines.append(f"{found.verdict} ({', '.join(cause.label for cause in found.causes)})")
    line = f"{kind} {boat.length:.2f} m, {time.process_time() - began:.0f} s: {'; '.join(lines)}"
    return line, entries


def table_of(entries: dict[str, list[list[list[float]]]]) -> str:
    """Of each file, how often each of `judged` is so."""
    rows = []
    for name, boats in entries.items():
        columns = np.concatenate(boats).T
        asked = [column[np.isfinite(column)] for column in columns]
        rows.append([name, *(f"{int(column.sum())} of {len(column)}" for column in asked)])
    heads = ["boat file", "healthy: nothing wrong", "less thrust: explained", "named", "interval holds it"]
    return table([*heads, "another effect named"], rows)


def main(count: int, seed: int) -> None:
    """Print a line a boat, and write the table after each; two processes."""
    entries: dict[str, list[list[list[float]]]] = {name: [] for name in FILES}
    with ProcessPoolExecutor(2) as pool:
        for number, (line, own) in enumerate(pool.map(days, range(count), [seed] * count)):
            print(f"{number}: {line}", flush=True)
            for name in FILES:
                entries[name].append(own[name])
            write_parts(DOCS / "identify_boat.md", {"then-diagnose": table_of(entries)})
    print(table_of(entries))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))

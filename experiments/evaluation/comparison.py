"""Pilots of several results compared: on the same episodes, over training seeds, with corrected p-values."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from functools import reduce
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.artifacts.result_folders import (
    Entrant,
    Result,
    entrants,
    find_results,
    read_result,
    refuse_other_settings,
)

from swamp_rl.counted import counted
from swamp_rl.errors import UserError
from swamp_rl.evaluation import (
    Interval,
    Table,
    holm,
    interquartile_mean,
    mean_over_tasks,
    paired_difference,
    probability_of_improvement,
    sign_flip_test,
    success_difference,
    success_difference_of_seeds,
    wilson,
    with_episodes,
)
from swamp_rl.evaluation.permutation import RESAMPLES
from swamp_rl.explain import nearest

Array = NDArray[np.float64]
Episodes = Mapping[str, NDArray[np.int64]]
"""By level, the seeds of the episodes that all have driven."""

QUANTITIES = ("success", "time", "command_change", "energy")
PER_METRE = "energy_per_metre"
"Compared too where all results have it."
ROUNDING = 1e-6
"Costs of an episode that differ by less than this share are equal: an exported pilot computes in other bits."
FINEST = 40
"The smallest p-value that is drawn is a 40th of the level over the number of comparisons, or smaller."


def compare(paths: Sequence[Path], seed: int = 0, only: Sequence[str] = ()) -> dict[str, Any]:
    """Everything of compare.json; `seed` of all that is drawn. only: names of the pilots, all by default;
    episodes, levels and notes are those of these alone.

    UserError for what does not compare.
    """
    results = [read_result(folder) for folder in find_results(paths)]
    refuse_other_settings(results)
    rng = np.random.default_rng(seed)
    pilots = named(entrants(results), only)
    results = with_pilots(results, pilots)
    episodes, notes = common_episodes(results)
    quantities = quantities_of(results)
    planned = math.comb(len(pilots), 2) * len(episodes) * len(quantities)
    pairs = list(combinations(pilots, 2))
    made = [row for a, b in pairs for row in _pair(a, b, episodes, quantities, planned, rng)]
    for row, corrected in zip(made, holm([row["p"] for row in made]), strict=True):
        row["p_corrected"] = corrected
    first = results[0]
    return {
        "folders": [str(result.folder) for result in results],
        "boat": first.experiment.get("boat"),
        "course": first.experiment.get("course"),
        "levels": {level: len(seeds) for level, seeds in episodes.items()},
        "notes": notes + repeat_notes(results, pilots) + version_notes(results),
        "seed": seed,
        "pilots": [pilot_row(pilot, episodes, rng, quantities) for pilot in pilots],
        "comparisons": sum(math.isfinite(row["p"]) for row in made),
        "differences": [without_nan(row) for row in made],
        "improvement": [_improvement(a, b, episodes, rng) for a, b in pairs],
    }


def named(pilots: list[Entrant], only: Sequence[str]) -> list[Entrant]:
    """The pilots of the names `only`, in the results or in the report; all where there are no names. Those of
    a closed loop, such as `ppo, nominal`, also by the name alone, of both simulators.

    UserError for a name that none has.
    """
    names = [
        {one.label, one.pilot, one.pilot.partition(", ")[0], *(pilot for pilot, _ in one.members)}
        for one in pilots
    ]
    for name in only:
        if not any(name in known for known in names):
            every = list(dict.fromkeys(one.pilot for one in pilots))
            raise UserError(f"no pilot {name!r} in the results{nearest(name, every)}")
    return [one for one, known in zip(pilots, names, strict=True) if not only or known & set(only)]


def with_pilots(results: Sequence[Result], pilots: Sequence[Entrant]) -> list[Result]:
    """The results that hold one of `pilots`, with the episodes of these alone."""
    members = {(pilot, result.folder) for one in pilots for pilot, result in one.members}

    def tables(result: Result) -> dict[tuple[str, str], Table]:
        every = result.tables.items()
        return {(pilot, at): table for (pilot, at), table in every if (pilot, result.folder) in members}

    return [replace(result, tables=found) for result in results if (found := tables(result))]


def quantities_of(results: Sequence[Result]) -> tuple[str, ...]:
    """What is compared: `QUANTITIES`, and the electric energy per metre where every table has it."""
    electric = all(PER_METRE in table for result in results for table in result.tables.values())
    return (*QUANTITIES, PER_METRE) if electric else QUANTITIES


def common_episodes(results: Sequence[Result]) -> tuple[Episodes, list[str]]:
    """The episodes at each level that every pilot of every result has driven, and what to say about the rest.

    UserError where there is no level or no episode in common.
    """
    levels = [level for level in results[0].levels if all(level in result.levels for result in results)]
    if not levels:
        raise UserError("the results have no level in common; evaluate the pilots at the same levels")
    notes = []
    left = sorted({level for result in results for level in result.levels} - set(levels))
    if left:
        notes.append(f"Not every result has the level {', '.join(left)}: left out.")
    common = {}
    for level in levels:
        driven = [t["seed"] for r in results for (_, at), t in r.tables.items() if at == level]
        common[level] = reduce(np.intersect1d, driven)
        if not len(common[level]):
            raise UserError(f"level {level}: no episode that all have driven; evaluate from the same seed")
        most = max(len(seeds) for seeds in driven)
        if most > len(common[level]):
            notes.append(
                f"{level}: only the {counted(len(common[level]), 'episode')} that all have driven, of {most}."
            )
    return common, notes


def repeat_notes(results: Sequence[Result], pilots: Sequence[Entrant]) -> list[str]:
    """A line for each result with pilots that are those of an earlier one, so that they count once."""
    counted = {(pilot, result.folder) for one in pilots for pilot, result in one.trained}
    notes = []
    for result in results:
        again = [pilot for pilot in result.pilots if (pilot, result.folder) not in counted]
        if again:
            notes.append(
                f"{result.folder}: {', '.join(again)} did the same, in every shared episode, as in a result "
                "named earlier: counted once."
            )
    return notes


def version_notes(results: Sequence[Result]) -> list[str]:
    """A line where the results were made by different commits."""
    commits = sorted({str(result.versions.get("commit")) for result in results})
    return [f"Made by different commits: {', '.join(commits)}."] if len(commits) > 1 else []


def at_common(table: Table, seeds: NDArray[np.int64], quantity: str) -> Array:
    """(n,) of a quantity at the episodes of `seeds`, NaN for the cost of a failed one."""
    _, place, _ = np.intersect1d(table["seed"], seeds, return_indices=True)
    values = table[quantity][place].astype(float)
    return values if quantity == "success" else np.where(table["success"][place], values, np.nan)


def scores(pilot: Entrant, episodes: Episodes, quantity: str = "success") -> Array:
    """(S, levels) means over the episodes; NaN for a cost where no episode succeeded."""
    rows: list[list[float]] = [[] for _ in pilot.results]
    for level, seeds in episodes.items():
        for row, table in zip(rows, pilot.tables(level), strict=True):
            row.append(mean(at_common(table, seeds, quantity)))
    return np.array(rows)


def mean(values: Array) -> float:
    """Mean of what is not NaN; NaN of nothing."""
    values = values[np.isfinite(values)]
    return float(values.mean()) if len(values) else math.nan


def pilot_row(
    pilot: Entrant, episodes: Episodes, rng: np.random.Generator, quantities: Sequence[str] = QUANTITIES
) -> dict[str, Any]:
    """A pilot's success at each level and over all, with its intervals and mean costs."""
    table = scores(pilot, episodes)
    levels = {}
    for column, (level, seeds) in enumerate(episodes.items()):
        own, n = table[:, column], len(seeds)
        of_seeds = with_episodes(interquartile_mean(own[:, None], rng), n)
        found = of_seeds if len(own) > 1 else wilson(round(own[0] * n), n)
        levels[level] = {
            "success": without_nan(asdict(found)),
            "interval": "bootstrap over training seeds, Wilson over episodes"
            if len(own) > 1
            else "Wilson over episodes",
            "by_seed": own.tolist(),
        }
    for quantity in quantities[1:]:
        means = [mean(column) for column in scores(pilot, episodes, quantity).T]
        for level, value in zip(levels, means, strict=True):
            levels[level][quantity] = value if math.isfinite(value) else None
    over_all = with_episodes(mean_over_tasks(table, rng), sum(map(len, episodes.values())))
    return {
        "name": pilot.label,
        "seeds": len(pilot.results),
        "folders": [str(result.folder) for result in pilot.results],
        "levels": levels,
        "all_levels": without_nan(asdict(over_all)),
    }


def _pair(
    a: Entrant,
    b: Entrant,
    episodes: Episodes,
    quantities: Sequence[str],
    planned: int,
    rng: np.random.Generator,
) -> list[dict[str, Any]]:
    """a − b at each level in each quantity: each episode's mean over training seeds, paired."""
    rows = []
    for level, seeds in episodes.items():
        for quantity in quantities:
            first, second = (_over_seeds(one.tables(level), seeds, quantity) for one in (a, b))
            second = np.where(np.isclose(first, second, rtol=ROUNDING, atol=0.0), first, second)
            if quantity != "success":
                found = paired_difference(first, second, rng)
            elif len(a.results) == len(b.results) == 1:  # each episode succeeds or fails
                found = success_difference(first, second)
            else:
                found = success_difference_of_seeds(first, second, rng)
            p = sign_flip_test(first - second, rng, max(RESAMPLES, FINEST * planned)) if found.n else math.nan
            row = {"a": a.label, "b": b.label, "level": level, "quantity": quantity}
            rows.append(row | asdict(found) | {"p": p})
    return rows


def _over_seeds(tables: Sequence[Table], seeds: NDArray[np.int64], quantity: str) -> Array:
    """(n,) each episode's mean over the training seeds that have a value."""
    values = np.array([at_common(table, seeds, quantity) for table in tables])
    known = np.isfinite(values)
    count = known.sum(axis=0)
    return np.where(count > 0, np.where(known, values, 0.0).sum(axis=0) / np.maximum(count, 1), np.nan)


def _improvement(a: Entrant, b: Entrant, episodes: Episodes, rng: np.random.Generator) -> dict[str, Any]:
    found: Interval = probability_of_improvement(scores(a, episodes), scores(b, episodes), rng)
    return {"a": a.label, "b": b.label} | without_nan(asdict(found))


def without_nan(row: Mapping[str, Any]) -> dict[str, Any]:
    """None in place of NaN, as JSON has it."""
    return {k: None if isinstance(v, float) and not math.isfinite(v) else v for k, v in row.items()}

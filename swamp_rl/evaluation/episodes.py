"""One row for each evaluated episode, and the figures that sum many of them up."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.clipped import clipped
from swamp_rl.energy import missing, pack_power, range_left
from swamp_rl.errors import UserError
from swamp_rl.evaluation.metrics import bollard_thrust, command_change, jet_areas, jet_power, path_length
from swamp_rl.evaluation.rollout import Rollout
from swamp_rl.evaluation.statistics import ENDS, Interval, paired_difference, success_difference, wilson
from swamp_rl.names import refuse_odd_label
from swamp_rl.ordinary import contents

Table = dict[str, NDArray[Any]]
COSTS = ("time", "path_length", "command_change", "energy")
"""Costs of an episode: s, m, 1 per step, J. Failed ones have them too, but only successes are averaged."""

ELECTRIC = ("electric_energy", "energy_per_metre", "range")
"""Costs of an episode with a boat whose file has a battery: J, J/m, m."""

RETURN = "return"
"""Sum of an episode's rewards."""
COLUMNS = ("seed", "success", "outcome", *COSTS)
"""What every table of episodes has; older ones have no `RETURN`."""
TEXTS = ("pilot", "level", "outcome")


def episode_table(rollout: Rollout, boat: Boat, step: float) -> Table:
    """`COLUMNS`, `RETURN` and, where the boat file has a battery, `ELECTRIC`, each (n,).

    time [s]; path_length [m]; command_change [1]; energy [J]: kinetic, of the jets' wake, as `jet_power`;
    electric_energy [J]: drawn from all packs, the hotel load included; energy_per_metre [J/m]: that over the
    path; range [m]: `range_left` with the charge at the start, full packs where none was counted.
    """
    linear, quadratic = np.array([item.thrust_curve(boat.water_density) for item in boat.thrusters]).T
    thrust = bollard_thrust(rollout.throttle, linear, quadratic)
    power = jet_power(thrust, boat.water_density, jet_areas(boat)).sum(axis=-1)
    episodes = range(len(rollout.seeds))
    table = {
        "seed": rollout.seeds,
        "success": rollout.outcome == "success",
        "outcome": rollout.outcome,
        "time": rollout.steps * step,
        "path_length": np.array([path_length(rollout.track(i)) for i in episodes]),
        "command_change": np.array([command_change(rollout.levers(i)) for i in episodes]),
        "energy": np.array([power[i, : rollout.steps[i]].sum() * step for i in episodes]),
        RETURN: rollout.returns,
    }
    return table if missing(boat) else table | electric(rollout, boat, step, table["path_length"])


def electric(rollout: Rollout, boat: Boat, step: float, path: NDArray[np.float64]) -> Table:
    """`ELECTRIC` of each episode, (n,), from the throttles that the pumps had and the paths [m] (n,).

    From the energy that was counted in the episodes, where it was.
    """
    sailed = np.arange(rollout.throttle.shape[1]) < rollout.steps[:, None]
    used = rollout.drawn
    if used is None:
        used = (pack_power(boat, rollout.throttle) * sailed[..., None]).sum(axis=1) * step
    start = 1.0 if rollout.charge is None else rollout.charge
    total = used.sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        per_metre = np.where(path > 0.0, total / path, np.nan)
    return {
        "electric_energy": total,
        "energy_per_metre": per_metre,
        "range": range_left(boat, used, path, start),
    }


def costs_of(*tables: Table) -> tuple[str, ...]:
    """The costs that all of these tables have."""
    return (*COSTS, *(name for name in ELECTRIC if all(name in table for table in tables)))


def summary(table: Table) -> dict[str, Any]:
    """Success and mean return with their intervals, outcomes, and mean costs of the successful episodes."""
    won = table["success"]
    rate = wilson(int(won.sum()), len(won))
    costs = {name: float(table[name][won].mean()) if won.any() else None for name in costs_of(table)}
    return {
        "episodes": rate.n,
        "successes": int(won.sum()),
        "success_rate": rate.value,
        "wilson_95": [rate.low, rate.high],
        "outcomes": dict(sorted(Counter(table["outcome"].tolist()).items())),
        "mean_of_successes": costs,
        **(_mean_return(table[RETURN]) if RETURN in table else {}),
    }


def _mean_return(returns: NDArray[np.float64]) -> dict[str, Any]:
    """The mean over all episodes with its 95 % interval by Student's t distribution."""
    from scipy.stats import t as student_t

    mean, n = float(returns.mean()), len(returns)
    half = float(student_t.ppf(ENDS[1], n - 1) * returns.std(ddof=1)) / n**0.5 if n > 1 else None
    return {"mean_return": mean, "return_95": None if half is None else [mean - half, mean + half]}


def differences(a: Table, b: Table, rng: np.random.Generator) -> dict[str, Interval]:
    """Paired differences a − b: of success over all episodes, of each cost over those where both succeeded.

    ValueError where the two tables are not of the same seeds.
    """
    if not np.array_equal(a["seed"], b["seed"]):
        raise ValueError("the two pilots were not evaluated on the same episodes")
    both = a["success"] & b["success"]
    result = {"success": success_difference(a["success"], b["success"])}
    for name in costs_of(a, b):
        result[name] = paired_difference(a[name][both], b[name][both], rng)
    return result


def write_episodes(path: Path, tables: Mapping[tuple[str, str], Table]) -> None:
    """Parquet file of all rows, with columns `pilot` and `level` taken from the keys of `tables`."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    parts = []
    for (pilot, level), table in tables.items():
        n = len(table["seed"])
        parts.append(pa.table({"pilot": [pilot] * n, "level": [level] * n, **table}))
    pq.write_table(pa.concat_tables(parts), path, write_page_checksum=True)


def read_episodes(path: Path) -> dict[tuple[str, str], Table]:
    """Episodes by pilot and level, as `write_episodes` wrote them; UserError for any other file, and for
    columns of another type, costs that cannot be, or an episode that is there twice."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        held = contents(path)
        schema = pq.read_schema(pa.BufferReader(held))
        texts = [one.name for one in schema if pa.types.is_string(one.type)]  # not one copy for each row
        source = pa.BufferReader(held)
        read = pq.read_table(source, page_checksum_verification=True, read_dictionary=texts)
        columns = {name: read[name].to_numpy() for name in read.column_names}
    except (OSError, UnicodeDecodeError, pa.ArrowException) as error:
        raise UserError(f"{path}: is not a readable Parquet file; run the experiment again") from error
    _refuse_odd_columns(path, read, ("pilot", "level", *COLUMNS))
    keys = list(zip(columns.pop("pilot").tolist(), columns.pop("level").tolist(), strict=True))
    rows: dict[tuple[str, str], list[int]] = {}
    for row, key in enumerate(keys):
        rows.setdefault(key, []).append(row)
    for name in {part for key in rows for part in key}:
        refuse_odd_label(path, name)
    for (pilot, level), at in rows.items():
        if len(np.unique(columns["seed"][at])) < len(at):
            message = f"the episodes of {pilot} at {level} have a seed twice"
            raise UserError(f"{path}: {message}; run the experiment again")
    return {key: {name: column[at] for name, column in columns.items()} for key, at in rows.items()}


def checked_table(path: Path, arrays: Table) -> Table:
    """A table of episodes from arrays that a file holds; UserError where they are none."""
    import pyarrow as pa

    try:
        _refuse_odd_columns(path, pa.table(arrays), COLUMNS)
    except pa.ArrowException as error:
        raise UserError(f"{path}: holds no table of episodes; run the experiment again") from error
    return arrays


def _refuse_odd_columns(path: Path, read: Any, needed: Sequence[str]) -> None:
    """UserError for a column that a pyarrow table does not have, or of another type or with odd values."""
    missing = [name for name in needed if name not in read.column_names]
    if missing:
        raise UserError(f"{path}: has no column {missing[0]}; it must be the episodes of an experiment")
    for name in (*TEXTS, "seed", "success", *COSTS, *ELECTRIC, RETURN):
        if name in read.column_names and (fault := _fault_of(name, read[name])):
            raise UserError(f"{path}: column {name}: {fault}; run the experiment again")


def _fault_of(name: str, column: Any) -> str | None:
    """What is wrong with a column of the file, a pyarrow array; None where nothing is."""
    import pyarrow as pa

    whole = {
        "seed": (pa.types.is_integer, "whole numbers"),
        "success": (pa.types.is_boolean, "true or false"),
    }
    texts = dict.fromkeys(TEXTS, (pa.types.is_string, "text"))
    fits, expected = {**whole, **texts}.get(name, (pa.types.is_floating, "floating-point numbers"))
    kind = column.type.value_type if pa.types.is_dictionary(column.type) else column.type
    if not fits(kind):
        return f"must hold {expected}, not {clipped(kind)}"
    if column.null_count:
        return "has an empty cell"
    costs = column.to_numpy() if name in COSTS else np.zeros(0)
    return None if (np.isfinite(costs) & (costs >= 0.0)).all() else "must be finite, and none below 0"

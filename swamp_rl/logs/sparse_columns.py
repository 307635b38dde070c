"""Columns of one table that come at a lower rate than its rows, with empty cells between their values."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from swamp_rl.counted import and_others

Array = NDArray[np.float64]


def is_sparse(values: Array) -> bool:
    """Whether a column (T,) has a value in every second row or less often, as a receiver of 5 Hz in a log of
    20 Hz; by the median step, so that a column with long gaps is not."""
    known = np.flatnonzero(np.isfinite(values))
    return len(known) > 1 and float(np.median(np.diff(known))) >= 2.0


def messages_of(table: str, columns: Mapping[str, Array]) -> dict[str, str]:
    """Names for the columns (T,) of a table whose values come together, by column, if any is sparse; else
    none."""
    if not any(map(is_sparse, columns.values())):
        return {}
    together: dict[bytes, list[str]] = {}
    for name, values in columns.items():
        together.setdefault(np.isfinite(values).tobytes(), []).append(name)
    return {name: f"{table} ({and_others(names)})" for names in together.values() for name in names}

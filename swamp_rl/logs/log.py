"""What a log holds: tables of messages, each with its own times."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from swamp_rl.runs.table import Table

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LogTable:
    """Messages of one topic. `time` (T,) s on the log's own clock, None where it is a column that the mapping
    names; `kind`: what the format calls such a message; `origin`: its name in the log; `clocks`: columns of
    times."""

    name: str
    table: Table
    time: Array | None = None
    kind: str = ""
    origin: str = ""
    clocks: Collection[str] = ()

    @property
    def rate(self) -> float | None:
        """Messages a second, by the median step; None without times."""
        if self.time is None or len(self.time) < 2:
            return None
        step = float(np.median(np.diff(self.time)))
        return 1.0 / step if step > 0.0 else None


@dataclass(frozen=True)
class Log:
    """A file as its reader finds it. `metadata`: entries for the run's description; `home`: the
    dataset of this project that the file is a run of."""

    file: str
    name: str
    tables: Mapping[str, LogTable]
    metadata: Mapping[str, str] = field(default_factory=dict)
    home: Path | None = None


def words_of(table: LogTable, column: str) -> pa.ChunkedArray | None:
    """The cells of a column without a number, None for a column of numbers."""
    return table.table.words.get(column)

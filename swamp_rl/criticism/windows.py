"""Pieces of runs that are compared with rollouts."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Windows:
    """W windows: run, first sample simulated, steps from there; measured and weight (W, rows, 6)."""

    run: NDArray[np.int64]
    first: NDArray[np.int64]
    steps: NDArray[np.int64]
    measured: Array
    weight: Array
    pad: int
    rows: int

    @property
    def count(self) -> int:
        """W."""
        return len(self.run)

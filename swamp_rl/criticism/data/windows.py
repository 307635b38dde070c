"""Windows of runs that are compared with simulations."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Windows:
    """W windows. run, first, steps: (W,) run, first simulated sample and number of steps; measured, weight:
    (W, rows, 6); pad: rows before the first compared one; rows: of the longest window.
    """

    run: NDArray[np.int64]
    first: NDArray[np.int64]
    steps: NDArray[np.int64]
    measured: Array
    weight: Array
    pad: int
    rows: int

    def part(self, chosen: NDArray[np.bool_] | NDArray[np.int64]) -> "Windows":
        """Some of the windows, by flags (W,) or by numbers (n,)."""
        arrays = {
            name: getattr(self, name)[chosen] for name in ("run", "first", "steps", "measured", "weight")
        }
        return replace(self, **arrays)

    def by_channel(self, residual: Array) -> Array:
        """(W, T, 6) of residuals (W, M), without the rows that are only simulated."""
        return residual.reshape(len(residual), -1, self.weight.shape[2])[:, self.pad :]

    @property
    def count(self) -> int:
        """W."""
        return len(self.run)

    @cached_property
    def samples(self) -> int:
        """Number of samples that are compared."""
        return int((self.weight[:, self.pad :] > 0).sum())

"""Windows of runs that are compared with simulations."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.options import options
from swamp_rl.errors import UserError
from swamp_rl.simulator.substeps import steps_over

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


def cut(run_set: RunSet, weight: Array, seconds: float, before: float | None = None) -> Windows:
    """Windows of about `seconds` without overlap, inf: one window a run; simulated from `before` [s]
    earlier.

    A run is cut in a power of two, so that longer windows start where shorter ones do, and at every gap
    until the actuators are known again.
    """
    pad = steps_over(options().pad if before is None else before, run_set.dt)
    shortest = steps_over(options().shortest_window, run_set.dt)
    rows: list[tuple[int, int, int]] = []
    for run, length in enumerate(run_set.lengths):
        transient = max(pad, int(run_set.first_compared[run]))
        available = int(length) - transient
        ratio = available * run_set.dt / seconds if math.isfinite(seconds) else 1.0
        pieces = 2 ** max(0, round(math.log2(ratio)))
        edges = np.linspace(transient, length, pieces + 1).round().astype(int)
        again = zip(run_set.gaps, run_set.compared_again, strict=True)
        lost = [(gap.row, known) for gap, known in again if gap.run == run]
        for a, b in pairwise(edges):
            inside = [(g, h) for g, h in lost if g < b and h > a]
            starts = [a, *(h for _, h in inside)]
            ends = [*(g for g, _ in inside), b]
            rows += [
                (run, s - pad, e - 1 - (s - pad))
                for s, e in zip(starts, ends, strict=True)
                if e - s >= min(shortest, b - a)
            ]
    if not rows:
        raise UserError(
            f"runs {', '.join(run_set.names)}: commands change over lost rows so often that no "
            f"{options().shortest_window:g} s between them can be compared; record every row"
        )
    run_of, first, steps = (np.array(column) for column in zip(*rows, strict=True))
    measured, weights = window_data(run_set, weight, run_of, first, steps, pad)
    return Windows(run_of, first, steps, measured, weights, pad, int(steps.max()) + 1)


def window_data(
    run_set: RunSet,
    weight: Array,
    run: NDArray[np.int64],
    first: NDArray[np.int64],
    steps: NDArray[np.int64],
    pad: int,
) -> tuple[Array, Array]:
    """Measured and weight (W, rows, 6) of windows; the first `pad` rows are only simulated."""
    measured = np.zeros((len(run), int(steps.max()) + 1, 6))
    weights = np.zeros_like(measured)
    for w, (its_run, start, count) in enumerate(zip(run, first, steps, strict=True)):
        part = slice(start + pad, start + count + 1)
        measured[w, pad : count + 1] = run_set.measured[its_run, part]
        weights[w, pad : count + 1] = weight[its_run, part]
    return np.nan_to_num(measured), weights

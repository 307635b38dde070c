"""What the rows of a regression cannot show of a parameter: conditioning, excitation, Fisher information."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swamp_rl.identification.estimate import Estimate

Array = NDArray[np.float64]

WITHIN = 0.5  # share of a value that its 95 % interval may reach to either side
OWN = 1e-10  # share of a regressor's square that the other regressors must leave
ROUGH = 0.5  # roughness [1] from which a regressor is taken for noise; white noise has 1


def doubt(estimate: Estimate) -> str | None:
    """Why the 95 % interval does not determine a value; None where it does."""
    value, low, high, _ = estimate
    if max(value - low, high - value) <= WITHIN * abs(value):
        return None
    return f"95 % interval {low:.3g} to {high:.3g}, beyond {value:.3g} ± {100 * WITHIN:.0f} %"


def doubts(
    X: Array, estimates: Sequence[Estimate], lengths: Sequence[int], names: Sequence[str]
) -> list[str | None]:
    """Why the rows X (N, p) do not determine each estimate (p,); None where they do.

    In order: its regressor depends on the others (conditioning); what it has of its own is white noise
    (excitation); its interval is wide (Fisher information, by resampled blocks). lengths: rows of each run.
    """
    return [
        _conditioning(X, j, names) or _excitation(X, j, lengths) or doubt(estimates[j])
        for j in range(X.shape[1])
    ]


def own_part(X: Array, j: int) -> tuple[Array, Array]:
    """What the other columns leave of column j (N,), and their weights (p - 1,)."""
    others = np.delete(X, j, axis=1)
    weights = np.asarray(np.linalg.lstsq(others, X[:, j], rcond=None)[0], dtype=np.float64)
    return X[:, j] - others @ weights, weights


def roughness(values: Array, lengths: Sequence[int]) -> float:
    """Mean square of second differences within runs over six times that of the values: 1 for white noise."""
    cuts = pairwise(np.cumsum((0, *lengths)))
    bends = np.concatenate([np.diff(values[a:b], 2) for a, b in cuts if b - a > 2] or [np.zeros(0)])
    square = float(np.mean(values**2))
    return float(np.mean(bends**2)) / (6.0 * square) if len(bends) and square > 0.0 else 1.0


def _conditioning(X: Array, j: int, names: Sequence[str]) -> str | None:
    size = float(np.sum(X[:, j] ** 2))
    if size == 0.0:
        return "its regressor is zero throughout"
    own, weights = own_part(X, j)
    if float(np.sum(own**2)) > OWN * size:
        return None
    others = [name for k, name in enumerate(names) if k != j]
    share = np.abs(weights) * np.sqrt(np.mean(np.delete(X, j, axis=1) ** 2, axis=0))
    return f"its regressor varies with that of {others[int(np.argmax(share))]} alone"


def _excitation(X: Array, j: int, lengths: Sequence[int]) -> str | None:
    if roughness(own_part(X, j)[0], lengths) < ROUGH:
        return None
    return "its regressor, less what the others explain, is noise"

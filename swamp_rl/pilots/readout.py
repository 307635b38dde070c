"""The linear readout of a reservoir: ridge regression from moments of its states, in batch or recursive."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from swamp_rl.errors import SettingsError
from swamp_rl.pilots.arrays import Array


@dataclass(frozen=True)
class Moments:
    """Sums over rows of states x (u,) and levers y (2,): sufficient for any ridge and any held-out error."""

    gram: Array
    "(u + 1, u + 1) sum of z zᵀ, where z is x and a 1"
    cross: Array
    "(u + 1, 2) sum of z yᵀ"
    square: Array
    "(2,) sum of y²"

    @classmethod
    def of(cls, states: Sequence[Array], levers: Sequence[Array]) -> Self:
        """The moments of runs' states (T, u) and levers (T, 2); zero where there are no rows."""
        x, y = np.concatenate(states), np.concatenate(levers)
        z = np.column_stack([x, np.ones(len(x))])
        return cls(z.T @ z, z.T @ y, np.square(y).sum(axis=0))

    def __add__(self, other: "Moments") -> "Moments":
        return Moments(self.gram + other.gram, self.cross + other.cross, self.square + other.square)

    def __sub__(self, other: "Moments") -> "Moments":
        return Moments(self.gram - other.gram, self.cross - other.cross, self.square - other.square)


def ridge_readouts(moments: Moments, ridges: Iterable[float]) -> list[Array]:
    """Return for each ridge λ the readout (u + 1, 2), its last row the constant.

    It minimises the sum of squared errors plus λ times the sum of squared weights without the constant
    (Hoerl and Kennard 1970). One eigendecomposition of the Gram matrix serves all ridges.
    """
    mean_x, mean_y, gram, cross = _about_means(moments)
    values, vectors = np.linalg.eigh(gram)
    rotated = vectors.T @ cross
    found = []
    for ridge in ridges:
        weights = vectors @ (rotated / (np.maximum(values, 0.0) + ridge)[:, None])
        found.append(np.vstack([weights, mean_y - mean_x @ weights]))
    return found


def ridge_readout(moments: Moments, ridge: float) -> Array:
    """Return the readout (u + 1, 2) of one ridge, by Cholesky: faster than `ridge_readouts` for one ridge.

    SettingsError where the ridge is so small that the equations are singular.
    """
    from scipy.linalg import LinAlgError, solve

    mean_x, mean_y, gram, cross = _about_means(moments)
    gram[np.diag_indices_from(gram)] += ridge
    try:
        weights = solve(gram, cross, assume_a="pos")
    except LinAlgError as error:
        raise SettingsError(f"ridge: {ridge:g} leaves the regression singular; raise ridge") from error
    return np.vstack([weights, mean_y - mean_x @ weights])


def _about_means(moments: Moments) -> tuple[Array, Array, Array, Array]:
    """Return the means of states (u,) and levers (2,), then the Gram and cross matrices about them."""
    rows = moments.gram[-1, -1]
    mean_x, mean_y = moments.gram[-1, :-1] / rows, moments.cross[-1] / rows
    gram = moments.gram[:-1, :-1] - rows * np.outer(mean_x, mean_x)
    return mean_x, mean_y, gram, moments.cross[:-1] - rows * np.outer(mean_x, mean_y)


def variance_matched(readout: Array, moments: Moments) -> Array:
    """Scale each lever of the readout (u + 1, 2) so that its mean square equals that of the demonstrations.

    Least squares predicts the conditional mean of the levers, whose variance is smaller than theirs by the
    squared correlation. The scaled readout is the reduced major axis (Kermack and Haldane 1950) about zero,
    the steering's neutral position, so that port and starboard are scaled alike.
    """
    mean_square = np.sum(readout * (moments.gram @ readout), axis=0)
    return readout * np.sqrt(moments.square / np.where(mean_square > 0.0, mean_square, 1.0))


def squared_error(readout: Array, moments: Moments) -> float:
    """Mean squared error of both levers over the rows of `moments`, before clipping to their range."""
    explained = 2.0 * np.sum(readout * moments.cross) - np.sum(readout * (moments.gram @ readout))
    return float((moments.square.sum() - explained) / (2.0 * moments.gram[-1, -1]))


class RecursiveReadout:
    """Recursive least squares with exponential forgetting.

    Sources: Plackett (1950); with forgetting, Ljung, System Identification (1999), 11.2. Rows are centred
    on their running mean, so that the ridge does not penalise the constant; with forgetting = 1 the result is
    that of `ridge_readout`.
    """

    def __init__(self, units: int, ridge: float, forgetting: float = 1.0) -> None:
        """ridge > 0; forgetting in (0, 1]: factor on the weight of earlier rows for each new row."""
        self.forgetting = forgetting
        self._weights = np.zeros((units, 2))
        self._spread = np.eye(units) / ridge
        self._mean_state, self._mean_levers, self._rows = np.zeros(units), np.zeros(2), 0.0

    def learn(self, state: Array, levers: Array) -> None:
        """Update from one row: state (u,), levers (2,)."""
        discounted = self.forgetting * self._rows
        share, self._rows = discounted / (discounted + 1.0), discounted + 1.0
        x, y = state - self._mean_state, levers - self._mean_levers
        filtered = self._spread @ x
        gain = share * filtered / (self.forgetting + share * (x @ filtered))
        self._weights += np.outer(gain, y - x @ self._weights)
        self._spread -= np.outer(gain, filtered)
        self._spread /= self.forgetting
        self._mean_state += x / self._rows
        self._mean_levers += y / self._rows

    @property
    def readout(self) -> Array:
        """(u + 1, 2), its last row the constant."""
        return np.vstack([self._weights, self._mean_levers - self._mean_state @ self._weights])

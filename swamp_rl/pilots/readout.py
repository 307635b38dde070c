"""The linear readout of a reservoir: ridge regression from sums over its states, at once or row by row."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from swamp_rl.pilots.arrays import Array


@dataclass(frozen=True)
class Moments:
    """Sums over rows of states x (u,) and levers y (2,): all that any ridge, or a held-out error, needs."""

    gram: Array
    "(u + 1, u + 1) sum of z zᵀ, where z is x and a 1"
    cross: Array
    "(u + 1, 2) sum of z yᵀ"
    square: Array
    "(2,) sum of y²"

    @classmethod
    def of(cls, states: Sequence[Array], levers: Sequence[Array]) -> Self:
        """Of runs' states (T, u) and levers (T, 2); nought where there are no rows."""
        x, y = np.concatenate(states), np.concatenate(levers)
        z = np.column_stack([x, np.ones(len(x))])
        return cls(z.T @ z, z.T @ y, np.square(y).sum(axis=0))

    def __add__(self, other: "Moments") -> "Moments":
        return Moments(self.gram + other.gram, self.cross + other.cross, self.square + other.square)

    def __sub__(self, other: "Moments") -> "Moments":
        return Moments(self.gram - other.gram, self.cross - other.cross, self.square - other.square)


def ridge_readouts(moments: Moments, ridges: Iterable[float]) -> list[Array]:
    """For each ridge λ the readout (u + 1, 2), its last row the constant, that makes the sum of squared
    errors and λ times the squared weights, the constant's apart, least (Hoerl and Kennard 1970).

    One decomposition of the Gram matrix serves all ridges.
    """
    gram, cross = moments.gram, moments.cross
    rows = gram[-1, -1]
    mean_x, mean_y = gram[-1, :-1] / rows, cross[-1] / rows
    about_means = gram[:-1, :-1] - rows * np.outer(mean_x, mean_x)
    values, vectors = np.linalg.eigh(about_means)
    turned = vectors.T @ (cross[:-1] - rows * np.outer(mean_x, mean_y))
    found = []
    for ridge in ridges:
        weights = vectors @ (turned / (np.maximum(values, 0.0) + ridge)[:, None])
        found.append(np.vstack([weights, mean_y - mean_x @ weights]))
    return found


def ridge_readout(moments: Moments, ridge: float) -> Array:
    """The readout (u + 1, 2) of one ridge: as `ridge_readouts`, several times as fast."""
    from scipy.linalg import solve

    gram, cross = moments.gram, moments.cross
    rows = gram[-1, -1]
    mean_x, mean_y = gram[-1, :-1] / rows, cross[-1] / rows
    about_means = gram[:-1, :-1] - rows * np.outer(mean_x, mean_x)
    about_means[np.diag_indices_from(about_means)] += ridge
    weights = solve(about_means, cross[:-1] - rows * np.outer(mean_x, mean_y), assume_a="pos")
    return np.vstack([weights, mean_y - mean_x @ weights])


def as_far_as_taught(readout: Array, moments: Moments) -> Array:
    """The readout (u + 1, 2), each lever scaled so that its mean square over the rows of `moments` is that of
    the levers learned from.

    Least squares foretells the mean of what was done in a place, which swings less than what was done, by the
    correlation of the two. Scaled back it is the reduced major axis (Kermack and Haldane 1950), here about
    nought, where the steering rests: to port and to starboard gain alike.
    """
    foretold = np.sum(readout * (moments.gram @ readout), axis=0)
    return readout * np.sqrt(moments.square / np.where(foretold > 0.0, foretold, 1.0))


def squared_error(readout: Array, moments: Moments) -> float:
    """Mean squared error of both levers over the rows of `moments`, the levers not held to their ways."""
    explained = 2.0 * np.sum(readout * moments.cross) - np.sum(readout * (moments.gram @ readout))
    return float((moments.square.sum() - explained) / (2.0 * moments.gram[-1, -1]))


class RecursiveReadout:
    """Recursive least squares: learns from each row as it comes and forgets the earlier ones exponentially.

    Sources: Plackett (1950); with forgetting, Ljung, System Identification (1999), 11.2. Rows are taken about
    their running mean, so that the ridge does not weigh on the constant; without forgetting it ends where
    `ridge_readout` does.
    """

    def __init__(self, units: int, ridge: float, forgetting: float = 1.0) -> None:
        """ridge > 0; forgetting in (0, 1]: the weight of what was learned, once a row later."""
        self.forgetting = forgetting
        self._weights = np.zeros((units, 2))
        self._spread = np.eye(units) / ridge
        self._mean_state, self._mean_levers, self._rows = np.zeros(units), np.zeros(2), 0.0

    def learn(self, state: Array, levers: Array) -> None:
        """From one row: state (u,), levers (2,) that it was to lead to."""
        faded = self.forgetting * self._rows
        share, self._rows = faded / (faded + 1.0), faded + 1.0
        x, y = state - self._mean_state, levers - self._mean_levers
        heard = self._spread @ x
        gain = share * heard / (self.forgetting + share * (x @ heard))
        self._weights += np.outer(gain, y - x @ self._weights)
        self._spread -= np.outer(gain, heard)
        self._spread /= self.forgetting
        self._mean_state += x / self._rows
        self._mean_levers += y / self._rows

    @property
    def readout(self) -> Array:
        """(u + 1, 2), its last row the constant."""
        return np.vstack([self._weights, self._mean_levers - self._mean_state @ self._weights])

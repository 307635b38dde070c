"""Numbers of a level that are drawn together: normal ones, each cut off as it says, with correlations."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np

from swamp_rl.clipped import clipped
from swamp_rl.effects.distributions import Array, each
from swamp_rl.effects.entries import is_number
from swamp_rl.effects.random_entry import RandomEntry
from swamp_rl.errors import UserError

KEYS = {"numbers", "matrix"}
LEAST, MOST = math.nextafter(0.0, 1.0), math.nextafter(1.0, 0.0)
ROUNDING = 1e-6
"By which the matrix may miss being one of correlations."


@dataclass(frozen=True)
class Correlated:
    """columns: of the level's uniforms that the numbers are drawn from; factor: (m, m), its product with its
    transpose the matrix of correlations.
    """

    columns: tuple[int, ...]
    factor: Array

    def joined(self, uniforms: Array) -> Array:
        """Uniforms (n, draws) that go together by a Gaussian copula: each by itself is still uniform, so each
        number has the distribution that it says; all are joint normal where nothing is cut off.
        """
        bell = NormalDist()
        shares = np.clip(uniforms[:, self.columns], LEAST, MOST)
        apart = [each(bell.inv_cdf, column) for column in shares.T]
        together = uniforms.copy()
        for column, row in zip(self.columns, self.factor, strict=True):
            # a sum in one order, whatever the batch: see `each`
            total = np.zeros(len(uniforms))
            for weight, value in zip(row.tolist(), apart, strict=True):
                total += weight * value
            together[:, column] = np.clip(each(bell.cdf, total), 0.0, MOST)
        return together


def parse_correlated(
    given: Any, entries: Sequence[RandomEntry], first_columns: Sequence[int], where: str
) -> Correlated | None:
    """The key `correlated` of a level; `first_columns`: where each entry's uniforms begin. UserError."""
    if given is None:
        return None
    where = f"{where}: correlated"
    if not isinstance(given, Mapping) or set(given) != KEYS:
        raise UserError(f"{where}: must be {{numbers: [0.north, 0.east], matrix: [[1, 0.5], [0.5, 1]]}}")
    numbers = given["numbers"]
    if not isinstance(numbers, list) or len({str(name) for name in numbers}) < max(len(numbers), 2):
        raise UserError(f"{where}: numbers must be a list of two or more, each once")
    known = {
        f"{index}.{name}": first + entry.column(name)
        for index, (entry, first) in enumerate(zip(entries, first_columns, strict=False))
        for name, value in entry.values.items()
        if value.kind == "normal"
    }
    for name in map(str, numbers):
        if name not in known:
            raise UserError(
                f"{where}: {clipped(name)!r} is not a parameter with a normal distribution; name it as "
                "0.north: the place of its effect in effects and its own name"
            )
    columns = tuple(known[str(name)] for name in numbers)
    return Correlated(columns, factor_of(given["matrix"], len(numbers), where))


def factor_of(given: Any, size: int, where: str) -> Array:
    """The factor of a matrix of correlations, (size, size), given as rows; UserError where it is none."""
    rows = given if isinstance(given, list) else []
    whole = len(rows) == size and all(isinstance(row, list) and len(row) == size for row in rows)
    if not whole or not all(is_number(value) for row in rows for value in row):
        raise UserError(f"{where}: matrix must be {size} rows of {size} numbers, one for each of numbers")
    matrix = np.array(rows, dtype=float)
    values, vectors = np.linalg.eigh(matrix)
    even = np.allclose(matrix, matrix.T, rtol=0.0, atol=ROUNDING)
    if not even or not np.allclose(np.diag(matrix), 1.0, atol=ROUNDING) or values[0] < -ROUNDING * size:
        raise UserError(
            f"{where}: matrix is none of correlations: symmetric, 1 along its diagonal, not negative"
        )
    factor = vectors * np.sqrt(np.maximum(values, 0.0))
    return np.asarray(factor / np.linalg.norm(factor, axis=1, keepdims=True))

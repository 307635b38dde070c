"""Arithmetic common to the pilots: array type, range of the levers, matrix product, wrapped angles."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

LOWEST, HIGHEST = np.array([0.0, -1.0]), np.array([1.0, 1.0])
"Range of the levers: throttle, angle [1]."


ROWS = 8
"Batches are padded with zeros to a multiple of this many rows before a matrix product."


def times(rows: Array, matrix: Array) -> Array:
    """Multiply rows (n, d) by a matrix (d, m); the bits of a row do not depend on the other rows.

    BLAS sums the last rows of a batch that is no multiple of its block size in another order, so the batch is
    padded with zeros. In single precision the order also depends on the position in a large batch, so it gets
    ROWS rows at a time. Measured with NumPy's OpenBLAS on x86_64 (`tests/evaluation/test_episodes_apart.py`);
    with a BLAS of other block sizes the levers agree to rounding.
    """
    n, (d, m) = len(rows), matrix.shape
    whole = np.ascontiguousarray(rows)
    if n % ROWS:
        whole = np.zeros((n + -n % ROWS, d), rows.dtype)
        whole[:n] = rows
    if matrix.dtype == np.float32:
        return (whole.reshape(-1, ROWS, d) @ matrix).reshape(len(whole), m)[:n]
    return (whole @ matrix)[:n]


def owned(owner: str, arrays: Mapping[str, Array]) -> dict[str, Array]:
    """Return the arrays whose names begin with `owner` and a dot, by the rest of their names."""
    start = f"{owner}."
    return {name.removeprefix(start): value for name, value in arrays.items() if name.startswith(start)}


def levers_of(actions: Array) -> Array:
    """Map actions in [-1, 1] to levers (..., 2) over their whole range; actions beyond are clipped."""
    middle, reach = 0.5 * (HIGHEST + LOWEST), 0.5 * (HIGHEST - LOWEST)
    return middle + reach * np.clip(actions, -1.0, 1.0)

"""What the pilots' arithmetic shares: the array type, the ends of the levers' ways, the wrap of an angle."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

LOWEST, HIGHEST = np.array([0.0, -1.0]), np.array([1.0, 1.0])
"Ends of the levers' ways: throttle, angle [1]."


ROWS = 8
"Batches are filled up to a multiple of so many rows before a matrix multiplies them."


def times(rows: Array, matrix: Array) -> Array:
    """rows (n, d) by matrix (d, m), a row's result being the same bits whatever the others and their number.

    BLAS sums the rows at the ragged end of a batch in another order, so there is none: the last rows are
    filled up with nought. In single precision its order depends on the place in a large batch as well, so it
    gets few rows at a time. Measured with NumPy's OpenBLAS on x86_64
    (`tests/evaluation/test_episodes_apart.py`); where another BLAS sums otherwise, levers agree to rounding.
    """
    n, (d, m) = len(rows), matrix.shape
    whole = np.ascontiguousarray(rows)
    if n % ROWS:
        whole = np.zeros((n + -n % ROWS, d), rows.dtype)
        whole[:n] = rows
    if matrix.dtype == np.float32:
        return (whole.reshape(-1, ROWS, d) @ matrix).reshape(len(whole), m)[:n]
    return (whole @ matrix)[:n]


def wrap(angle: Array) -> Array:
    """The angle [rad], any shape, brought into [-pi, pi)."""
    return np.mod(angle + np.pi, 2.0 * np.pi) - np.pi


def levers_of(actions: Array) -> Array:
    """Levers (..., 2) from actions in [-1, 1], which reach over the whole way of each; what is beyond stops
    at the end."""
    middle, reach = 0.5 * (HIGHEST + LOWEST), 0.5 * (HIGHEST - LOWEST)
    return middle + reach * np.clip(actions, -1.0, 1.0)

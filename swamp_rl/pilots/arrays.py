"""Arithmetic common to the pilots: array type, range of the levers, matrix product, wrapped angles."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.counted import counted
from swamp_rl.errors import UserError
from swamp_rl.whole_number import whole_number

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


def checked(observation: Any, senses: Sequence[str], boats: int | None = None) -> Array:
    """The observation as an array (n, d), d that of `senses`.

    boats: n since the last reset, None where the pilot resets itself for another n. UserError for another
    shape, and for a value that is not a finite number.
    """
    try:
        seen = np.asarray(observation)
        sound = bool(np.isfinite(seen).all())
    except (TypeError, ValueError) as error:
        raise UserError(f"pilot.act: the observation is not an array of numbers ({error})") from error
    if seen.ndim != 2 or seen.shape[1] != len(senses):
        raise UserError(
            f"pilot.act: the observation is {seen.shape}, (n, {len(senses)}) is needed: {', '.join(senses)}"
        )
    if boats is not None and len(seen) != boats:
        raise UserError(
            f"pilot.act: the observation is of {counted(len(seen), 'boat')}, the pilot was reset for "
            f"{boats or 'none'}; call reset({len(seen)}) first"
        )
    if not sound:
        row, place = np.argwhere(~np.isfinite(seen))[0]
        raise UserError(f"pilot.act: boat {row}: {senses[place]} is not a finite number")
    return seen


def checked_count(n: Any) -> int:
    """The number of boats that a pilot is reset for; UserError unless it is a whole number of at least 0."""
    return whole_number("pilot.reset: n", n, 0)


def owned(owner: str, arrays: Mapping[str, Array]) -> dict[str, Array]:
    """Return the arrays whose names begin with `owner` and a dot, by the rest of their names."""
    start = f"{owner}."
    return {name.removeprefix(start): value for name, value in arrays.items() if name.startswith(start)}


def levers_of(actions: Array) -> Array:
    """Map actions in [-1, 1] to levers (..., 2) over their whole range; actions beyond are clipped."""
    middle, reach = 0.5 * (HIGHEST + LOWEST), 0.5 * (HIGHEST - LOWEST)
    return middle + reach * np.clip(actions, -1.0, 1.0)

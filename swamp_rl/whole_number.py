"""Whole numbers that a function of the Python interface is given: seeds, numbers of boats and of steps."""

from typing import Any

import numpy as np

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError


def whole_number(name: str, value: Any, least: int, most: int | None = None) -> int:
    """`value` as an int; UserError, which calls it `name`, if it is no whole number within the limits."""
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if whole and value >= least and (most is None or value <= most):
        return int(value)
    limits = f"of at least {least}" if most is None else f"from {least} to {most}"
    raise UserError(f"{name} must be a whole number {limits}, not {clipped(repr(value))}")


def known_seed(where: str, seed: Any) -> int | None:
    """`seed` if it is None or a whole number of at least 0; UserError, which names `where`, otherwise."""
    return None if seed is None else whole_number(f"{where}: seed", seed, 0)

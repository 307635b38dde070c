"""Trainings that diverge: a loss or a weight is no longer a finite number."""

from collections.abc import Iterable

import numpy as np

from swamp_rl.errors import SettingsError
from swamp_rl.pilots.arrays import Array


def refuse_diverged(numbers: Iterable[Array | float], remedy: str) -> None:
    """Raise SettingsError with the `remedy` unless all `numbers` are finite."""
    if not all(np.isfinite(values).all() for values in numbers):
        raise SettingsError(f"the training diverged; {remedy}")

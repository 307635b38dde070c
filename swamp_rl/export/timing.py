"""How long one step of a pilot takes for one boat, with whatever threads its libraries were given."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np

TURNS = 9
"""The figure is the median of so many turns."""
STEPS = 300


def step_microseconds(step: Callable[[Any], Any], inputs: int, rng: np.random.Generator) -> float:
    """Median time [µs] of `step`, which is given an observation (1, inputs)."""
    observations = rng.normal(size=(STEPS, 1, inputs))
    step(observations[0])
    turns = []
    for _ in range(TURNS):
        begin = time.perf_counter()
        for observation in observations:
            step(observation)
        turns.append((time.perf_counter() - begin) / STEPS)
    return 1e6 * float(np.median(turns))

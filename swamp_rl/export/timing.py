"""How long one step of a pilot keeps a processor busy for one boat."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np

TURNS = 9
"""The figure is the median of so many turns."""
STEPS = 300


def step_microseconds(step: Callable[[Any], Any], inputs: int, rng: np.random.Generator) -> float:
    """Median processor time [µs] of `step`, which is given an observation (1, inputs).

    Processor time and not the clock's, which other work on the machine would lengthen.
    """
    observations = rng.normal(size=(STEPS, 1, inputs))
    step(observations[0])
    turns = []
    for _ in range(TURNS):
        begin = time.process_time()
        for observation in observations:
            step(observation)
        turns.append((time.process_time() - begin) / STEPS)
    return 1e6 * float(np.median(turns))

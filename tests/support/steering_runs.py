"""Runs steered by a known rule, from which pilots learn within a second."""

import numpy as np

from swamp_rl.pilots import Pilot
from swamp_rl.pilots.demonstrations import observed
from swamp_rl.pilots.reservoir import ReservoirSettings
from swamp_rl.runs import Run, RunMeta

SMALL = ReservoirSettings(units=40)


def wandering(seed: int, rows: int = 200, lag: int = 3) -> Run:
    """A run whose angle lever is half the sine of its heading `lag` rows before."""
    rng = np.random.default_rng(seed)
    swing, rate, phase = rng.uniform([0.5, 0.2, 0.0], [1.5, 0.6, 6.0])
    times = 0.1 * np.arange(rows)
    heading, late = (swing * np.sin(rate * t + phase) for t in (times, np.maximum(times - 0.1 * lag, 0.0)))
    columns = {
        "time": times,
        "north": 0.1 * np.cumsum(np.cos(heading)),
        "east": 0.1 * np.cumsum(np.sin(heading)),
        "heading": heading,
        "joy_thrust": np.full(rows, 0.8),
        "joy_angle": 0.5 * np.sin(late),
    }
    return Run(f"run-{seed}", columns, RunMeta(outcome="success"))


def steered(pilot: Pilot, run: Run) -> np.ndarray:
    """(T, 2) levers of the pilot along a run that it does not steer."""
    pilot.reset(1)
    return np.array([pilot.act(row[None])[0] for row in observed(run, pilot.senses)])


RUNS = [wandering(seed) for seed in range(8)]

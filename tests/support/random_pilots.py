"""Pilots of every kind with random weights."""

from itertools import pairwise

import numpy as np

from swamp_rl.pilots.gru import GRUPilot
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.reservoir import ReservoirPilot

SENSES = ("north", "east", "cos_heading", "sin_heading")


def network(rng: np.random.Generator, hold: int = 1, memory: int = 0, hidden: int = 16) -> NetworkPilot:
    seen = len(SENSES) + memory * (len(SENSES) + 2)
    widths = (seen, hidden, hidden, 2)
    weights = {"mean": rng.normal(size=seen), "scale": rng.uniform(0.1, 3.0, seen)}
    for i, (before, after) in enumerate(pairwise(widths)):
        weights |= {f"weight_{i}": rng.normal(size=(before, after)), f"bias_{i}": rng.normal(size=after)}
    return NetworkPilot("ppo" if hold > 1 else "cloning", SENSES, weights, hold, memory)


def reservoir(rng: np.random.Generator, units: int = 60) -> ReservoirPilot:
    shapes = {"W": (units, units), "Win": (units, 4), "bias": (units,), "Wout": (units, 2), "out": (2,)}
    weights = {name: rng.normal(size=shape) / np.sqrt(units) for name, shape in shapes.items()}
    weights |= {"centre": rng.normal(size=4), "scale": rng.uniform(0.1, 3.0, 4)}
    return ReservoirPilot(SENSES, {**weights, "leak": rng.uniform(0.05, 1.0, units)})


def gru(rng: np.random.Generator, units: int = 12) -> GRUPilot:
    shapes = {"input": (4, 3 * units), "recurrent": (units, 3 * units), "Wout": (units, 2), "out": (2,)}
    shapes |= {"input_bias": (3 * units,), "recurrent_bias": (3 * units,), "mean": (4,)}
    weights = {name: rng.normal(size=shape) / 2.0 for name, shape in shapes.items()}
    return GRUPilot(SENSES, {**weights, "scale": rng.uniform(0.1, 3.0, 4)})

"""What the identification benchmarks share: rate, noise, seeds, and how a bias is written."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import parse_effects

Array = NDArray[np.float64]

DT = 0.1  # s
SEEDS = 6
SMOOTH = 1.0  # s
NOISE = np.array([0.3, 0.3, 0.02, 0.03, 0.03, 0.01])  # m, m, rad, m/s, m/s, rad/s
LEVELS = {"none": 0.0, "a third": 1 / 3, "full": 1.0}


def with_effects(*given: dict[str, object]) -> Boat:
    """SWAMP with these effects."""
    boat = load_boat("swamp-thesis")
    entries = parse_effects(list(given), "benchmark", boat.thruster_names)
    return boat.model_copy(update={"effects": tuple(entries)})


def spread(values: Sequence[float], truth: float) -> str:
    """Mean with its standard deviation over the seeds, and the bias in percent."""
    mean, deviation = float(np.mean(values)), float(np.std(values))
    return f"{mean:.3g} ± {deviation:.2g} ({100 * (mean / truth - 1):+.0f} %)"

"""Tune the line-of-sight pilot on episodes of their own, and measure it beside the untuned one on others.

    python -m benchmarks.learners.line_of_sight

A grid over the options is tried at `severe` in EPISODES episodes from FIRST on; the most successful is kept
(of equals the first). It and the untuned one are then measured in 1000 episodes from MEASURED on, which
chose nothing.
"""

from itertools import product

import numpy as np
from swamp_rl.envs.batched import GatesVectorEnv

from swamp_rl.evaluation import drive
from swamp_rl.pilots.line_of_sight import LineOfSightPilot, LineOfSightSettings

FIRST, MEASURED, EPISODES = 1_000_000, 2_000_000, 300
UNTUNED = LineOfSightSettings(gain=2.0, damping=1.0, lead=0.0, beyond=0.0)
GRID = {
    "gain": (2.0, 4.0, 8.0),
    "damping": (0.5, 1.0, 2.0),
    "lead": (0.0, 0.3, 0.6),
    "beyond": (0.0, 1.0),
}


def success(settings: LineOfSightSettings, level: str, first: int, episodes: int = EPISODES) -> float:
    """The share of successes in so many episodes from a seed on."""

    def make(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
        return GatesVectorEnv(n, disturbances=level, observation=senses)

    rollout = drive(LineOfSightPilot(settings), make, first + np.arange(episodes))
    return float(np.mean(rollout.outcome == "success"))


def main() -> None:
    """Print the best settings of the grid, and a table."""
    candidates = [
        LineOfSightSettings(**dict(zip(GRID, values, strict=True))) for values in product(*GRID.values())
    ]
    rates = [success(one, "severe", FIRST) for one in candidates]
    order = np.argsort(rates, kind="stable")[::-1]
    for i in order[:8]:
        print(f"{rates[i]:.3f} at severe: {candidates[i]!r}")
    best = candidates[int(np.argmax(rates))]
    print("| pilot | calm | standard | severe |\n| --- | --- | --- | --- |")
    for name, settings in (("untuned", UNTUNED), ("tuned", best)):
        row = [success(settings, level, MEASURED, 1000) for level in ("calm", "standard", "severe")]
        print(f"| {name} | " + " | ".join(f"{rate:.3f}" for rate in row) + " |")


if __name__ == "__main__":
    main()

"""Runs for the doctor: a boat with two fixed thrusters, driven or steered, and late commands."""

from collections.abc import Callable

import numpy as np

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat
from swamp_rl.doctor.examine import examine
from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run
from swamp_rl.simulator.replay import replay

Columns = dict[str, np.ndarray]
STEP = 0.1


def gauss_markov(rng: np.random.Generator, count: int, deviation: float, memory: float) -> np.ndarray:
    keep = float(np.exp(-STEP / memory))
    found = np.zeros(count)
    for i, kick in enumerate(rng.standard_normal(count - 1), 1):
        found[i] = keep * found[i - 1] + deviation * np.sqrt(1.0 - keep * keep) * kick
    return found


def driven(twin: Boat, deviation: float) -> list[Run]:
    """Three runs of a minute under throttles that wander by a deviation."""
    rng = np.random.default_rng(4)
    throttles = [[0.5 + gauss_markov(rng, 601, deviation, 4.0) for _ in range(2)] for _ in range(3)]
    return sailed(twin, throttles, rng)


def steered(twin: Boat, shape: Callable[[np.ndarray], np.ndarray], period: float) -> list[Run]:
    """Three runs of a minute at a constant sum of the throttles and a periodic difference, shape(phase)."""
    phases = (2.0 * np.pi * np.arange(601) * STEP / period + number for number in range(3))
    apart = [0.2 * shape(phase) for phase in phases]
    return sailed(twin, [[0.5 + one, 0.5 - one] for one in apart], np.random.default_rng(4))


def sailed(twin: Boat, throttles: list[list[np.ndarray]], rng: np.random.Generator) -> list[Run]:
    """Runs of a minute under throttles of both sides, with the noise of RTK."""
    time = np.arange(601) * STEP
    runs = []
    for number, levels in enumerate(throttles):
        columns = {name: np.zeros(601) for name in ("north", "east", "heading", "surge", "sway", "yaw_rate")}
        columns |= {"time": time}
        for side, level in zip(("port", "starboard"), levels, strict=True):
            columns[f"throttle_{side}"] = np.clip(level, -1.0, 1.0)
        run = dict(replay(twin, Run(f"run-{number}", columns)).columns)
        for name, error in (("north", 0.02), ("east", 0.02), ("heading", 0.005), ("surge", 0.02)):
            run[name] = run[name] + error * rng.standard_normal(601)
        run["yaw_rate"] = run["yaw_rate"] + 0.005 * rng.standard_normal(601)
        run["heading"] = wrapped(run["heading"])
        runs.append(Run(f"run-{number}", {n: v for n, v in run.items() if not n.startswith("applied_")}))
    return runs


def faults(runs: list[Run], boat: Boat | None) -> list[Finding]:
    return [finding for finding in examine(runs, boat) if finding.level == "fault"]


def late(seconds: float) -> Callable[[Columns], Columns]:
    rows = round(seconds / STEP)
    return lambda c: {
        n: v if n == "time" else np.roll(v, -rows) if n.startswith("throttle_") else v for n, v in c.items()
    }

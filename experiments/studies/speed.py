"""`swamp-rl bench`: speed of the simulator and of a pilot as ratios against Gymnasium's own Pendulum-v1."""

import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.files import write_beside

MEANING = {
    "pendulum_steps_per_s": "steps of Pendulum-v1 in a second",
    "single_steps_per_s": "steps of one boat in a second",
    "single_over_pendulum": "one boat over Pendulum-v1",
    "single_severe_over_pendulum": "one boat in level severe over Pendulum-v1",
    "batch_boats": "boats of a batch, all forces on",
    "batch_boat_steps_per_s": "steps of all boats of the batch in a second",
    "batch_over_pendulum": "the batch over Pendulum-v1",
    "reservoir_decision_us": "a decision of a reservoir, microseconds",
    "reservoir_decisions_over_pendulum_steps": "decisions of a reservoir over steps of Pendulum-v1",
    "bytes_per_boat": "memory of a boat of the batch, bytes",
}
"""What the results are, by their keys."""
BATCH = 4096
ROUNDS = 7
"""Every figure is the median of this many turns; the turns of all of them alternate, so that a slow moment of
the machine slows what it is compared with too."""
TURN = 0.4  # s

# Everything that pushes the boat, at once: the severe level, a shallow bottom and a steady force.
ALL_FORCES: list[dict[str, Any]] = [
    {"effect": "current", "disc": 0.4},
    {"effect": "wind", "speed": {"uniform": [1.0, 7.0]}, "from": {"uniform": [-3.14, 3.14]}},
    {"effect": "gusts", "speed_std": 1.0, "direction_std": 0.2},
    {"effect": "mass", "mass": {"uniform": [48.0, 60.0]}},
    {"effect": "thruster_gain", "thruster": {"choice": ["bs", "bp"]}, "gain": {"uniform": [0.5, 0.9]}},
    {"effect": "shallow_water", "depth_over_draught": {"uniform": [2.0, 8.0]}},
    {"effect": "external_force", "north": {"uniform": [-1.0, 1.0]}, "east": {"uniform": [-1.0, 1.0]}},
    {
        "effect": "thruster_kick",
        "thruster": {"choice": ["ss", "sp"]},
        "time": {"uniform": [2.0, 25.0]},
        "duration": 1.0,
        "throttle": 1.0,
        "azimuth": {"uniform": [-1.57, 1.57]},
    },
]


def single_stepper(environment_id: str, **options: Any) -> Callable[[], int]:
    """A function that takes 200 steps of one environment, resets included, and returns their number."""
    import gymnasium

    environment = gymnasium.make(environment_id, **options)
    environment.reset(seed=0)
    environment.action_space.seed(0)
    actions = [environment.action_space.sample() for _ in range(200)]

    def take_steps() -> int:
        for action in actions:
            _, _, terminated, truncated, _ = environment.step(action)
            if terminated or truncated:
                environment.reset()
        return len(actions)

    return take_steps


def batch_stepper(boats: int) -> tuple[Callable[[], int], float]:
    """A function that takes 5 steps of a batch with all forces on, and the batch's bytes per boat."""
    import gymnasium

    environment: Any = gymnasium.make_vec("swamp/Gates-v1", num_envs=boats, disturbances=ALL_FORCES)
    environment.reset(seed=0)
    actions = np.random.default_rng(0).uniform([0.0, -1.0], [1.0, 1.0], (5, boats, 2))

    def take_steps() -> int:
        for action in actions:
            environment.step(action)
        return len(actions) * boats

    return take_steps, memory_of(environment.unwrapped.fleet) / boats


def memory_of(owner: Any) -> float:
    """Bytes of the arrays that an object and its parts hold, each counted once."""
    seen: dict[int, int] = {}

    def visit(item: Any, depth: int) -> None:
        if isinstance(item, np.ndarray):
            base: NDArray[Any] = item
            while isinstance(base.base, np.ndarray):
                base = base.base
            seen[id(base)] = base.nbytes
        elif isinstance(item, list | tuple) and depth:
            for part in item:
                visit(part, depth - 1)
        elif hasattr(item, "__dict__") and depth:
            for part in vars(item).values():
                visit(part, depth - 1)

    visit(owner, 3)
    return float(sum(seen.values()))


def decision_maker() -> Callable[[], int]:
    """A function that takes 200 decisions for one boat; a reservoir's readout does not matter for speed."""
    from swamp_rl.pilots.reservoir import untrained_reservoir

    pilot = untrained_reservoir(np.random.default_rng(0))
    pilot.reset(1)
    observation = np.random.default_rng(1).normal(size=(1, len(pilot.senses)))

    def decide() -> int:
        for _ in range(200):
            pilot.act(observation)
        return 200

    return decide


def rates_of(contestants: dict[str, Callable[[], int]]) -> dict[str, float]:
    """Median rate [1/s] of each contestant over alternating turns."""
    rates: dict[str, list[float]] = {name: [] for name in contestants}
    for work in contestants.values():
        work()  # compiled and warm before the clock starts
    for _ in range(ROUNDS):
        for name, work in contestants.items():
            done, begin = 0, time.perf_counter()
            while (elapsed := time.perf_counter() - begin) < TURN:
                done += work()
            rates[name].append(done / elapsed)
    return {name: float(np.median(values)) for name, values in rates.items()}


def run_bench(out: Path | None = None) -> dict[str, Any]:
    """Measure, and write as JSON where `out` is given; UserError for a folder there, before it measures."""
    if out is not None and out.is_dir():
        raise UserError(f"{out}: is a folder; name the JSON file to write")
    batch, bytes_per_boat = batch_stepper(BATCH)
    rates = rates_of(
        {
            "pendulum": single_stepper("Pendulum-v1"),
            "single": single_stepper("swamp/Gates-v1"),
            "single_severe": single_stepper("swamp/Gates-v1", disturbances="severe"),
            "batch": batch,
            "decision": decision_maker(),
        }
    )
    result = {
        "pendulum_steps_per_s": rates["pendulum"],
        "single_steps_per_s": rates["single"],
        "single_over_pendulum": rates["single"] / rates["pendulum"],
        "single_severe_over_pendulum": rates["single_severe"] / rates["pendulum"],
        "batch_boats": BATCH,
        "batch_boat_steps_per_s": rates["batch"],
        "batch_over_pendulum": rates["batch"] / rates["pendulum"],
        "reservoir_decision_us": 1e6 / rates["decision"],
        "reservoir_decisions_over_pendulum_steps": rates["decision"] / rates["pendulum"],
        "bytes_per_boat": bytes_per_boat,
    }
    if out is not None:
        with write_beside(out) as path:
            path.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    return result

"""Samples of a simulated boat under way, in which something may begin."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import apply_effects, parse_effects
from swamp_rl.link import Sample
from swamp_rl.simulator import initial_state, parameters, step, tank

Array = NDArray[np.float64]

BOAT = load_boat("swamp")
DT = 0.1
NOISE = np.array([0.05, 0.05, 0.008, 0.03, 0.03, 0.005])


def ahead_of_swamp(angle: float) -> Array:
    """(8,) commands under which SWAMP turns as it sails."""
    return np.array([angle, angle, -angle, -angle, 0.7, 0.6, 0.7, 0.6])


def stream(
    seconds: float,
    begins: float = np.inf,
    effects: Sequence[dict[str, Any]] = (),
    frozen: Sequence[int] = (),
    boat: Boat = BOAT,
    seed: int = 0,
    turn: Callable[[float], Array] = ahead_of_swamp,
) -> Iterator[Sample]:
    """A zig-zag; from `begins` [s] on the effects act, and the channels `frozen` repeat their reading. turn:
    commands (2K,) for an angle [rad].
    """
    rng = np.random.default_rng(seed)
    state, record = initial_state(parameters(boat), np.zeros((1, 3))), parameters(boat)
    later = record.copy()
    apply_effects(later, parse_effects(list(effects), "test", boat.thruster_names), boat.thruster_names)
    held = None
    for row in range(round(seconds / DT)):
        now = later if row * DT >= begins else record
        angle = 0.4 if (row * DT) % 12.0 < 6.0 else -0.4
        command = turn(angle)
        senses = state[0, :6] + NOISE * rng.standard_normal(6)
        senses[2] += now["heading_bias"][0]
        if frozen and row * DT >= begins:
            held = senses.copy() if held is None else held
            senses[list(frozen)] = held[list(frozen)]
        yield Sample(row * DT, command, senses)
        step(state, now, tank(boat), command[None], np.full(1, seed, np.uint64), DT, 2)

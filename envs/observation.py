"""What a pilot may sense: twelve numbers, of which each pilot chooses its own."""

import difflib
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from swamp_rl.course.tables import GATE_COS, GATE_EAST, GATE_NORTH, GATE_SIN
from swamp_rl.errors import UserError
from swamp_rl.physics.compile import compiled
from swamp_rl.simulator.state import SURGE, SWAY, YAW_RATE

OBSERVATION = (
    "north",  # m
    "east",  # m
    "cos_heading",
    "sin_heading",
    "surge",  # m/s over ground, as sway
    "sway",
    "yaw_rate",  # rad/s
    "gate_ahead",  # m from midship to the middle of the next gate, in the boat's frame
    "gate_starboard",
    "gate_cos",  # of the gate's direction relative to the bow, clockwise
    "gate_sin",
    "gates_passed",
)
UNIT_INTERVAL = ("cos_heading", "sin_heading", "gate_cos", "gate_sin")


@compiled
def look(pose: tuple[float, float, float], state: Any, passed: int, gates: Any, everything: Any) -> None:
    """Fill `everything` (12,) in the order of OBSERVATION, for the boat of `state` (S,) sensed at `pose`.

    Where the next gate lies follows from the pose sensed. Once all gates of `gates` (G, 5) are passed, the
    last stays the next.
    """
    gate = gates[min(passed, gates.shape[0] - 1)]
    north, east, heading = pose
    cos, sin = math.cos(heading), math.sin(heading)
    to_north, to_east = gate[GATE_NORTH] - north, gate[GATE_EAST] - east
    everything[0] = north
    everything[1] = east
    everything[2] = cos
    everything[3] = sin
    everything[4] = state[SURGE]
    everything[5] = state[SWAY]
    everything[6] = state[YAW_RATE]
    everything[7] = to_north * cos + to_east * sin
    everything[8] = to_east * cos - to_north * sin
    everything[9] = gate[GATE_COS] * cos + gate[GATE_SIN] * sin
    everything[10] = gate[GATE_SIN] * cos - gate[GATE_COS] * sin
    everything[11] = passed


def senses(names: Sequence[str] | None) -> NDArray[np.int64]:
    """Places in OBSERVATION of the named numbers, all for None; UserError for an unknown or doubled name."""
    if names is None:
        names = OBSERVATION
    if isinstance(names, str) or len(names) == 0:
        raise UserError(
            f"observation: must be a list of names out of {', '.join(OBSERVATION)}, not {names!r}"
        )
    for name in names:
        if name not in OBSERVATION:
            near = difflib.get_close_matches(str(name), OBSERVATION, 1)
            hint = f"did you mean {near[0]!r}? " if near else ""
            raise UserError(f"observation: unknown name {name!r}; {hint}known here: {', '.join(OBSERVATION)}")
    if len(set(names)) != len(names):
        raise UserError(f"observation: a name is given twice in {list(names)}; give each once")
    return np.array([OBSERVATION.index(name) for name in names], dtype=np.int64)


def observation_space(places: NDArray[np.int64], gate_count: int) -> spaces.Box:
    """Box of the numbers at `places`, SI units and not scaled; cosines and sines in [-1, 1], float32."""
    high = np.full(len(OBSERVATION), np.inf, dtype=np.float32)
    low = -high
    for name in UNIT_INTERVAL:
        low[OBSERVATION.index(name)], high[OBSERVATION.index(name)] = -1.0, 1.0
    low[OBSERVATION.index("gates_passed")], high[OBSERVATION.index("gates_passed")] = 0.0, gate_count
    return spaces.Box(low[places], high[places], dtype=np.float32)

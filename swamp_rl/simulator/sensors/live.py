"""What the sensors report while a boat sails, a step at a time; over a whole track it is `observe`."""

import math
from typing import Any

from swamp_rl.physics.compile import compiled
from swamp_rl.simulator.state import EAST, HEADING, NORTH, TIME


@compiled
def antenna_position(state: Any, p: Any) -> tuple[float, float]:
    """North and east [m] of the antenna of the boat of `state` (S,)."""
    cos, sin = math.cos(state[HEADING]), math.sin(state[HEADING])
    return (
        state[NORTH] + p.antenna_x * cos - p.antenna_y * sin,
        state[EAST] + p.antenna_x * sin + p.antenna_y * cos,
    )


@compiled
def keep_position(past: Any, tick: int, state: Any, p: Any) -> None:
    """Note the antenna's position at the end of step `tick` in the ring `past` (R, 2), row tick % R."""
    past[tick % past.shape[0], 0], past[tick % past.shape[0], 1] = antenna_position(state, p)


@compiled
def reported_pose(past: Any, tick: int, state: Any, dt: float, p: Any) -> tuple[float, float, float]:
    """Measured north, east [m] and heading [rad, not wrapped] at the end of step `tick` of dt [s].

    past: (R, 2) by `keep_position`, R >= delay / dt + 2, filled at the start with where the boat came from.
    The receiver's clock is left out: it shifts the times in a record, not when a reading arrives on board.
    """
    delay = p.position_delay / dt
    whole = int(delay)
    share = delay - whole
    newer, older = (tick - whole) % past.shape[0], (tick - whole - 1) % past.shape[0]
    return (
        past[newer, 0] + share * (past[older, 0] - past[newer, 0]),
        past[newer, 1] + share * (past[older, 1] - past[newer, 1]),
        state[HEADING] + p.heading_bias + p.heading_drift * state[TIME],
    )

"""Straight-line stability: whether a boat under way at fixed commands returns to a straight course."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.manoeuvres.controller import Order
from swamp_rl.manoeuvres.steering import commands_of
from swamp_rl.manoeuvres.under_way import under_way
from swamp_rl.simulator import parameters, step, tank
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.state import SWAY, YAW_RATE
from swamp_rl.simulator.substeps import substeps_of

SMALL = 1e-3  # disturbance in units of U and U/L: far below where the cross-flow drag counts
LASTS = 0.1  # of L / U, over which the disturbance is watched
MOST_DAMPING = -0.5  # N'_r, several times that of a hull with a skeg
HALVINGS = 30


@dataclass(frozen=True)
class StraightLineStability:
    """growth [1/s]: real part of the least stable root of sway and yaw at full ahead, positive where the boat
    is unstable; stable_n_r [1]: N'_r of the hull at which it becomes zero, None for a stable boat or where no
    yaw damping makes it stable.
    """

    growth: float
    stable_n_r: float | None


def straight_line_stability(boat: Boat) -> StraightLineStability:
    """Stability of the straight course at full ahead and top speed, controls fixed (Fossen 2011).

    The roots are those of sway and yaw rate, linearised by differences of the simulated motion; surge and
    actuators are steady. The boat's own effects act, wind and current do not.
    """
    params = parameters(boat)
    growth = _growth(boat, params)
    if growth <= 0.0:
        return StraightLineStability(growth, None)
    low, high = MOST_DAMPING, float(params["n_r"][0])
    if high <= low or _growth(boat, _damped(params, low)) > 0.0:
        return StraightLineStability(growth, None)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _growth(boat, _damped(params, middle)) <= 0.0 else (low, middle)
    return StraightLineStability(growth, low)


def _damped(params: NDArray[Any], n_r: float) -> NDArray[Any]:
    changed = params.copy()
    changed["n_r"] = n_r
    return changed


def _growth(boat: Boat, params: NDArray[Any]) -> float:
    """Real part [1/s] of the least stable root of sway and yaw."""
    reference = reference_of(boat)
    sizes = SMALL * np.array([reference.speed, reference.speed / boat.length])
    command = commands_of(boat, "opposed")(Order(0.0, 1.0))
    both, state = under_way(boat, params, 4, command)
    state[:2, [SWAY, YAW_RATE]], state[2:, [SWAY, YAW_RATE]] = np.diag(sizes), -np.diag(sizes)
    dt = LASTS * boat.length / reference.speed
    commands, seeds = np.tile(command, (4, 1)), np.zeros(4, np.uint64)
    step(state, both, tank(boat), commands, seeds, dt, substeps_of(dt, boat))
    after = 0.5 * (state[:2, [SWAY, YAW_RATE]] - state[2:, [SWAY, YAW_RATE]]).T / sizes
    return math.log(float(np.abs(np.linalg.eigvals(after)).max())) / dt

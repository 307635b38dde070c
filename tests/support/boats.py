"""Short ways for tests to drive a boat: commands in the order of the simulator, tracks of one boat."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, load_boat
from swamp_rl.physics.hull import hull_forces
from swamp_rl.physics.resistance import towing
from swamp_rl.simulator import initial_state, parameters, simulate, tank

Array = NDArray[np.float64]
FOIL = {"area": 0.01, "aspect_ratio": 1.5}


def with_foils(**keys: float) -> Boat:
    """SWAMP with a foil at each of its four jets; keys: of the foils, beside FOIL."""
    return load_boat("swamp", {"thruster_model": {"foil": FOIL | keys}})


def commands(bow: float, stern: float, throttle: tuple[float, float, float, float], steps: int) -> Array:
    """(steps, 8) held commands of SWAMP's bs, bp, ss, sp: bow and stern azimuth in degrees, throttles [1]."""
    angles = np.radians([bow, bow, stern, stern])
    return np.tile(np.concatenate([angles, throttle]), (steps, 1))


def track(
    boat: Boat,
    command: Array,
    pose: tuple[float, float, float] = (0.0, 0.0, 0.0),
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    dt: float = 0.1,
    substeps: int = 2,
    start: Array | None = None,
    **fields: Any,
) -> Array:
    """(T + 1, S) states of one boat; `fields` are set in its parameter record."""
    params = parameters(boat)
    for name, value in fields.items():
        params[name] = value
    if start is None:
        start = initial_state(params, np.array([pose]), np.array([velocity]))
    return simulate(params, tank(boat), start, command[None], np.zeros(1, np.uint64), dt, substeps)[0]


def forces_on_hull(boat: Boat, p: Any, u: float, v: float, r: float) -> tuple[float, float, float]:
    """Surge, sway force [N] and yaw moment [N m] on the hull; p: the boat's parameter record."""
    return hull_forces(u, v, r, p, tank(boat), towing(p, tank(boat)))

"""Boat files written by estimates, of every kind and size, and how they move."""

from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import Kind, annotated, boat_file
from swamp_rl.manoeuvres.controller import Order
from swamp_rl.manoeuvres.steering import commands_of
from tests.support.boats import Array, track

SIZES = {0.3: 0.2, 1.2: 0.14, 5.0: 0.05, 20.0: 0.03}
"Length [m] and thrust over weight."
GRAVITY = 9.81


def file_of(folder: Path, kind: Kind, length: float = 1.2, **changes: Any) -> Path:
    """The file of a boat of that kind, 0.4 lengths wide and floating at a tenth of its length."""
    mass = changes.pop("mass", 20.5 * length**3)
    thrust = changes.pop("thrust", SIZES.get(length, 0.1) * mass * GRAVITY)
    content = boat_file("new", kind, length, 0.4 * length, mass, thrust, **changes)
    path = folder / f"{kind}.yaml"
    path.write_text(annotated(content, "a test"), encoding="utf-8")
    return path


def new_boat(folder: Path, kind: Kind, length: float = 1.2, **changes: Any) -> Boat:
    """The boat of `file_of`."""
    return load_boat(file_of(folder, kind, length, **changes))


def sailed(boat: Boat, angle: float, lengths: float = 40.0, throttle: float = 0.6) -> Array:
    """(T, S) states from rest at a steering angle [rad] and a throttle, for so many √(L/g)."""
    steps = int(lengths * (boat.length / GRAVITY) ** 0.5 / 0.1) + 1
    command = commands_of(boat, "opposed")(Order(angle, throttle))
    return track(boat, np.tile(command, (steps, 1)))

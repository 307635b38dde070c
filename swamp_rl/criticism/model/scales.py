"""Sizes of a boat's motion and forces, by which thresholds follow the boat."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.options import options
from swamp_rl.simulator.reference import reference_of

Array = NDArray[np.float64]


def state_scale(boat: Boat) -> Array:
    """(6,) L, L [m], 1 [rad], U, U [m/s] and U/L [rad/s], of length L and top speed U."""
    of = reference_of(boat)
    return np.array([of.length, of.length, 1.0, of.speed, of.speed, of.rate])


def acceleration_scale(boat: Boat) -> Array:
    """(3,) U²/L, U²/L [m/s2] and U²/L² [rad/s2]."""
    of = reference_of(boat)
    return np.array([of.acceleration, of.acceleration, of.rate**2])


def force_scale(boat: Boat) -> Array:
    """(3,) T, T [N] and T L [N m], of thrust T."""
    of = reference_of(boat)
    return np.array([of.thrust, of.thrust, of.thrust * of.length])


def window_lengths(boat: Boat) -> tuple[float, float]:
    """Durations of short and middle windows [s]: max(t, n L/U), of options t [s] and n, length L and top
    speed U.
    """
    rate = reference_of(boat).rate
    pairs = zip(options().window_lengths, options().window_lengths_of_boat, strict=True)
    short, middle = (max(seconds, lengths / rate) for seconds, lengths in pairs)
    return short, middle

"""Squat: how far a boat under way sinks in shallow water."""

import math

from swamp_rl.constants import GRAVITY
from swamp_rl.physics.compile import compiled

FACTOR = 2.4  # of ICORELS
GREATEST_DEPTH_NUMBER = 0.999  # above it the squat is held: the formula has none from 1 on


@compiled
def sinkage(volume: float, length: float, speed: float, depth: float) -> float:
    """Sinkage [m] of the lowest point at a speed U [m/s] through water of a depth h [m]: ICORELS.

    2.4 (∇/L²) F²/√(1 − F²), F = U/√(g h) the depth Froude number (PIANC, Approach Channels, 1997), ∇ the
    displaced volume [m3], L the length [m]. The formula holds below F = 1; F is taken as
    `GREATEST_DEPTH_NUMBER` at most.
    """
    square = min(speed * speed / (GRAVITY * depth), GREATEST_DEPTH_NUMBER * GREATEST_DEPTH_NUMBER)
    return FACTOR * volume / (length * length) * square / math.sqrt(1.0 - square)

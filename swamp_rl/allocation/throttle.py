"""The throttle that gives a wanted thrust: the simulator's own thrust curve, inverted."""

from typing import Any

from swamp_rl.physics.compile import compiled
from swamp_rl.physics.thrusters import effective_thrust

HALVINGS = 52  # a double's precision


@compiled
def throttle_for(thrust: float, k: int, p: Any) -> float:
    """Throttle [1] in [-1, 1] of jet k for a thrust [N] with thrust deduction; its limit beyond reach.

    Bisection: the thrust rises with the throttle (12.2 p^2 (1 - t), for SWAMP).
    """
    if thrust == 0.0:
        return 0.0
    low, high = (0.0, 1.0) if thrust > 0.0 else (-1.0, 0.0)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if effective_thrust(middle, k, p) < thrust:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)

"""What the sensors report of the boat's motion: antenna off midship, times and compass off."""

from swamp_rl.simulator.sensors.observe import (
    CHANNELS,
    add_noise,
    is_altered,
    observe,
    rows_ahead,
    sensors_of,
    true_motion,
)

__all__ = [
    "CHANNELS",
    "add_noise",
    "is_altered",
    "observe",
    "rows_ahead",
    "sensors_of",
    "true_motion",
]

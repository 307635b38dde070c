"""Line-of-sight steering to the next gate, a baseline without learning (Fossen 2011, 10.3.2)."""

from typing import Any, ClassVar

import numpy as np

from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array, checked, checked_count
from swamp_rl.pilots.demonstrations import GATE
from swamp_rl.pilots.settings import NotNegative, Settings, Share

DAMPING = 0.5  # s/rad, tuned for SWAMP


class LineOfSightSettings(Settings):
    """angle = clip(gain · bearing − damping · yaw rate, −1, 1), throttle held.

    The point aimed at lies on the gate's middle line. The defaults were tuned at `severe` by
    `benchmarks.learners.line_of_sight`, on episodes that no shipped experiment evaluates.
    """

    gain: NotNegative = 4.0
    "Gain of the bearing [1/rad]."
    damping: NotNegative | None = None
    "Gain of the yaw rate [s/rad]; by default the boat's (`envs.line_of_sight_damping`), SWAMP's for none."
    lead: Share = 0.6
    "The aim lies this share of the remaining distance before the gate; 0 is the gate itself."
    beyond: NotNegative = 0.0
    "The aim lies this distance [m] behind that."
    throttle: Share = 1.0


class LineOfSightPilot:
    """Proportional to the bearing of a point, damped by the yaw rate; no internal state."""

    kind: ClassVar[str] = "line-of-sight"
    senses: tuple[str, ...] = (*GATE, "yaw_rate")

    def __init__(self, settings: LineOfSightSettings | None = None) -> None:
        """settings: gains and the point aimed at."""
        self.options = settings or LineOfSightSettings()
        self._damping = DAMPING if self.options.damping is None else self.options.damping

    def reset(self, n: int) -> None:
        """Check n: there is no internal state."""
        checked_count(n)

    def reset_boats(self, mask: Array) -> None:
        """Do nothing: there is no internal state."""

    def keep(self, boats: Array) -> None:
        """Do nothing: there is no internal state."""

    def act(self, observation: Array) -> Array:
        """Levers (n, 2), throttle and angle, from the observation (n, 5) in the order of `senses`."""
        o = self.options
        ahead, starboard, cos, sin, yaw_rate = checked(observation, self.senses).astype(np.float64).T
        to_go = np.maximum(ahead * cos + starboard * sin, 0.0)
        shift = o.beyond - o.lead * to_go
        bearing = np.arctan2(starboard + shift * sin, ahead + shift * cos)
        angle = o.gain * bearing - self._damping * yaw_rate
        return np.clip(np.stack([np.full(len(angle), o.throttle), angle], axis=1), LOWEST, HIGHEST)

    def settings(self) -> dict[str, Any]:
        """Its options."""
        return self.options.model_dump(mode="json")

    def weights(self) -> dict[str, Array]:
        """Return no arrays."""
        return {}

    @classmethod
    def build(cls, settings: dict[str, Any], weights: dict[str, Array]) -> "LineOfSightPilot":
        """The pilot of `settings()`."""
        return cls(LineOfSightSettings(**settings))

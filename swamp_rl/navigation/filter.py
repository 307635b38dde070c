"""An extended Kalman filter for pose, velocity and current from readings at any times (thesis 6.4, [220]).

Own code: the filter is a few textbook lines (`kalman`), and the Python packages that offer them are no longer
kept.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.guidance.loop import Seen
from swamp_rl.navigation.kalman import propagated, updated
from swamp_rl.navigation.predict import Predictor
from swamp_rl.navigation.sensors import Fix

Array = NDArray[np.float64]

HEADING = 2
# Random walk of pose, velocities and current [unit/sqrt(s)]: what the model does not know of the motion.
WITH_MODEL = np.array([0.0, 0.0, 0.0, 0.05, 0.05, 0.03, 0.02, 0.02])
COASTING = np.array([0.0, 0.0, 0.0, 0.15, 0.15, 0.15, 0.0, 0.0])
START = np.array([1.0, 1.0, 0.05, 0.1, 0.1, 0.05, 0.15, 0.15])  # of a boat about at rest


@dataclass(frozen=True)
class Innovation:
    """A reading less its prediction: places (m,) of the states, value (m,), its covariance (m, m), whitener
    (m, m) with unit covariance of whitener @ value, and the filter's gain (n, m).
    """

    places: tuple[int, ...]
    value: Array
    covariance: Array
    whitener: Array
    gain: Array

    @property
    def squared(self) -> float:
        """Normalised innovation squared, chi-square with m degrees of freedom if all is consistent."""
        return float(np.sum((self.whitener @ self.value) ** 2))


@dataclass
class Navigator:
    """The filter: x (8,) as in `predict`, covariance P (8, 8), process noise walk (8,) [unit/sqrt(s)]."""

    predictor: Predictor
    x: Array
    walk: Array
    P: Array = field(default_factory=lambda: np.diag(START**2))

    def predict(self, commands: Array, dt: float) -> Array:
        """Move on by dt [s] under commands (2K,); returns the Jacobian (8, 8) of the step."""
        self.x, F = self.predictor.predict(self.x, commands, dt)
        self.P = propagated(self.P, F, self.walk, dt)
        return F

    def update(self, fix: Fix) -> Innovation:
        """Take a reading in; returns its innovation."""
        places = list(fix.places)
        innovation = fix.values - self.x[places]
        if HEADING in places:
            at = places.index(HEADING)
            innovation[at] = wrapped(float(innovation[at]))
        S, W, K, self.P = updated(self.P, np.array(places), fix.deviations)
        self.x = self.x + K @ innovation
        return Innovation(fix.places, innovation, S, W, K)

    def error_squared(self, truth: Array) -> float:
        """Normalised estimation error squared of pose and velocity against the true ones (6,)."""
        error = truth - self.x[:6]
        error[HEADING] = wrapped(float(error[HEADING]))
        return float(error @ np.linalg.solve(self.P[:6, :6], error))

    def seen(self, time: float, azimuth: Array) -> Seen:
        """The estimate at `time` [s] as controllers take it, with the measured azimuths (K,)."""
        north, east, heading, surge, sway, yaw_rate = (float(value) for value in self.x[:6])
        return Seen(time, north, east, heading, surge, sway, yaw_rate, azimuth)

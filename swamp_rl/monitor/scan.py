"""A scan for faults that no channel shows alone: the signatures of a few onsets against the innovations.

A failed thruster changes every channel a little, and for many seconds. The likelihood ratio of its signature
(Willsky and Jones 1976) adds all of that up; the windows of `change_test` see one channel at a time.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.monitor.isolation import free, moved, neutral_x
from swamp_rl.monitor.signature import signatures, white_of
from swamp_rl.monitor.tracker import Step

AGES = (1.5, 3.0, 5.0)  # s from the onsets that are tried to now


class Scan:
    """The effects on thrusters that have no size, and those that push the boat. record: (1,) parameters."""

    def __init__(
        self, boat: Boat, record: NDArray[Any], instances: Sequence[EffectInstance], dt: float
    ) -> None:
        self.boat, self.dt = boat, dt
        self.failures = [one for one in instances if not free(one)]
        self.pushes = [one for one in instances if one.effect.acts_on == "force"]
        tried = [(one, neutral_x(one, 0.0)) for one in self.failures]
        tried += [(one, x) for one in self.pushes for x in moved(one, neutral_x(one, 0.0))]
        own = [Hypothesis((one,)).records(boat, x[None], record) for one, x in tried]
        self.records = np.concatenate([record, *own])

    def gain(self, history: Sequence[Step]) -> float:
        """The greatest fall of chi2, less two for each size, of an effect that began at one of the `AGES`."""
        best = 0.0
        for age in AGES:
            window = list(history)[-1 - round(age / self.dt) :]
            white, found = white_of(window), signatures(self.boat, self.records, window, self.dt)
            for own in found[: len(self.failures)]:
                best = max(best, float(2.0 * own @ white - own @ own))
            rest = found[len(self.failures) :]
            for one in self.pushes:
                own, rest = rest[: one.size], rest[one.size :]
                fitted = np.linalg.lstsq(own.T, white, rcond=1e-9)[0] @ own
                best = max(best, float(fitted @ white) - 2.0 * one.size)
        return best

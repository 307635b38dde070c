"""A scan for failed thrusters that no channel shows alone: their signatures against the innovations.

A failed thruster changes every channel a little, and for many seconds. The likelihood ratio of its signature
(Willsky and Jones 1976) adds all of that up; the windows of `change_test` see one channel at a time. Only
effects without a size are scanned for: a wind that the model does not know looks like any small force.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.monitor.isolation import free, neutral_x
from swamp_rl.monitor.signature import signatures, white_of
from swamp_rl.monitor.tracker import Step

AGES = (1.5, 3.0, 5.0)  # s from the onsets that are tried to now


class Scan:
    """The effects without a size among `instances`, in a boat of these parameters, record (1,)."""

    def __init__(
        self, boat: Boat, record: NDArray[Any], instances: Sequence[EffectInstance], dt: float
    ) -> None:
        self.boat, self.dt = boat, dt
        failures = [one for one in instances if not free(one)]
        own = [Hypothesis((one,)).records(boat, neutral_x(one, 0.0)[None], record) for one in failures]
        self.records = np.concatenate([record, *own])

    def gain(self, history: Sequence[Step]) -> float:
        """The greatest fall of chi2 by an effect that began at one of the `AGES`."""
        best = 0.0
        for age in AGES:
            window = list(history)[-1 - round(age / self.dt) :]
            white = white_of(window)
            for own in signatures(self.boat, self.records, window, self.dt):
                best = max(best, float(2.0 * own @ white - own @ own))
        return best

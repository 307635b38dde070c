"""The hypothesis that nothing began, and the sea is only rougher for a while.

Under more process noise than the filter has, an unusual motion is less unlikely; how much less is the
likelihood ratio of the same filter with its process noise multiplied (Mehra 1970).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.link.stream import Sample
from swamp_rl.monitor.tracker import CURRENT, Tracker, loss_of, walk_of


def rougher_sea(boat: Boat, tracker: Tracker, samples: Sequence[Sample], blind: Sequence[int]) -> float:
    """The criterion of this hypothesis: by how much minus twice the log-likelihood of the readings in the
    filter's history falls under the best multiple of its process noise, or of that of a light wind where this
    is more, less two for that number.

    samples: those of the history; blind: channels that are not taken.
    """
    first, of = tracker.history[0], tracker.options
    usual = np.maximum(tracker.walk, of.wind * walk_of(boat, of))

    def loss(walk: NDArray[np.float64]) -> float:
        rough = Tracker(boat, tracker.record, tracker.sigmas, walk, samples[0], tracker.dt, of)
        rough.restart(first, samples[0], tracker.record, np.zeros(len(CURRENT)))
        return sum(loss_of(rough.advance(sample, blind)) for sample in samples[1:])

    return loss(tracker.walk) - min(loss(multiple * usual) for multiple in of.rougher) - 2.0

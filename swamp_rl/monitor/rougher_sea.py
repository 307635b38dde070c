"""The hypothesis that nothing began, and the sea is only rougher for a while.

Under more process noise than the filter has, an unusual motion is less unlikely; how much less is the
likelihood ratio of the same filter with its process noise multiplied (Mehra 1970).
"""

from collections.abc import Sequence

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.link.stream import Sample
from swamp_rl.monitor.tracker import CURRENT, Tracker, loss_of


def rougher_sea(boat: Boat, tracker: Tracker, samples: Sequence[Sample], blind: Sequence[int]) -> float:
    """The criterion of this hypothesis: by how much minus twice the log-likelihood of the readings in the
    filter's history falls under the best multiple of its process noise, less two for that number.

    samples: those of the history; blind: channels that are not taken.
    """
    first = tracker.history[0]

    def loss(multiple: float) -> float:
        walk = multiple * tracker.walk
        rough = Tracker(boat, tracker.record, tracker.sigmas, walk, samples[0], tracker.dt, tracker.options)
        rough.restart(first, samples[0], tracker.record, np.zeros(len(CURRENT)))
        return sum(loss_of(rough.advance(sample, blind)) for sample in samples[1:])

    return loss(1.0) - min(loss(multiple) for multiple in tracker.options.rougher) - 2.0

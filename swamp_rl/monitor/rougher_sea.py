"""A sudden effect against the hypothesis that nothing began, and the sea is only rougher for a while.

Under more process noise than the filter has, an unusual motion is less unlikely (Mehra 1970). How much noise
there is is not known under either hypothesis: of both the greatest likelihood over its multiples is taken, a
generalised likelihood ratio with a nuisance parameter (Basseville and Nikiforov 1993, ch. 4).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.link.stream import Sample
from swamp_rl.monitor.disturbance import ProcessNoise
from swamp_rl.monitor.tracker import CURRENT, Tracker, loss_of, noise_level

Array = NDArray[np.float64]


def lead_over_sea(
    boat: Boat,
    tracker: Tracker,
    samples: Sequence[Sample],
    blind: Sequence[int],
    place: int,
    record: NDArray[Any],
    shift: Array,
) -> float:
    """By how much minus twice the log-likelihood of the readings in the filter's history is less with another
    record (1,) and a shift (2,) of the current [m/s] from step `place` on than without.

    samples: those of the history; blind: channels that are not taken.
    """
    first, of = tracker.history[0], tracker.options

    def loss(noise: ProcessNoise, changed: bool) -> float:
        own = Tracker(boat, tracker.record, tracker.sigmas, noise, samples[0], tracker.dt, of)
        own.restart(first, samples[0], tracker.record, np.zeros(len(CURRENT)))
        total = 0.0
        for at, sample in enumerate(samples[1:]):
            if changed and at == place:
                own.restart(own.history[-1], samples[at], record, shift)
            total += loss_of(own.advance(sample, blind))
        return total

    least = noise_level(boat, *of.light_wind, of)
    noises = [tracker.noise, *(tracker.noise.at_least(least).times(multiple) for multiple in of.rougher)]
    return min(loss(noise, False) for noise in noises) - min(loss(noise, True) for noise in noises)

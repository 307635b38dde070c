"""What a search needs of measured runs: noise, weights and candidates."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.model.candidates import EffectInstance, candidates, hull_nuisance
from swamp_rl.criticism.nuisance.smoothed_channels import Smoothing, raised, smoothed_channels

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Preparation:
    """smoothed: channels that a filter smoothed; sigmas: (6,) standard deviations that channels are weighted
    by, NaN where nothing was measured; weight: (R, T, 6); instances: the candidates; hull: the hull's
    derivatives, a nuisance.
    """

    smoothed: Mapping[str, Smoothing]
    sigmas: Array
    weight: Array
    instances: list[EffectInstance]
    hull: EffectInstance | None


def prepared(run_set: RunSet) -> Preparation:
    """Of the runs as measured."""
    smoothed = smoothed_channels(run_set)
    sigmas = raised(noise_levels(run_set), smoothed)
    duration = float(run_set.lengths.max() * run_set.dt)
    every = candidates(run_set.boat, duration, run_set.groups)
    return Preparation(
        smoothed,
        sigmas,
        weights(run_set, sigmas),
        [one for one in every if not _is_measured(one, run_set)],
        hull_nuisance(run_set.boat),
    )


def _is_measured(instance: EffectInstance, run_set: RunSet) -> bool:
    """Whether an effect moves only what the runs measure."""
    fields = {parameter.field for parameter in instance.effect.parameters}
    return bool(fields) and fields <= run_set.measured_fields

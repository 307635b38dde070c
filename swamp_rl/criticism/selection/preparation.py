"""What a search is given: the noise that the runs were measured with, and the candidates."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.discretisation import discretisation_errors
from swamp_rl.criticism.model.candidates import EffectInstance, candidates, hull_nuisance, nuisances
from swamp_rl.criticism.nuisance.smoothed_channels import raised, smoothed_channels
from swamp_rl.criticism.result import SmoothedNoise

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Preparation:
    """smoothed: channels that a filter smoothed; sigmas: (6,) standard deviations that channels are weighted
    by, NaN where nothing was measured; weight: (R, T, 6); instances: the candidates, and what is a nuisance
    beside one of them alone; hull: the hull's derivatives, a nuisance.
    """

    smoothed: dict[str, SmoothedNoise]
    sigmas: Array
    weight: Array
    instances: list[EffectInstance]
    hull: EffectInstance | None


def prepared(run_set: RunSet) -> Preparation:
    """Of the runs as measured."""
    smoothed = smoothed_channels(run_set)
    sigmas = raised(noise_levels(run_set), smoothed)
    sigmas = np.hypot(sigmas, discretisation_errors(run_set, weights(run_set, sigmas)))
    duration = float(run_set.lengths.max() * run_set.dt)
    every = candidates(run_set.boat, duration, run_set.groups)
    beside = [one for one in nuisances(run_set.boat) if one.effect.beside]
    return Preparation(
        smoothed,
        sigmas,
        weights(run_set, sigmas),
        [*(one for one in every if not _is_measured(one, run_set)), *beside],
        hull_nuisance(run_set.boat),
    )


def _is_measured(instance: EffectInstance, run_set: RunSet) -> bool:
    """Whether an effect moves only what the runs measure."""
    fields = {parameter.field for parameter in instance.effect.parameters}
    return bool(fields) and fields <= run_set.measured_fields

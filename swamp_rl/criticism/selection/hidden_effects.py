"""Effects that the data could show, and that the model's own error hides."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.criticism.nuisance.model_error import correlation_samples, standardised_residual
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.score_test import score_tests

Array = NDArray[np.float64]


def hidden_effects(
    run_set: RunSet, weight: Array, judged: Shooting, found: Selection, instances: Sequence[EffectInstance]
) -> list[str]:
    """Labels of effects whose standard error is small under the measurement noise (`least_information`) and
    large under the model error; none where the residual is noise.

    weight: (R, T, 6) by the noise; judged: the problem of the winner's stage.
    """
    if found.adequate:
        return []
    if judged.correlation_samples > 1.0:  # it is weighted by the model error
        unseen = [one for one in instances if one.label in found.unidentifiable]
        problem = Shooting(run_set, weight, options().window_lengths[0])
        nothing = fit(problem, Hypothesis(), np.zeros(0), problem.initial_states(), options().stage_steps[0])
        scores = score_tests(problem, nothing, unseen)
        return [one.instance.label for one in scores if one.information >= options().least_information]
    # variance of an estimate under errors of that size and correlation, over that under white noise
    size = max(found.winner.chi2 / judged.samples, 1.0)
    wider = size * correlation_samples(standardised_residual(judged, found.winner))
    kept = {instance.label for instance in found.winner.hypothesis.instances}
    return [
        one.instance.label
        for one in found.first
        if options().least_information <= one.information < wider * options().least_information
        and one.instance.label not in kept
    ]

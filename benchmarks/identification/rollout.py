"""Rollout fitting of chosen effects, by the model criticism's own fit, for the identification benchmark."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import run_set_of
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import Hypothesis, candidates
from swamp_rl.runs import Run

WINDOW = 20.0  # s


def fitted(runs: list[Run], boat: Boat, effects: Sequence[str]) -> dict[str, list[float]]:
    """The named effects' numbers at their best on the runs, in windows each with a start of its own."""
    run_set = run_set_of(runs, boat, "benchmark")
    problem = Shooting(run_set, weights(run_set, noise_levels(run_set)), WINDOW)
    hypothesis = Hypothesis()
    for instance in candidates(boat, max(run.duration for run in runs)):
        if instance.label in effects:
            hypothesis = hypothesis.with_instance(instance)
    x = np.concatenate([instance.starts[0] for instance in hypothesis.instances])
    found = fit(problem, hypothesis, x, problem.initial_states())
    return {instance.label: [float(value) for value in own] for instance, own in hypothesis.parts(found.x)}

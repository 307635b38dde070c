"""Rollout fitting of chosen effects, by the model criticism's own fit, for the identification benchmark."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.criticism.candidates import Hypothesis, candidates
from swamp_rl.criticism.data import trials_of
from swamp_rl.criticism.fit import fit
from swamp_rl.criticism.noise import noise_levels, weights
from swamp_rl.criticism.shooting import Shooting
from swamp_rl.runs import Run

WINDOW = 20.0  # s


def fitted(runs: list[Run], boat: Boat, effects: Sequence[str]) -> dict[str, list[float]]:
    """The named effects' numbers at their best on the runs, in windows each with a start of its own."""
    trials = trials_of(runs, boat, "benchmark")
    problem = Shooting(trials, weights(trials, noise_levels(trials)), WINDOW)
    hypothesis = Hypothesis()
    for atom in candidates(boat, max(run.duration for run in runs)):
        if atom.label in effects:
            hypothesis = hypothesis.with_atom(atom)
    x = np.concatenate([atom.starts[0] for atom in hypothesis.atoms])
    found = fit(problem, hypothesis, x, problem.guess())
    return {atom.label: [float(value) for value in own] for atom, own in hypothesis.parts(found.x)}

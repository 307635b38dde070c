"""Indistinguishable hypotheses: angle between their sensitivities, and the manoeuvre that separates them."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.trial_evidence import Question, explanation_of, rate
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.likelihood.sandwich_covariance import sensitivities
from swamp_rl.criticism.model.manoeuvres import manoeuvres
from swamp_rl.criticism.model.trial_limits import UNLIMITED
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import Contrast, Manoeuvre

Array = NDArray[np.float64]


def contrast(problem: Shooting, winner: Fit, rival: Fit, evidence: float) -> Contrast:
    """Of two fits on the same windows; evidence: information criterion of the rival above the winner's."""
    return Contrast(
        effects=[winner.hypothesis.label, rival.hypothesis.label],
        angle=angle_between(problem, winner, rival),
        evidence=evidence,
        mutual_refit=max(refit(problem, winner, rival), refit(problem, rival, winner)),
    )


def angle_between(problem: Shooting, one: Fit, other: Fit) -> float:
    """Smallest principal angle [rad] between the sensitivities of two fits; pi/2 where one has no
    parameter.
    """
    if not one.hypothesis.size or not other.hypothesis.size:
        return float(np.pi / 2)
    bases = [np.linalg.qr(sensitivities(problem, at))[0] for at in (one, other)]
    cosines = np.linalg.svd(bases[0].T @ bases[1], compute_uv=False)
    return float(np.arccos(np.clip(cosines.max(), -1.0, 1.0)))


def refit(problem: Shooting, truth: Fit, other: Fit) -> float:
    """chi2 that remains when `other` is fitted to the noise-free prediction of `truth`."""
    track = problem.predict(truth.hypothesis, truth.x[None], truth.states[None])[0]
    synthetic = Shooting(
        problem.run_set, problem.weight, problem.seconds, replace(problem.windows, measured=track)
    )
    return float(fit(synthetic, other.hypothesis, other.x, other.states, options().check_steps).loss.sum())


def separating_manoeuvre(run_set: RunSet, sigmas: Array, winner: Fit, rivals: list[Fit]) -> Manoeuvre:
    """The manoeuvre with the greatest least distance between any two of the winner and its rivals, in
    standard errors.
    """
    names, commands = zip(*manoeuvres(run_set.boat, run_set.dt).items(), strict=True)
    explanations = tuple(explanation_of(one, one.covariance) for one in (winner, *rivals))
    rated = rate(Question(run_set, sigmas, explanations), np.array(commands), UNLIMITED)
    apart = np.sqrt(rated.least)
    best = int(apart.argmax())
    return Manoeuvre(
        manoeuvre=names[best], separation=float(apart[best]), duration_s=options().manoeuvre_length
    )

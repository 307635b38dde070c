"""Identifiability: indistinguishable hypotheses, what separates them, and effects hidden by model error."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.sandwich_covariance import sensitivities
from swamp_rl.criticism.inference.trial_evidence import Question, explanation_of, rate, refitted
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit, noise_free
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.criticism.model.manoeuvres import manoeuvres
from swamp_rl.criticism.model.scales import window_lengths
from swamp_rl.criticism.model.trial_limits import UNLIMITED
from swamp_rl.criticism.nuisance.process_noise import correlation_samples
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import Cause, Contrast, Manoeuvre
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.score_test import score_tests

Array = NDArray[np.float64]


def contrast(problem: Shooting, winner: Fit, rival: Fit, evidence: float, causes: list[Cause]) -> Contrast:
    """Of two fits on the same windows; evidence: information criterion of the rival above the winner's;
    causes: the rival's.
    """
    return Contrast(
        effects=[winner.hypothesis.label, rival.hypothesis.label],
        angle=angle_between(problem, winner, rival),
        evidence=evidence,
        mutual_refit=max(refit(problem, winner, rival), refit(problem, rival, winner)),
        rival=causes,
    )


def angle_between(problem: Shooting, one: Fit, other: Fit) -> float:
    """Smallest principal angle [rad] between two fits' sensitivities; pi/2 without parameters."""
    if not one.hypothesis.size or not other.hypothesis.size:
        return float(np.pi / 2)
    bases = [np.linalg.qr(sensitivities(problem, at))[0] for at in (one, other)]
    cosines = np.linalg.svd(bases[0].T @ bases[1], compute_uv=False)
    return float(np.arccos(np.clip(cosines.max(), -1.0, 1.0)))


def refit(problem: Shooting, truth: Fit, other: Fit) -> float:
    """chi2 that remains when `other` is fitted to the noise-free prediction of `truth`."""
    ideal = noise_free(problem, truth)
    return float(fit(ideal, other.hypothesis, other.x, other.states, options().check_steps).loss.sum())


def separating_manoeuvre(run_set: RunSet, sigmas: Array, winner: Fit, rivals: list[Fit]) -> Manoeuvre | None:
    """The manoeuvre of greatest least distance between any two of the fits, in standard errors."""
    if not rivals:
        return None
    names, commands = zip(*manoeuvres(run_set.boat, run_set.dt).items(), strict=True)
    explanations = tuple(explanation_of(one, one.covariance) for one in (winner, *rivals))
    question = Question(run_set, sigmas, explanations)
    rated = rate(question, np.array(commands), UNLIMITED)
    evidence, _ = refitted(question, np.array(commands), rated, 1)
    best = int(evidence.argmax())
    return Manoeuvre(
        manoeuvre=names[best],
        separation=math.sqrt(evidence[best]),
        duration_s=options().trial_seconds,
    )


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
        problem = Shooting(run_set, weight, window_lengths(run_set.boat)[0])
        nothing = fit(problem, Hypothesis(), np.zeros(0), problem.initial_states(), options().stage_steps[0])
        scores = score_tests(problem, nothing, unseen)
        return [one.instance.label for one in scores if one.information >= options().least_information]
    # variance of an estimate under errors of that size and correlation, over that under white noise
    size = max(found.winner.chi2 / judged.samples, 1.0)
    wider = size * correlation_samples(judged.windows.by_channel(found.winner.residual))
    kept = {instance.label for instance in found.winner.hypothesis.instances}
    return [
        one.instance.label
        for one in found.first
        if options().least_information <= one.information < wider * options().least_information
        and one.instance.label not in kept
    ]

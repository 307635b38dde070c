"""Extended Bayesian information criterion of a fit (Chen and Chen 2008)."""

import math
from dataclasses import dataclass

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, candidates
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.score_test import ScoreTest


@dataclass(frozen=True)
class InformationCriterion:
    """chi2 + Σ_j ln(n / g_j) + 2 ln C(P, k) for k effects of P candidates; less is better.

    chi2 is -2 log of the profile likelihood; n: number of independent samples (`samples`); g_j: number of
    groups of runs that have a parameter j of their own, so that n / g_j samples are about it; P:
    `candidates`. That is the extended BIC with gamma = 1 (Chen and Chen, Extended Bayesian information
    criteria for model selection with large model spaces, Biometrika 95, 2008). A parameter with a Gaussian
    prior of standard deviation s is charged ln(1 + (s / `posterior_sd`)^2) in place of ln n, twice the log
    Occam factor of its marginal likelihood. Adding an effect and dropping it compare the same two numbers.
    """

    samples: float
    candidates: int

    def __call__(self, made: Fit) -> float:
        """Of a fit."""
        return made.chi2 + self.charge(made.hypothesis)

    def charge(self, hypothesis: Hypothesis) -> float:
        """What is added to chi2 for the parameters and for the choice of the effects."""
        chosen = min(len(hypothesis.instances), self.candidates)
        choices = 2.0 * math.log(math.comb(self.candidates, chosen))
        return choices + sum(self._parameters(instance) for instance in hypothesis.instances)

    def expected(self, test: ScoreTest) -> float:
        """Of the fit that a score test promises."""
        return test.expected_chi2 + self.charge(test.hypothesis)

    def required_gain(self, hypothesis: Hypothesis, instance: EffectInstance) -> float:
        """Fall of chi2 from which an effect is added to a hypothesis, and below which it is dropped."""
        return self.charge(hypothesis.with_instance(instance)) - self.charge(hypothesis)

    def _parameters(self, instance: EffectInstance) -> float:
        free = math.log(max(self.samples / instance.count, 1.0))
        return sum(
            free if spec.prior is None else math.log1p((spec.prior / options().posterior_sd) ** 2)
            for spec in instance.specs
        )


def information_criterion(run_set: RunSet, samples: float) -> InformationCriterion:
    """For runs with so many independent samples and the candidates of their boat."""
    duration = float(run_set.lengths.max() * run_set.dt)
    every = candidates(run_set.boat, duration, run_set.groups)
    return InformationCriterion(samples, len(every))

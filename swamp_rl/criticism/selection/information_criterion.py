"""Information criterion of a fit: chi2 plus a penalty for its complexity."""

from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis

MIN_GAIN = 8.0  # of the criterion, for one more effect


def complexity(hypothesis: Hypothesis) -> float:
    """Penalty of a hypothesis, in chi2: for the choice among about sixty candidates and for its
    parameters.

    The choice costs 2 ln 60 = 8.2, a parameter about half the logarithm of the number of samples (Schwarz);
    the hull's derivatives have a prior and are not chosen.
    """
    return sum(24.0 if a.effect.nuisance else 10.0 + 4.0 * a.size for a in hypothesis.instances)


def criterion(made: Fit) -> float:
    """chi2 + complexity; less is better."""
    return made.chi2 + complexity(made.hypothesis)


def required_gain(instance: EffectInstance) -> float:
    """Fall of chi2 from which an effect is added."""
    return complexity(Hypothesis((instance,))) + MIN_GAIN

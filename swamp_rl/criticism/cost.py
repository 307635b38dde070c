"""What a hypothesis must earn before it is believed."""

from swamp_rl.criticism.candidates import NUISANCE, Atom, Hypothesis
from swamp_rl.criticism.fit import Fit

WORTH = 8.0  # of penalised chi2 that one more cause must gain


def cost(hypothesis: Hypothesis) -> float:
    """Chi2 that a hypothesis must earn: for choosing among some sixty candidates and for its numbers.

    Choosing costs 2 ln 60 = 8.2, a number about half the logarithm of the samples (Schwarz); the hull's five
    have a prior of their own and are not chosen.
    """
    return sum(24.0 if a.effect.name == NUISANCE else 10.0 + 4.0 * a.size for a in hypothesis.atoms)


def score(made: Fit) -> float:
    """Chi2 and cost, less is better."""
    return made.chi2 + cost(made.hypothesis)


def needed(atom: Atom) -> float:
    """Fall of chi2 that makes an atom worth adding."""
    return cost(Hypothesis((atom,))) + WORTH

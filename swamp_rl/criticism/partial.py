"""Causes among errors of the model that no cause explains: added one by one while runs that had no part in
the fit are predicted better for it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import NUISANCE, Atom, Hypothesis
from swamp_rl.criticism.conclude import MOST_RIVALS, Search, nested, without
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import Fit, fit
from swamp_rl.criticism.heldout import Confirmation, confirmation, saturated_loss
from swamp_rl.criticism.imperfect import Level, levelled
from swamp_rl.criticism.ladder import Ladder
from swamp_rl.criticism.score import Prospect, prospects
from swamp_rl.criticism.search import SEEN

Array = NDArray[np.float64]

MOST = 3  # causes together
SHORTLIST = 8  # that are fitted beside what was found so far
SWAPS = 3  # of the first ones, those tried in the place of each cause in the end
GLANCE = 8000  # samples that are enough to see what is promising
STEPS = 6  # Jacobians of a fit that begins near its end


def found_despite(
    trials: Trials, weight: Array, atoms: Sequence[Atom], hull: Atom | None
) -> tuple[Trials, Ladder, Search] | None:
    """The trials with the model's errors as they were told, a ladder of one rung, and the causes that stand
    out from those errors with those that would do as well; None where none does.
    """
    every = [*atoms, *([hull] if hull else [])]
    plain = levelled(trials, weight, Hypothesis(), np.zeros(0))
    ladder = one_rung(plain)
    best, first, singles = _grown(ladder, plain.fit, every)
    if not best.hypothesis.atoms:
        return None
    singles = sorted(singles, key=lambda one: _judged(ladder, one))
    best, others = _swapped(ladder, best, singles)
    unseen = [one.atom.label for one in first if one.seen < SEEN]
    best, confirmed = _confirmed(ladder, best, len(every))
    if not best.hypothesis.atoms:
        return None
    rivals = alike(ladder, best, [*singles, *others])
    tried = [*singles, *others, best]
    return plain.trials, ladder, Search(best, False, 0, rivals, tried, first, unseen, confirmed)


def one_rung(level: Level) -> Ladder:
    """A ladder whose every rung is the level's comparison, its fit known."""
    ladder = Ladder([level.problem] * 3, [level.problem.guess()] * 3)
    for rung in range(3):
        ladder.fits[rung, level.fit.hypothesis.label] = level.fit
    return ladder


def _judged(ladder: Ladder, one: Fit) -> float:
    return float(saturated_loss(ladder.problems[0], one).sum())


def _grown(ladder: Ladder, at: Fit, atoms: Sequence[Atom]) -> tuple[Fit, list[Prospect], list[Fit]]:
    """From nothing, the cause added each time that predicts best what it was not fitted to, while that is no
    chance; the first prospects, and the fits of single causes.
    """
    problem = ladder.problems[0]
    first: list[Prospect] = []
    singles: list[Fit] = []
    for _ in range(MOST):
        ahead = _glance(ladder, at, atoms)
        first = first or ahead
        likely = [one for one in ahead if one.seen >= SEEN][:SHORTLIST]
        made = [ladder.fit(0, one.hypothesis, one.x, at.states) for one in likely]
        singles = singles or made
        sure = [one for one in made if confirmation(problem, one, at, len(atoms)).holds]
        if not sure:
            break
        at = _simplest(ladder, min(sure, key=lambda one: _judged(ladder, one)), sure)
    return at, first, singles


def _simplest(ladder: Ladder, best: Fit, sure: Sequence[Fit]) -> Fit:
    """The best, or a special case of it that is no worse than chance allows."""
    for one in sure:
        less = one.hypothesis.size < best.hypothesis.size and nested(one.hypothesis, best.hypothesis)
        if less and not confirmation(ladder.problems[0], best, one, 1).holds:
            return one
    return best


def _glance(ladder: Ladder, at: Fit, atoms: Sequence[Atom]) -> list[Prospect]:
    """Prospects beside a fit, from some of the windows where there are many."""
    problem = ladder.problems[0]
    every = max(1, problem.samples // (problem.weight.shape[2] * GLANCE))
    chosen = np.arange(problem.windows.count) % every == 0
    part = problem.part(chosen)
    return prospects(part, fit(part, at.hypothesis, at.x, at.states[chosen], 1), atoms)


def _swapped(ladder: Ladder, best: Fit, singles: Sequence[Fit]) -> tuple[Fit, list[Fit]]:
    """The best after each of its causes was tried against the best single ones, and those tries."""
    tried = []
    for atom in best.hypothesis.atoms:
        if atom.effect.name == NUISANCE:
            continue
        for other in [one for one in singles if _is_other(one.hypothesis, best.hypothesis, atom)][:SWAPS]:
            numbers = {a.label: own for a, own in best.hypothesis.parts(best.x)}
            numbers[other.hypothesis.label] = other.x
            swapped = best.hypothesis.without(atom.label).with_atom(other.hypothesis.atoms[0])
            start = np.concatenate([numbers[a.label] for a in swapped.atoms])
            tried.append(ladder.fit(0, swapped, start, best.states))
    better = min([best, *tried], key=lambda one: _judged(ladder, one))
    return better, [one for one in [best, *tried] if one is not better]


def _is_other(single: Hypothesis, best: Hypothesis, atom: Atom) -> bool:
    """Whether a single cause is another explanation than an atom of the best."""
    own = single.atoms[0]
    special = nested(Hypothesis((atom,)), single) or nested(single, Hypothesis((atom,)))
    return own.effect.name != NUISANCE and own not in best.atoms and not special


def _confirmed(ladder: Ladder, best: Fit, chances: int) -> tuple[Fit, dict[str, Confirmation]]:
    """The best less the causes that held-out windows do not confirm, the least confirmed first."""
    while True:
        found = {}
        for atom in best.hypothesis.atoms:
            less = without(ladder, best, atom.label, 0)
            found[atom.label] = confirmation(ladder.problems[0], best, less, chances)
        if all(one.holds for one in found.values()):
            return best, found
        best = without(ladder, best, min(found, key=lambda label: found[label].low), 0)


def alike(ladder: Ladder, winner: Fit, others: Sequence[Fit]) -> list[Fit]:
    """Of as many causes as the winner has, those that predict held-out windows no worse than chance allows,
    the best first.
    """
    problem = ladder.problems[0]
    kept: dict[str, Fit] = {}
    for one in sorted(others, key=lambda one: _judged(ladder, one)):
        name = one.hypothesis.accused
        same = len(one.hypothesis.atoms) == len(winner.hypothesis.atoms)
        if not same or name in kept or name == winner.hypothesis.accused:
            continue
        if nested(winner.hypothesis, one.hypothesis) or confirmation(problem, winner, one, SHORTLIST).holds:
            continue
        kept[name] = one
    return list(kept.values())[:MOST_RIVALS]

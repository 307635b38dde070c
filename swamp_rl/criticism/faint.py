"""Causes too small for short windows: what acts for a whole run adds up over it, if its start is shared."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.adequacy import adequacy
from swamp_rl.criticism.candidates import FAILURE, WAVES, Atom, by_label
from swamp_rl.criticism.conclude import LOOKS, RUNAWAY, climb, without
from swamp_rl.criticism.cost import WORTH, cost, needed, score
from swamp_rl.criticism.fit import Fit
from swamp_rl.criticism.heldout import confirmation_by_stretches
from swamp_rl.criticism.ladder import LAST, MIDDLE, UNBROKEN, Ladder, whole_runs
from swamp_rl.criticism.score import Prospect, beside_nothing, prospects

Array = NDArray[np.float64]

SHORTLIST = 5  # candidates that are fitted for each cause
CLOSE = 40.0  # of it, within which two are compared on longer windows


@dataclass(frozen=True)
class Faint:
    """best: on the middle windows, with what long ones add; tried: on the shortest, what else may explain
    it.
    """

    best: Fit
    tried: list[Fit]


def with_faint(ladder: Ladder, best: Fit, atoms: Sequence[Atom], most: int) -> Faint:
    """The best with causes that only unbroken runs show, one after another up to `most` atoms, and what may
    stand in the place of a cause that short windows hardly show.
    """
    problem = ladder.problems[UNBROKEN]
    at = ladder.fit(UNBROKEN, best.hypothesis, best.x)
    several = len(np.unique(problem.windows.run)) > 1
    if not several or at.chi2 > RUNAWAY * problem.samples:
        return Faint(best, [])
    if adequacy(ladder.problems[MIDDLE], best).adequate:
        atoms = [atom for atom in atoms if atom.effect.name != WAVES]  # which would have been seen there
    more = _grown(ladder, at, atoms, most)
    if more.hypothesis != at.hypothesis:
        added = climb(ladder, more.hypothesis, more.x)
        whole = whole_runs(ladder, more.hypothesis, more.x)
        if adequacy(ladder.problems[LAST], whole).adequate:
            best, at = added, more
    every = [at, *_instead(ladder, at, atoms)]
    return Faint(best, [ladder.fit(0, one.hypothesis, one.x) for one in every if one.hypothesis.atoms])


def _grown(ladder: Ladder, at: Fit, atoms: Sequence[Atom], most: int) -> Fit:
    """A fit to unbroken runs with further causes, each confirmed on runs held out."""
    problem, chances = ladder.problems[UNBROKEN], LOOKS * len(atoms)
    while len(at.hypothesis.atoms) < most:
        ahead = _ahead(ladder, at, atoms)
        if not ahead:
            break
        less = without(ladder, _fitted(ladder, at, atoms, ahead[:1])[0], ahead[0].atom.label, UNBROKEN)
        if less.chi2 < at.chi2 - WORTH:  # which had ended too early
            at = less
            continue
        best = _fitted(ladder, at, atoms, ahead)[0]
        kept = confirmation_by_stretches(problem, best, at, chances)
        if score(best) > score(at) - WORTH or not kept.holds:
            break
        at = best
    return at


def _instead(ladder: Ladder, at: Fit, atoms: Sequence[Atom]) -> list[Fit]:
    """Fits to unbroken runs with another cause in the place of one that the shortest windows hardly show, and
    so cannot choose, where they explain nearly as much.
    """
    found: list[Fit] = []
    short = ladder.fit(0, at.hypothesis, at.x)
    for atom in at.hypothesis.atoms:
        if score(without(ladder, short, atom.label, 0)) > score(short) + CLOSE:
            continue
        less = without(ladder, at, atom.label, UNBROKEN)
        others = [one for one in atoms if one.label != atom.label]
        fitted = _fitted(ladder, less, others, _ahead(ladder, less, others))
        found += [one for one in fitted if score(one) < score(at) + CLOSE]
    return found


def is_small(atom: Atom) -> bool:
    """Whether it has a size that may be small; a failure has but an instant, which short windows show."""
    return atom.size > 0 and atom.effect.name != FAILURE


def _ahead(ladder: Ladder, at: Fit, atoms: Sequence[Atom]) -> list[Prospect]:
    """The most promising with one atom more on unbroken runs, in order."""
    problem = ladder.problems[UNBROKEN]
    begun = [a if a.effect.name == WAVES else beside_nothing(a, problem.boat) for a in atoms if is_small(a)]
    ahead = [one for one in prospects(problem, at, begun) if at.chi2 - one.promised > needed(one.atom)]
    return sorted(ahead, key=lambda one: one.promised + cost(one.hypothesis))[:SHORTLIST]


def _fitted(ladder: Ladder, at: Fit, atoms: Sequence[Atom], ahead: Sequence[Prospect]) -> list[Fit]:
    """Fits to unbroken runs of what promises most, best first."""
    known = by_label(atoms)
    made = [
        ladder.fit(UNBROKEN, at.hypothesis.with_atom(known[one.atom.label]), one.x, at.states)
        for one in ahead
    ]
    return sorted(made, key=score)

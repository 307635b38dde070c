"""The simplest set of causes that leaves only noise: a beam search up a ladder of complexity."""

import time
from collections.abc import Sequence

import numpy as np

from swamp_rl.criticism.adequacy import adequacy
from swamp_rl.criticism.candidates import Atom, Hypothesis
from swamp_rl.criticism.conclude import Search, climb, concluded
from swamp_rl.criticism.cost import cost as cost_of
from swamp_rl.criticism.cost import needed, score
from swamp_rl.criticism.fit import Fit, fit
from swamp_rl.criticism.ladder import Ladder
from swamp_rl.criticism.score import Prospect, prospects

PATIENCE = 35.0  # s of the processor's time after which no further depth is begun
MOST = 3  # atoms together, the hull's coefficients counted as one
BEAM = 5  # sets of causes that a further one is sought beside
SHORTLIST = 8  # sets that are fitted at each depth
FIRST = 3  # of them, those fitted before any other
CLIMBERS = 4  # of them, those that are followed to longer windows
SEEN = 10.0  # least information about a candidate, in squared typical sizes over variance
HOPE = 0.2  # share of the best one's gain by which another may stay behind and still be followed


def search(ladder: Ladder, atoms: Sequence[Atom], hull: Atom | None) -> Search:
    """Climb from nothing to `MOST` atoms, until what is left is noise and nothing more is to be gained."""
    every = [*atoms, *([hull] if hull else [])]
    nothing = climb(ladder, Hypothesis(), np.zeros(0))
    first = prospects(ladder.problems[0], ladder.fit(0, Hypothesis(), np.zeros(0)), every)
    unseen = [one.atom.label for one in first if one.seen < SEEN]
    every = [atom for atom in every if atom.label not in unseen]
    tried: dict[str, Fit] = {}
    best = nothing
    beam = [ladder.fit(0, Hypothesis(), np.zeros(0))]
    began = time.thread_time()
    for depth in range(MOST):
        if time.thread_time() - began > PATIENCE or _is_enough(ladder, best, every):
            break
        fitted = _extend(ladder, beam, every, first if depth == 0 else None)
        if not fitted:
            break
        tried |= {one.hypothesis.label: one for one in fitted}
        limit = score(fitted[0]) + 200.0 + HOPE * (beam[0].chi2 - fitted[0].chi2)
        beam = [one for one in fitted[:BEAM] if score(one) < limit]
        climbed = sorted(
            (climb(ladder, one.hypothesis, one.x) for one in _climbers(ladder, fitted)), key=score
        )
        if score(climbed[0]) < score(best):
            best = climbed[0]
    return concluded(ladder, best, list(tried.values()), first, unseen, every)


def _climbers(ladder: Ladder, fitted: list[Fit]) -> list[Fit]:
    best = score(fitted[0])
    room = 100.0 if adequacy(ladder.problems[0], fitted[0]).adequate else 0.5 * best + 100.0
    return [one for one in fitted[:CLIMBERS] if score(one) < best + room]


def _is_enough(ladder: Ladder, at: Fit, atoms: Sequence[Atom]) -> bool:
    """Whether only noise is left on the middle windows and no further atom promises anything."""
    if not adequacy(ladder.problems[1], at).adequate:
        return False
    here = ladder.fit(1, at.hypothesis, at.x)
    return not any(
        here.chi2 - one.promised > needed(one.atom) and _holds(ladder, one, here)
        for one in prospects(ladder.problems[1], here, atoms)
    )


def _holds(ladder: Ladder, prospect: Prospect, here: Fit) -> bool:
    """Whether a promise is kept by a true fit from there."""
    made = fit(ladder.problems[1], prospect.hypothesis, prospect.x, here.states, 4)
    return here.chi2 - made.chi2 > needed(prospect.atom)


def _extend(
    ladder: Ladder, beam: list[Fit], atoms: Sequence[Atom], known: list[Prospect] | None
) -> list[Fit]:
    """Fits, on the shortest windows, of the most promising sets with one atom more, best first.

    Those that promise far less than the first few keep are not fitted at all.
    """
    found: dict[str, Prospect] = {}
    for at in beam:
        ahead = known if known is not None else prospects(ladder.problems[0], at, atoms)
        for one in ahead:
            label = one.hypothesis.label
            if one.seen >= SEEN and (label not in found or one.promised < found[label].promised):
                found[label] = one
    chosen = sorted(found.values(), key=lambda one: one.promised + cost_of(one.hypothesis))[:SHORTLIST]
    fitted = [ladder.fit(0, one.hypothesis, one.x, one.states) for one in chosen[:FIRST]]
    best = min(fitted, key=score, default=None)
    limit = np.inf
    if best is not None:
        share = HOPE if adequacy(ladder.problems[0], best).adequate else 2 * HOPE
        limit = score(best) + 300.0 + share * max(at.chi2 - best.chi2 for at in beam)
    for one in chosen[FIRST:]:
        if one.promised + cost_of(one.hypothesis) < limit:
            fitted.append(ladder.fit(0, one.hypothesis, one.x, one.states))
    return sorted(fitted, key=score)

"""The simplest set of causes that leaves only noise: a beam search up a ladder of complexity."""

from collections.abc import Callable, Sequence

import numpy as np

from swamp_rl.criticism.adequacy import adequacy, near
from swamp_rl.criticism.candidates import Atom, Hypothesis
from swamp_rl.criticism.conclude import Search, adequate_rung, climb, concluded
from swamp_rl.criticism.cost import cost as cost_of
from swamp_rl.criticism.cost import needed, score
from swamp_rl.criticism.faint import with_faint
from swamp_rl.criticism.fit import Fit, fit
from swamp_rl.criticism.ladder import Ladder
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.score import Prospect, prospects
from swamp_rl.criticism.shooting import Shooting

PATIENCE = 1.5e7  # steps of a boat, some twenty seconds
MOST = 3  # atoms together, the hull's coefficients counted as one
BEAM = 5  # sets of causes that a further one is sought beside
SHORTLIST = 8  # sets that are fitted at each depth
FIRST = 3  # of them, those fitted in any case, unless one leaves nothing but noise
CLIMBERS = 4  # of them, those that are followed to longer windows
SEEN = 10.0  # least information about a candidate, in squared typical sizes over variance
HOPE = 0.2  # share of the best one's gain by which another may stay behind and still be followed


def search(
    ladder: Ladder,
    atoms: Sequence[Atom],
    hull: Atom | None,
    patience: float = PATIENCE,
    misread: Callable[[Ladder, Fit], object] | None = None,
    before: Sequence[Fit] = (),
) -> Search:
    """Climb from nothing to `MOST` atoms, until what is left is noise and nothing more is to be gained.

    patience: steps of a boat rolled out after which no further depth is begun; misread: whether the best of
    the first depth wants no further atom, but that the commands are read otherwise; before: what a search
    under other noise ended with, on the shortest windows and the middle ones, which is tried too.
    """
    every = [*atoms, *([hull] if hull else [])]
    best = climb(ladder, Hypothesis(), np.zeros(0))
    if before:
        best = min(best, _again(ladder, before), key=score)
    rung = adequate_rung(ladder, best) if not best.hypothesis.atoms else None
    first = prospects(ladder.problems[rung or 0], ladder.fit(rung or 0, Hypothesis(), np.zeros(0)), every)
    if rung is not None and not _promising(ladder, rung, best, first):
        faint = with_faint(ladder, best, _seen(every, first), MOST)
        return concluded(ladder, faint.best, faint.tried, first, _unseen(first), every)
    if rung is not None:
        first = prospects(ladder.problems[0], ladder.fit(0, Hypothesis(), np.zeros(0)), every)
    unseen = _unseen(first)
    every = _seen(every, first)
    tried: dict[str, Fit] = {}
    if best.hypothesis.atoms:
        tried[best.hypothesis.label] = ladder.fit(0, best.hypothesis, best.x)
    beam = [ladder.fit(0, Hypothesis(), np.zeros(0))]
    for depth in range(MOST):
        LOG.info("hypotheses of %d effect%s", depth + 1, "s" * (depth > 0))
        if ladder.rolled > patience or (depth > 0 and _is_enough(ladder, best, every)):
            break
        if depth == 1 and misread is not None and misread(ladder, best) is not None:
            break
        fitted = _extend(
            ladder, beam, every, first if depth == 0 else None, patience if depth == MOST - 1 else np.inf
        )
        if not fitted:
            break
        tried |= {one.hypothesis.label: one for one in fitted}
        limit = score(fitted[0]) + 200.0 + HOPE * (beam[0].chi2 - fitted[0].chi2)
        beam = [one for one in fitted[:BEAM] if score(one) < limit]
        hopeful = [one for one in _climbers(ladder, fitted) if near(ladder.problems[0], one)]
        for one in hopeful:
            best = min(best, climb(ladder, one.hypothesis, one.x), key=score)
    if tried and adequate_rung(ladder, best) is None:
        closest = min(tried.values(), key=score)
        best = min(best, climb(ladder, closest.hypothesis, closest.x), key=score)
    if near(ladder.problems[1], best):
        faint = with_faint(ladder, best, every, MOST)
        best = faint.best
        tried |= {one.hypothesis.label: one for one in faint.tried}
    return concluded(ladder, best, list(tried.values()), first, unseen, every)


def _seen(atoms: Sequence[Atom], ahead: Sequence[Prospect]) -> list[Atom]:
    """Those that the data can show."""
    unseen = _unseen(ahead)
    return [atom for atom in atoms if atom.label not in unseen]


def _again(ladder: Ladder, before: Sequence[Fit]) -> Fit:
    """The fit to the middle windows, each rung begun from where it ended under other noise."""
    for rung, one in enumerate(before):
        if len(one.states) == ladder.problems[rung].windows.count:
            made = fit(ladder.problems[rung], one.hypothesis, one.x, one.states)
            ladder.fits[rung, one.hypothesis.label] = made
    return climb(ladder, before[0].hypothesis, before[0].x)


def _climbers(ladder: Ladder, fitted: list[Fit]) -> list[Fit]:
    best = score(fitted[0])
    room = 100.0 if adequacy(ladder.problems[0], fitted[0]).adequate else 0.5 * best + 100.0
    return [one for one in fitted[:CLIMBERS] if score(one) < best + room]


def _is_enough(ladder: Ladder, at: Fit, atoms: Sequence[Atom]) -> bool:
    """Whether only noise is left on longer windows and no further atom promises anything there."""
    rung = adequate_rung(ladder, at)
    if rung is None:
        return False
    here = ladder.fit(rung, at.hypothesis, at.x)
    return not _promising(ladder, rung, here, prospects(ladder.problems[rung], here, atoms))


def _unseen(ahead: Sequence[Prospect]) -> list[str]:
    """Labels of those that the data cannot show."""
    return [one.atom.label for one in ahead if one.seen < SEEN]


def _promising(ladder: Ladder, rung: int, at: Fit, ahead: Sequence[Prospect]) -> bool:
    """Whether an atom beside the hypothesis promises more than it costs, and keeps that when fitted."""
    here = ladder.fit(rung, at.hypothesis, at.x)
    return any(
        here.chi2 - one.promised > needed(one.atom) and _holds(ladder.problems[rung], one, here)
        for one in ahead
    )


def _holds(problem: Shooting, prospect: Prospect, here: Fit) -> bool:
    """Whether a promise is kept by a true fit from there."""
    made = fit(problem, prospect.hypothesis, prospect.x, here.states, 4)
    return here.chi2 - made.chi2 > needed(prospect.atom)


def _beside(prospect: Prospect) -> Hypothesis:
    return prospect.hypothesis.without(prospect.atom.label)


def _extend(
    ladder: Ladder, beam: list[Fit], atoms: Sequence[Atom], known: list[Prospect] | None, patience: float
) -> list[Fit]:
    """Fits, on the shortest windows, of the most promising sets with one atom more, best first.

    Those that promise far less than the first few keep are not fitted at all, nor any but those few once
    patience is at its end.
    """
    found: dict[str, Prospect] = {}
    for at in beam:
        ahead = known if known is not None else prospects(ladder.problems[0], at, atoms)
        for one in ahead:
            label = one.hypothesis.label
            if one.seen >= SEEN and (label not in found or one.promised < found[label].promised):
                found[label] = one
    chosen = sorted(found.values(), key=lambda one: one.promised + cost_of(one.hypothesis))[:SHORTLIST]
    fitted: list[Fit] = []
    limit = np.inf
    for number, one in enumerate(chosen):
        if number >= FIRST and ladder.rolled > patience:
            break
        if not fitted or one.promised + cost_of(one.hypothesis) < limit:  # a promise may overflow
            made = ladder.fit(0, one.hypothesis, one.x, one.states)
            before = min(at.chi2 for at in beam if at.hypothesis.label == _beside(one).label)
            fitted.append(ladder.freed(made) if ladder.stuck(made, before, one.promised) else made)
        best = min(fitted, key=score)
        enough = adequacy(ladder.problems[0], best).adequate
        if enough or number + 1 >= FIRST:
            gained = max(at.chi2 - best.chi2 for at in beam)
            limit = score(best) + 300.0 + (1 if enough else 2) * HOPE * gained
    return sorted(fitted, key=score)

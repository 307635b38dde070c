"""From what the search found best to what may be said: on whole runs, without the superfluous, confirmed on
runs held out, with its rivals.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from swamp_rl.criticism.adequacy import adequacy, near
from swamp_rl.criticism.candidates import NUISANCE, NUISANCE_SD, Atom, Hypothesis
from swamp_rl.criticism.cost import score
from swamp_rl.criticism.fit import Fit, fit
from swamp_rl.criticism.heldout import Confirmation, confirmation, confirmation_by_stretches
from swamp_rl.criticism.ladder import LAST, UNBROKEN, Ladder, whole_runs
from swamp_rl.criticism.score import Prospect

GAP = 9.0  # of penalised chi2 within which two names cannot be told apart
NEAR = 40.0  # the same on shorter windows, beyond which longer ones will not bring two together
CLEARLY = 50.0  # of penalised chi2, beyond what longer windows can do to the comparison of two fits
OVERWHELMING = 500.0  # the same, beyond what a fit that has not quite ended can be wrong by
RUNAWAY = 10.0  # chi2 a sample, of whole runs whose model left only noise on shorter windows
FAR = 1.8  # standard deviations of a derivative's prior beyond which it may be more than a nuisance
MOST_RIVALS = 4
LOOKS = 3  # lengths of windows that a cause may be confirmed on


@dataclass(frozen=True)
class Search:
    """What was found: the winner by rung, its rivals on the deepest rung used, and everything that was tried.

    rung: the longest windows on which the winner is adequate, or the middle ones where it is on none.
    first: prospects beside nothing, in order, on the shortest windows; unseen: labels the data cannot show.
    confirmed: of each cause, by its label.
    """

    winner: Fit
    adequate: bool
    rung: int
    rivals: list[Fit]
    tried: list[Fit]
    first: list[Prospect]
    unseen: list[str]
    confirmed: dict[str, Confirmation] = field(default_factory=dict)


def climb(ladder: Ladder, hypothesis: Hypothesis, x: np.ndarray) -> Fit:
    """The fit on the middle rung, by way of the shortest."""
    ladder.fit(0, hypothesis, x)
    return ladder.fit(1, hypothesis, x)


def adequate_rung(ladder: Ladder, at: Fit) -> int | None:
    """The rung on which a fit to the middle windows leaves nothing but noise, None where none does: those
    windows, or whole runs, which alone read a command that changed in a lost row as it fits.
    """
    if adequacy(ladder.problems[1], at).adequate:
        return 1
    if near(ladder.problems[1], at):
        whole = whole_runs(ladder, at.hypothesis, at.x)
        if adequacy(ladder.problems[LAST], whole).adequate:
            return LAST
    return None


def concluded(
    ladder: Ladder,
    best: Fit,
    tried: list[Fit],
    first: list[Prospect],
    unseen: list[str],
    atoms: Sequence[Atom],
) -> Search:
    """What may be said of the best; atoms: all that could have been picked."""
    chances = len(atoms) * (1 + len(best.hypothesis.atoms))
    found = adequate_rung(ladder, best)
    rung, adequate = found or 1, found is not None
    if adequate:
        whole = whole_runs(ladder, best.hypothesis, best.x)
        if adequacy(ladder.problems[LAST], whole).adequate:
            best, rung = whole, LAST
        best = pruned(ladder, best, rung)
    confirmed = confirmations(ladder, best, best.hypothesis.atoms, chances)
    for label, one in confirmed.items():
        if adequate and not one.holds:
            less = without(ladder, best, label, rung)
            if adequacy(ladder.problems[rung], less).adequate:
                best = less
            else:
                adequate = False
    kept = {atom.label for atom in best.hypothesis.atoms}
    confirmed = {label: one for label, one in confirmed.items() if label in kept}
    rivals: list[Fit] = []
    if adequate:
        best, rivals, rung, confirmed = _best_of_all(ladder, best, tried, atoms, rung, confirmed)
    return Search(best, adequate, rung, rivals, tried, first, unseen, confirmed)


def _best_of_all(
    ladder: Ladder,
    sure: Fit,
    tried: Sequence[Fit],
    atoms: Sequence[Atom],
    rung: int,
    confirmed: dict[str, Confirmation],
) -> tuple[Fit, list[Fit], int, dict[str, Confirmation]]:
    """The best of all that was tried, its rivals, their rung and what confirms the causes: the best so far
    where no held-out run confirms what would take its place, that being another explanation at most.
    """
    special = beside_nuisance(ladder, sure, atoms)
    best, rivals, deepest = compared(ladder, sure, [*tried, *special], rung)
    best = plainest(ladder, best, atoms, deepest)
    put = [atom for atom in best.hypothesis.atoms if atom.label not in confirmed]
    told = confirmations(ladder, best, put, len(atoms) * (1 + len(best.hypothesis.atoms)))
    if not all(one.holds for one in told.values()):
        rivals = [best] if sure.hypothesis.atoms else []
        best, deepest, told = sure, rung, {}
    rivals = [
        one
        for one in rivals
        if not nested(best.hypothesis, one.hypothesis)
        or any(one.hypothesis.label == other.hypothesis.label for other in special)
    ]
    return best, rivals[:MOST_RIVALS], deepest, confirmed | told


def without_unconfirmed(ladder: Ladder, found: Search, atoms: Sequence[Atom]) -> Search:
    """A search that something is left over from, less the causes that no held-out run confirms, the least
    confirmed first: where the model is wrong, one that merely bends to what is missing fits too.
    """
    best, confirmed = found.winner, found.confirmed
    while not all(one.holds for one in confirmed.values()):
        worst = min(confirmed, key=lambda label: confirmed[label].low)
        best = without(ladder, best, worst, found.rung)
        chances = len(atoms) * (1 + len(best.hypothesis.atoms))
        confirmed = confirmations(ladder, best, best.hypothesis.atoms, chances)
    return replace(found, winner=best, confirmed=confirmed)


def without(ladder: Ladder, best: Fit, label: str, rung: int) -> Fit:
    """The best less one atom, fitted on a rung from where the best is."""
    less = best.hypothesis.without(label)
    known = ladder.fits.get((rung, less.label))
    if known is not None and not less.atoms:
        return known
    x = np.concatenate([np.zeros(0), *(own for a, own in best.hypothesis.parts(best.x) if a.label != label)])
    if known is not None and known.chi2 > best.chi2 + OVERWHELMING:
        glance = fit(ladder.problems[rung], less, x, best.states, 2)  # for the known one may have been stuck
        if glance.chi2 > best.chi2 + OVERWHELMING:
            return known
    made = fit(ladder.problems[rung], less, x, best.states, 8, fresh=True)
    if known is None or made.chi2 < known.chi2:
        ladder.fits[(rung, less.label)] = made
    return ladder.fits[(rung, less.label)]


def pruned(ladder: Ladder, best: Fit, rung: int) -> Fit:
    """The best less the atoms that do not earn their cost."""
    for atom in best.hypothesis.atoms:
        if indispensable(ladder, best, atom.label, rung):
            continue
        less = without(ladder, best, atom.label, rung)
        if score(less) <= score(best):
            return pruned(ladder, less, rung)
    return best


def indispensable(ladder: Ladder, best: Fit, label: str, rung: int) -> bool:
    """Whether even shorter windows, which forgive more, miss an atom by far: a bound that saves the fit to
    longer ones.
    """
    for shorter in range(rung):
        whole = ladder.fit(shorter, best.hypothesis, best.x)
        if score(without(ladder, whole, label, shorter)) > score(best) + CLEARLY:
            return True
    return False


def confirmations(ladder: Ladder, best: Fit, causes: Sequence[Atom], chances: int) -> dict[str, Confirmation]:
    """Of some causes of the best: whether runs that its numbers were not fitted to gain by them."""
    found: dict[str, Confirmation] = {}
    for atom in causes:
        if atom.effect.name == NUISANCE and len(best.hypothesis.atoms) > 1:
            continue
        for rung in (0, 1, UNBROKEN):  # shorter windows are more, and cheaper; longer ones see more
            whole = ladder.fit(rung, best.hypothesis, best.x)
            less = without(ladder, whole, atom.label, rung)
            judged = confirmation_by_stretches if rung == UNBROKEN else confirmation
            one = judged(ladder.problems[rung], whole, less, LOOKS * chances)
            if atom.label not in found or one.low > found[atom.label].low:
                found[atom.label] = one
            if one.holds:
                break
    return found


def plainest(ladder: Ladder, best: Fit, atoms: Sequence[Atom], rung: int) -> Fit:
    """The best with special cases in the place of atoms whose further numbers matter little to the score and
    are confirmed by no held-out run, where nothing but noise is left without them too.
    """
    for atom in best.hypothesis.atoms:
        for special in atoms:
            fields = {parameter.field for parameter in special.effect.parameters}
            if special == atom or not nested(Hypothesis((special,)), Hypothesis((atom,))) or not fields:
                continue
            plain = _with_special(ladder, best, atom, special, rung)
            if score(plain) > score(best) + NEAR or not adequacy(ladder.problems[rung], plain).adequate:
                continue
            general = [ladder.fit(short, best.hypothesis, best.x) for short in (0, 1)]
            less = [_with_special(ladder, one, atom, special, short) for short, one in enumerate(general)]
            held = (confirmation(ladder.problems[i], general[i], less[i], 2 * len(atoms)) for i in (0, 1))
            if not any(one.holds for one in held):
                return plainest(ladder, plain, atoms, rung)
    return best


def _with_special(ladder: Ladder, best: Fit, atom: Atom, special: Atom, rung: int) -> Fit:
    """The best with one atom's special case in its place, begun from where the best is."""
    numbers = {p.field: x for p, x in zip(atom.effect.parameters, _own(best, atom), strict=True)}
    own = {a.label: x for a, x in best.hypothesis.parts(best.x)}
    own[special.label] = np.array([numbers[p.field] for p in special.effect.parameters])
    less = best.hypothesis.without(atom.label).with_atom(special)
    return ladder.fit(rung, less, np.concatenate([own[one.label] for one in less.atoms]), best.states)


def _own(best: Fit, atom: Atom) -> np.ndarray:
    return next(x for a, x in best.hypothesis.parts(best.x) if a.label == atom.label)


def beside_nuisance(ladder: Ladder, best: Fit, atoms: Sequence[Atom]) -> list[Fit]:
    """The best with a cause that moves the same number as one of the hull's derivatives, where that
    derivative is farther from the file than a nuisance should be.
    """
    nuisance = {a.effect.name: (a, own) for a, own in best.hypothesis.parts(best.x)}.get(NUISANCE)
    if nuisance is None:
        return []
    far = {
        parameter.field
        for parameter, value in zip(nuisance[0].effect.parameters, nuisance[1], strict=True)
        if abs(value - 1.0) > FAR * NUISANCE_SD
    }
    found = []
    for atom in atoms:
        moves = {parameter.field for parameter in atom.effect.parameters}
        if atom.effect.name != NUISANCE and moves & far and atom not in best.hypothesis.atoms:
            more = best.hypothesis.with_atom(atom)
            values = {a.label: own for a, own in best.hypothesis.parts(best.x)}
            values[atom.label] = np.array(atom.starts[0])
            start = np.concatenate([values[one.label] for one in more.atoms])
            states = ladder.fit(0, best.hypothesis, best.x).states
            found.append(ladder.fit(0, more, start, states))
    return found


def nested(small: Hypothesis, large: Hypothesis) -> bool:
    """Whether `large` is `small` with numbers to spare, which fits as well but is no other explanation."""

    def holds(atom: Atom) -> bool:
        """Whether an atom, or one that moves the same numbers and more, is in `large`."""
        fields = {parameter.field for parameter in atom.effect.parameters}
        return any(
            one.label == atom.label
            or (
                fields
                and fields < {p.field for p in one.effect.parameters}
                and one.selectors == atom.selectors
            )
            for one in large.atoms
        )

    return all(holds(atom) for atom in small.atoms)


def compared(ladder: Ladder, best: Fit, tried: Sequence[Fit], rung: int) -> tuple[Fit, list[Fit], int]:
    """The best of all that was tried and its rivals on one rung, each only on shorter windows before; and
    that rung. Where whole runs of one that is near ran away, as a boat does that keeps no course by itself,
    they tell nothing of it, and all are compared on the middle windows.
    """
    near = score(ladder.fit(1, best.hypothesis, best.x)) + NEAR
    here = score(ladder.fit(0, best.hypothesis, best.x)) + NEAR
    every = [best]
    for one in tried:
        if one.hypothesis.label == best.hypothesis.label or score(one) > here:
            continue
        if score(climb(ladder, one.hypothesis, one.x)) <= near:
            every.append(ladder.fit(rung, one.hypothesis, one.x))
    if rung > 1 and any(one.chi2 > RUNAWAY * ladder.problems[rung].samples for one in every):
        rung = 1
        every = [ladder.fit(rung, one.hypothesis, one.x) for one in every]
    every.sort(key=score)
    close = [one for one in every[1:] if score(one) < score(every[0]) + GAP]
    apart = {one.hypothesis.accused: one for one in reversed(close)}
    apart.pop(every[0].hypothesis.accused, None)
    return every[0], sorted(apart.values(), key=score), rung

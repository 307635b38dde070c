"""Search under white noise; where that leaves something, again under errors that wander as what was left."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Atom, Hypothesis
from swamp_rl.criticism.conclude import LAST, Search, climb, without_unconfirmed
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import Fit, fit
from swamp_rl.criticism.ladder import Ladder, ladder_of, whole_runs
from swamp_rl.criticism.partial import found_despite
from swamp_rl.criticism.readings import MIDDLE, as_well, better_reading, gained, misread, without_timing
from swamp_rl.criticism.search import PATIENCE, search
from swamp_rl.criticism.shooting import Shooting
from swamp_rl.criticism.slow import slow_errors

Array = NDArray[np.float64]

POSITIONS = slice(0, 2)
OTHERS = slice(2, 6)
FAR_ABOVE = 3.0  # chi2 a sample that is left from which on the model's own errors are what limits the data
ROUNDS = 3  # times that the wandering is told anew, beside a fit that knows of it
PATIENCE_AGAIN = 5e6  # steps of a boat that each later search may take
PATIENCE_SUSPECTED = 8e6  # that the first one may take where positions seem to wander whatever is wrong
TOGETHER = 2e7  # steps that all searches may take before none is made again
READINGS = 2  # times that the commands are read anew
STEPS = 6  # Jacobians that such a fit may take


def searched(
    trials: Trials, weight: Array, atoms: Sequence[Atom], hull: Atom | None
) -> tuple[Trials, Ladder, Search]:
    """The trials with their noise as it was told, the ladder and what was found.

    Positions alone may wander because of the sensor; what wanders in other channels too is the model's error:
    it widens all comparisons and standard errors, but what is found then is never all.
    """
    spent: list[Ladder] = []
    trials, ladder, found = _read_as_obeyed(trials, weight, atoms, hull, spent, PATIENCE)
    if found.adequate:
        return trials, ladder, found
    result = trials, ladder, found
    sensor, every = wandering(ladder, found.winner)
    if not sensor and found.winner.hypothesis.atoms:  # what was found may have bent to the wandering
        sensor, beside_nothing = wandering(ladder, ladder.fit(MIDDLE, Hypothesis(), np.zeros(0)))
        every = beside_nothing if sensor else every
    if not sensor and every is not None and not is_spent(spent):
        wider, again = _under(trials, weight, every, atoms, hull, spent)
        result = wider.problems[0].trials, wider, replace(again, adequate=False, rivals=[])
        if again.adequate:
            sensor, every = wandering(wider, again.winner)
    if sensor and every is not None:
        wider, again = _under(trials, weight, every, atoms, hull, spent)
        if again.adequate and again.rung < LAST:  # the slowest part shows in whole runs alone
            whole = whole_runs(wider, again.winner.hypothesis, again.winner.x)
            wider, again = _under(trials, weight, _alone(wider.problems[LAST], whole), atoms, hull, spent)
        if again.adequate and again.rung == LAST:
            return wider.problems[0].trials, wider, again
    if every is not None and not sensor:
        despite = found_despite(trials, weight, atoms, hull)
        if despite is not None:
            return despite
    told, its_ladder, partial = result
    return told, its_ladder, without_unconfirmed(its_ladder, partial, [*atoms, *([hull] if hull else [])])


def _read_as_obeyed(
    trials: Trials,
    weight: Array,
    atoms: Sequence[Atom],
    hull: Atom | None,
    spent: list[Ladder],
    patience: float,
) -> tuple[Trials, Ladder, Search]:
    """The search, made again under another reading of the commands between rows where that fits clearly
    better; every ladder that was climbed is added to `spent`.
    """
    held, ladder = trials, ladder_of(trials, weight)
    spent.append(ladder)
    other = misread(ladder, climb(ladder, Hypothesis(), np.zeros(0)), held)
    if other is not None:
        trials = replace(other, gaps=trials.gaps)
        ladder = ladder_of(trials, weight)
        spent.append(ladder)
    if trials.slow is None and _suspected(ladder):
        patience = min(patience, PATIENCE_SUSPECTED)
    found = search(ladder, atoms, hull, patience, partial(misread, held=held))
    for _ in range(READINGS):
        if (found.adequate and not found.winner.hypothesis.atoms) or is_spent(spent):
            break
        at = ladder.fit(MIDDLE, found.winner.hypothesis, found.winner.x)
        other, judge = better_reading(ladder, at, held), gained
        if other is None and found.adequate:
            other, judge = without_timing(ladder, at, held), as_well
        if other is None:
            break
        other = replace(other, gaps=trials.gaps)
        wider = ladder_of(other, weight)
        spent.append(wider)
        again = search(wider, atoms, hull, PATIENCE_AGAIN)
        if not judge(ladder, found, wider, again):
            break
        trials, ladder, found = other, wider, again
    return trials, ladder, found


def _suspected(ladder: Ladder) -> bool:
    """Whether on short windows, which forgive a wrong model, positions alone wander."""
    told = _told(ladder.problems[0], ladder.fit(0, Hypothesis(), np.zeros(0)))
    return bool((told[POSITIONS, 0] > 0).any() and not (told[OTHERS, 0] > 0).any())


def is_spent(ladders: Sequence[Ladder]) -> bool:
    """Whether so much was rolled out that no search is made again."""
    return sum(ladder.rolled for ladder in ladders) > TOGETHER


def _under(
    trials: Trials,
    weight: Array,
    slow: Array,
    atoms: Sequence[Atom],
    hull: Atom | None,
    spent: list[Ladder],
) -> tuple[Ladder, Search]:
    trials = replace(trials, slow=slow)
    _, ladder, found = _read_as_obeyed(trials, weight, atoms, hull, spent, PATIENCE_AGAIN)
    return ladder, found


def wandering(ladder: Ladder, winner: Fit) -> tuple[bool, Array | None]:
    """Whether positions alone wander beside the winner, as a receiver's may, and (6, 2) what wanders; None if
    nothing does, or nothing that is worth a second search.

    A fit that does not know of it follows the wandering with heading and speed, so it is told anew beside one
    that does. A force that is missing bends positions too, but smoothly: short windows, each with a start of
    its own, take that up, and a receiver's wandering remains.
    """
    at = ladder.fit(MIDDLE, winner.hypothesis, winner.x)
    first = _told(ladder.problems[1], at)
    if not (first[:, 0] > 0).any():
        return False, None
    short = _alone(ladder.problems[0], ladder.fit(0, winner.hypothesis, winner.x))
    middle = _alone(ladder.problems[1], at)
    if (short[POSITIONS, 0] > 0).any() and not (middle[OTHERS, 0] > 0).any():
        return True, middle
    return False, first if at.chi2 > FAR_ABOVE * ladder.problems[1].samples else None


def _alone(problem: Shooting, at: Fit) -> Array:
    """(6, 2) what wanders beside a fit for which positions alone do."""
    told = _told(problem, at)
    for _ in range(ROUNDS):
        slow = np.where(np.arange(len(told))[:, None] < POSITIONS.stop, told, 0.0)
        aware = Shooting(replace(problem.trials, slow=slow), problem.weight, problem.seconds, problem.windows)
        at = fit(aware, at.hypothesis, at.x, at.states, STEPS)
        told = _told(aware, at)
    return told


def _told(problem: Shooting, at: Fit) -> Array:
    base = problem.predict(at.hypothesis, at.x[None], at.states[None])[0]
    return slow_errors(problem.windows, problem.difference(base) * problem.windows.weight, problem.dt)

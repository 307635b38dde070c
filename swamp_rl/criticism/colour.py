"""Search under white noise; where that leaves something, again under errors that wander as what was left."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Atom, Hypothesis
from swamp_rl.criticism.conclude import Search, climb, without_unconfirmed
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import Fit, fit
from swamp_rl.criticism.ladder import LAST, MIDDLE, Ladder, ladder_of, whole_runs
from swamp_rl.criticism.partial import found_despite
from swamp_rl.criticism.readings import as_well, better_reading, gained, misread, without_timing
from swamp_rl.criticism.search import PATIENCE, search
from swamp_rl.criticism.shooting import Shooting
from swamp_rl.criticism.slow import slow_errors
from swamp_rl.criticism.unsteady import gain_of_forces, gain_of_wandering

Array = NDArray[np.float64]

POSITIONS = slice(0, 2)
OTHERS = slice(2, 6)
FAR_ABOVE = 3.0  # chi2 a sample that is left from which on the model's own errors are what limits the data
ROUNDS = 3  # times that the wandering is told anew, beside a fit that knows of it
PATIENCE_AGAIN = 5e6  # steps of a boat that each later search may take
PATIENCE_SUSPECTED = 8e6  # that the first one may take where positions seem to wander whatever is wrong
HARDLY, TINY = (1.0, 1.5), 1e-9  # logarithms of sizes and times that make no difference; in place of none
SEARCHES = 3  # times that the search is made again as the wandering is told anew
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
    if found.adequate and found.rung == LAST:
        return trials, ladder, found
    winner, rung = found.winner, LAST if found.adequate else MIDDLE
    if found.adequate and ran_away(ladder, winner):
        return trials, ladder, found
    wanders = wandering(ladder, winner, rung)
    if wanders != "receiver" and winner.hypothesis.atoms and not found.adequate:  # it may have bent to that
        nothing = ladder.fit(MIDDLE, Hypothesis(), np.zeros(0))
        if wandering(ladder, nothing, rung) == "receiver":
            winner, wanders = nothing, "receiver"
    if wanders == "receiver":
        again = _beside_wandering(weight, atoms, hull, spent, ladder, winner)
        if again is not None:
            return again
    if found.adequate:
        return trials, ladder, found
    if wanders == "model":
        despite = found_despite(trials, weight, atoms, hull)
        if despite is not None:
            return despite
    return trials, ladder, without_unconfirmed(ladder, found, [*atoms, *([hull] if hull else [])])


def _read_as_obeyed(
    trials: Trials,
    weight: Array,
    atoms: Sequence[Atom],
    hull: Atom | None,
    spent: list[Ladder],
    patience: float,
    before: Sequence[Fit] = (),
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
    found = search(ladder, atoms, hull, patience, partial(misread, held=held), before)
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


def _beside_wandering(
    weight: Array,
    atoms: Sequence[Atom],
    hull: Atom | None,
    spent: list[Ladder],
    ladder: Ladder,
    winner: Fit,
) -> tuple[Trials, Ladder, Search] | None:
    """What is found where positions wander, told beside the winner and then anew beside what is found, until
    that changes little; None where something else is left.
    """
    trials, slow = ladder.problems[0].trials, slowest(ladder, winner)
    for _ in range(SEARCHES):
        climb(ladder, winner.hypothesis, winner.x)
        before = [ladder.fit(rung, winner.hypothesis, winner.x) for rung in (0, MIDDLE)]
        _, ladder, found = _read_as_obeyed(
            replace(trials, slow=slow), weight, atoms, hull, spent, PATIENCE_AGAIN, before
        )
        if not found.adequate:
            return None
        winner, told, slow = found.winner, slow, slowest(ladder, found.winner)
        if is_spent(spent) or as_before(told, slow):
            break
    return ladder.problems[0].trials, ladder, found


def slowest(ladder: Ladder, winner: Fit) -> Array:
    """(6, 2) how positions wander beside a hypothesis, by whole runs where these have not run away: the
    slowest part shows there alone.
    """
    rung = MIDDLE if ran_away(ladder, winner) else LAST
    at = ladder.fit(rung, winner.hypothesis, winner.x)
    return _only_positions(_alone(ladder.problems[rung], at).told)


def ran_away(ladder: Ladder, winner: Fit) -> bool:
    """Whether whole runs leave far more than their windows do, as of a boat that keeps no course by itself:
    that tells nothing of its receiver.
    """
    middle = climb(ladder, winner.hypothesis, winner.x)
    whole = whole_runs(ladder, winner.hypothesis, winner.x)
    left = [one.chi2 / ladder.problems[rung].samples for rung, one in ((MIDDLE, middle), (LAST, whole))]
    return left[1] > FAR_ABOVE * left[0]


def as_before(one: Array, other: Array) -> bool:
    """Whether two ways to wander (6, 2) are hardly farther apart than those that are looked at."""
    size, time = np.abs(np.log(np.maximum(one, TINY) / np.maximum(other, TINY))).T
    return bool((size < HARDLY[0]).all() and (time < HARDLY[1]).all())


def wandering(ladder: Ladder, winner: Fit, rung: int) -> Literal["receiver", "model"] | None:
    """What wanders beside the winner on a rung: positions alone, as a receiver's may, or what the model
    predicts; None if nothing does, or nothing that is worth a second look.

    A fit that does not know of it follows the wandering with heading and speed, so it is told anew beside one
    that does. A force that is missing bends positions too: which of the two it is, their likelihoods say.
    """
    problem = ladder.problems[rung]
    at = ladder.fit(rung, winner.hypothesis, winner.x)
    first = _told(problem, at)
    if not (first[:, 0] > 0).any():
        return None
    alone = _alone(problem, at)
    only = (alone.told[POSITIONS, 0] > 0).any() and not (alone.told[OTHERS, 0] > 0).any()
    if only and alone.gain > gain_of_forces(problem, at):
        return "receiver"
    return "model" if at.chi2 > FAR_ABOVE * problem.samples else None


@dataclass(frozen=True)
class Alone:
    """told: (6, 2) what wanders beside a fit for which positions alone do; gain: twice the log-likelihood
    that this adds.
    """

    told: Array
    gain: float


def _alone(problem: Shooting, white: Fit) -> Alone:
    at, told, gain = white, _told(problem, white), 0.0
    for _ in range(ROUNDS):
        slow = _only_positions(told)
        aware = Shooting(replace(problem.trials, slow=slow), problem.weight, problem.seconds, problem.windows)
        at = fit(aware, at.hypothesis, at.x, at.states, STEPS)
        told, gain = _told(aware, at), gain_of_wandering(white, aware, at)
    return Alone(told, gain)


def _only_positions(told: Array) -> Array:
    return np.where(np.arange(len(told))[:, None] < POSITIONS.stop, told, 0.0)


def _told(problem: Shooting, at: Fit) -> Array:
    base = problem.predict(at.hypothesis, at.x[None], at.states[None])[0]
    return slow_errors(problem.windows, problem.difference(base) * problem.windows.weight, problem.dt)

"""What a logged command says of the time between two rows: a lever that moves between them was not held."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.adequacy import adequacy
from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.conclude import GAP, Search
from swamp_rl.criticism.cost import cost, score
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import Fit, enough, fit
from swamp_rl.criticism.instants import best_shares, changes, read_at
from swamp_rl.criticism.ladder import MIDDLE, Ladder
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

NONE = np.zeros(0)
SHARES = (0.5, 1.0)  # of the next row's command in a step that are tried: drawn straight, held until the row
CLEARLY = 40.0  # chi2 that another reading must save: a delay that is a cause is worth the same under each
SHARE = 0.2  # of what is left above noise that it must save too: a missing force is no matter of reading
NOISE = 1.06  # chi2 a sample of noise, whose size is told a little too small
FAR_ABOVE = 3.0  # chi2 a sample beyond which something else is wrong, whatever the reading
HOPELESS = 30.0  # the same before any other reading is tried
STEPS = 6  # Jacobians that a fit under another reading may take
ROUNDS = 4  # times that the instants of all steps are told beside a fit
EACH = 1.0  # chi2 that every instant must save on top


def read_between(trials: Trials, share: float) -> Trials:
    """The trials with every command moved a share of a step towards the next row's; azimuths the short way
    round.
    """
    change = changes(trials)
    return read_at(trials, change, np.full(change.shape[:2], share))


def better_reading(ladder: Ladder, at: Fit, held: Trials) -> Trials | None:
    """The trials read as fits clearly better beside a fit to the middle windows than the ladder's commands
    do, or None; held: the trials as logged.

    Judged beside what was found, not beside nothing: a missing cause is easily taken for a lever that moved
    earlier or later. One share of the next row's command for all steps first, where a parabola through those
    tried is least, so that what is left of it is no delay to be named; where that leaves more than noise, one
    for each step.
    """
    problem = ladder.problems[MIDDLE]
    if at.chi2 > HOPELESS * problem.samples:
        return None
    least = max(CLEARLY, SHARE * (at.chi2 - NOISE * problem.samples))
    best = None
    share, shared = with_one_share(problem, at, held)
    if shared.chi2 < min(at.chi2 - least, FAR_ABOVE * problem.samples):
        best = read_between(held, share)
    if adequacy(problem, shared if best else at).adequate:
        return best
    each, made, count = with_instants(problem, shared, held, share)
    saves = made.chi2 < min(at.chi2 - least - EACH * count, FAR_ABOVE * problem.samples)
    return each if saves else best


def without_timing(ladder: Ladder, at: Fit, held: Trials) -> Trials | None:
    """The trials read so that a fit to the middle windows needs none of its causes that shift what the
    actuators do in time, or None: a log that lags behind the levers looks like actuators that are quick.
    """
    problem = ladder.problems[MIDDLE]
    parts = [(atom, own) for atom, own in at.hypothesis.parts(at.x) if not atom.moves_actuators]
    if len(parts) == len(at.hypothesis.atoms):
        return None
    less = Hypothesis(tuple(atom for atom, _ in parts))
    plain = fit(problem, less, np.concatenate([NONE, *(own for _, own in parts)]), at.states, STEPS)
    most = score(at) + GAP - cost(less)
    share, shared = with_one_share(problem, plain, held)
    if shared.chi2 < most and adequacy(problem, shared).adequate:
        return read_between(held, share)
    each, made, count = with_instants(problem, shared, held, share)
    return each if made.chi2 + EACH * count < most and adequacy(problem, made).adequate else None


def with_one_share(problem: Shooting, at: Fit, held: Trials) -> tuple[float, Fit]:
    """The share of a step by which every command is moved where that fits best beside a hypothesis, and the
    fit to that reading.
    """
    as_logged = at if held.commands is problem.trials.commands else _under(problem, held, at)
    fits = [as_logged, *(_under(problem, read_between(held, share), at) for share in SHARES)]
    share = least_of_parabola(*(one.chi2 for one in fits))
    return share, _under(problem, read_between(held, share), min(fits, key=lambda one: one.chi2))


def misread(ladder: Ladder, at: Fit, held: Trials) -> Trials | None:
    """The trials read otherwise, where that is all that a fit to the middle windows wants."""
    problem = ladder.problems[MIDDLE]
    if adequacy(problem, at).adequate:
        return None
    other = better_reading(ladder, at, held)
    return other if other and adequacy(problem, _under(problem, other, at)).adequate else None


def with_instants(problem: Shooting, at: Fit, held: Trials, share: float) -> tuple[Trials, Fit, int]:
    """The trials with every larger step of a command where it fits beside a hypothesis, the fit to them, and
    how many instants were told; at: the fit with all steps at one share.
    """
    change = changes(held)
    shares = np.full(change.shape[:2], share)
    best = read_at(held, change, shares)
    made = least = _under(problem, best, at, fresh=True)
    count = 0
    for _ in range(ROUNDS):
        shares, share, count = best_shares(_problem(problem, best), least, change, shares, share)
        trials = read_at(held, change, shares)
        made = _under(problem, trials, least, fresh=True)
        gain = least.chi2 - made.chi2
        if gain > 0.0:
            best, least = trials, made
        if gain < enough(problem, least.chi2):
            break
    return best, least, count


def least_of_parabola(start: float, middle: float, end: float) -> float:
    """Where from 0 to 1 a parabola through values at 0, 1/2 and 1 is least."""
    bend = start - 2.0 * middle + end
    if bend <= 0.0:
        return 0.0 if start < end else 1.0
    return float(np.clip(0.5 + 0.25 * (start - end) / bend, 0.0, 1.0))


def _under(problem: Shooting, trials: Trials, at: Fit, fresh: bool = False) -> Fit:
    """A fit made again, on the same windows, under another reading."""
    return fit(_problem(problem, trials), at.hypothesis, at.x, at.states, STEPS, fresh)


def _problem(problem: Shooting, trials: Trials) -> Shooting:
    made = replace(problem.trials, commands=trials.commands)
    return Shooting(made, problem.weight, problem.seconds, problem.windows)


def gained(before: Ladder, found: Search, after: Ladder, again: Search) -> bool:
    """Whether a search under another reading ends clearly better."""

    def reached(ladder: Ladder, one: Search) -> float:
        return score(ladder.fit(MIDDLE, one.winner.hypothesis, one.winner.x))

    return again.adequate > found.adequate or (
        again.adequate == found.adequate and reached(after, again) < reached(before, found) - CLEARLY
    )


def as_well(before: Ladder, found: Search, after: Ladder, again: Search) -> bool:
    """Whether a search under another reading explains as much with less."""
    one, other = (
        ladder.fit(MIDDLE, s.winner.hypothesis, s.winner.x) for ladder, s in ((before, found), (after, again))
    )
    return (
        again.adequate
        and len(again.winner.hypothesis.atoms) < len(found.winner.hypothesis.atoms)
        and score(other) < score(one) + GAP
    )

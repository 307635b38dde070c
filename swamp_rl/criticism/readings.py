"""What a logged command says of the time between two rows: a lever that moves between them was not held."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.conclude import Search
from swamp_rl.criticism.cost import score
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import Fit, fit
from swamp_rl.criticism.ladder import Ladder
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

MIDDLE = 1  # the rung that readings are compared on
SHARES = (0.5, 1.0)  # of the next row's command in a step that are tried: drawn straight, held until the row
CLEARLY = 40.0  # chi2 that another reading must save: a delay that is a cause is worth the same under each
SHARE = 0.2  # of what is left above noise that it must save too: a missing force is no matter of reading
NOISE = 1.06  # chi2 a sample of noise, whose size is told a little too small
FAR_ABOVE = 3.0  # chi2 a sample beyond which something else is wrong, whatever the reading
STEPS = 6  # Jacobians that a fit under another reading may take


def read_between(trials: Trials, share: float) -> Trials:
    """The trials with every command moved a share of a step towards the next row's; azimuths the short way
    round.
    """
    change = np.diff(trials.commands, axis=1, append=trials.commands[:, -1:])
    angles = change[..., : change.shape[2] // 2]
    angles -= 2.0 * np.pi * np.round(angles / (2.0 * np.pi))
    return replace(trials, commands=trials.commands + share * change)


def better_reading(ladder: Ladder, found: Search) -> Trials | None:
    """The trials read as fits clearly better beside the winner than held from each row, or None.

    Judged beside what was found, not beside nothing: a missing cause is easily taken for a lever that moved
    earlier or later. The share of the next row's command is where a parabola through those tried is least, so
    that what is left of it is no delay to be named.
    """
    problem = ladder.problems[MIDDLE]
    at = ladder.fit(MIDDLE, found.winner.hypothesis, found.winner.x)
    if at.chi2 > FAR_ABOVE * problem.samples:
        return None
    half, whole = (_under(problem, share, at).chi2 for share in SHARES)
    if min(half, whole) > at.chi2 - max(CLEARLY, SHARE * (at.chi2 - NOISE * problem.samples)):
        return None
    return read_between(problem.trials, least_of_parabola(at.chi2, half, whole))


def least_of_parabola(start: float, middle: float, end: float) -> float:
    """Where from 0 to 1 a parabola through values at 0, 1/2 and 1 is least."""
    bend = start - 2.0 * middle + end
    if bend <= 0.0:
        return 0.0 if start < end else 1.0
    return float(np.clip(0.5 + 0.25 * (start - end) / bend, 0.0, 1.0))


def _under(problem: Shooting, share: float, at: Fit) -> Fit:
    """A fit made again, on the same windows, under another reading."""
    other = Shooting(read_between(problem.trials, share), problem.weight, problem.seconds, problem.windows)
    return fit(other, at.hypothesis, at.x, at.states, STEPS)


def gained(before: Ladder, found: Search, after: Ladder, again: Search) -> bool:
    """Whether a search under another reading ends clearly better."""

    def reached(ladder: Ladder, one: Search) -> float:
        return score(ladder.fit(MIDDLE, one.winner.hypothesis, one.winner.x))

    return again.adequate > found.adequate or (
        again.adequate == found.adequate and reached(after, again) < reached(before, found) - CLEARLY
    )

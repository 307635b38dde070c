"""Windows of growing length: short ones forgive a wrong model, long ones tell two models apart."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import Fit, fit
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

RUNGS = (5.0, 20.0, np.inf)  # s
STEPS = (4, 5, 5)
PATIENCE = 16  # steps on a longer rung for what fits well on the shorter one
GOOD = 1.1  # chi2 a sample that counts as fitting well


@dataclass
class Ladder:
    """The same trials cut at every rung, and the fits made so far by rung and hypothesis."""

    problems: list[Shooting]
    guesses: list[Array]
    fits: dict[tuple[int, str], Fit] = field(default_factory=dict)

    def fit(self, rung: int, hypothesis: Hypothesis, x: Array) -> Fit:
        """The hypothesis at its best on that rung, begun from x and, where there is one, from the rung
        below.
        """
        key = (rung, hypothesis.label)
        if key in self.fits and self.fits[key].chi2 < np.inf:
            return self.fits[key]
        below = self.fits.get((rung - 1, hypothesis.label))
        if below is not None:
            x = below.x
        states = self.guesses[rung] if below is None else self.carried(below, rung)
        good = below is not None and below.chi2 < GOOD * self.problems[rung - 1].samples
        made = fit(self.problems[rung], hypothesis, x, states, PATIENCE if good else STEPS[rung])
        self.fits[key] = made
        return made

    def carried(self, below: Fit, rung: int) -> Array:
        """(W, 6) states at this rung's starts, from the fit of the rung below where a window began
        there too.
        """
        states = self.guesses[rung].copy()
        shorter, longer = self.problems[rung - 1].windows, self.problems[rung].windows
        starts = {(r, f): i for i, (r, f) in enumerate(zip(shorter.run, shorter.first, strict=True))}
        for w, key in enumerate(zip(longer.run, longer.first, strict=True)):
            if key in starts:
                states[w] = below.states[starts[key]]
        return states


def ladder_of(trials: Trials, weight: Array) -> Ladder:
    """The rungs for these trials."""
    problems = [Shooting(trials, weight, seconds) for seconds in RUNGS]
    return Ladder(problems, [problem.guess() for problem in problems])

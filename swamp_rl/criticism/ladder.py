"""Windows of growing length: short ones forgive a wrong model, long ones tell two models apart."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.adequacy import NEARLY, adequacy
from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.data import Gap, Trials
from swamp_rl.criticism.fit import Fit, fit, settle
from swamp_rl.criticism.gaps import reread, resolved, without_harmless
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.shooting import Shooting
from swamp_rl.criticism.unseen_commands import tapped

Array = NDArray[np.float64]

RUNGS = (5.0, 20.0, np.inf)  # s
MIDDLE = 1
LAST = len(RUNGS) - 1  # whole runs, the commands of lost rows read as fits best
UNBROKEN = LAST + 1  # beside the rungs: runs cut wherever it is in doubt which command stood in a lost row
STEPS = (8, 10, 10, 8)  # Jacobians that a fit may take on each
ROUNDS = 12  # steps that a first guess of a state is given
PATIENCE = 16  # steps on a longer rung for what fits well on the shorter one
TAPS = 4  # times that commands in lost rows are corrected
HOPELESS = 10.0  # chi2 a sample of what is far from the data
LITTLE = 0.25  # share of a promise that a fit keeps which found no way down
GOOD = 1.1  # chi2 a sample that counts as fitting well


@dataclass
class Ladder:
    """The same trials cut at every rung and unbroken, and the fits made so far by rung and hypothesis."""

    problems: list[Shooting]
    guesses: list[Array]
    gaps: tuple[Gap, ...] = ()
    fits: dict[tuple[int, str], Fit] = field(default_factory=dict)
    half: Shooting | None = None

    def fit(self, rung: int, hypothesis: Hypothesis, x: Array, states: Array | None = None) -> Fit:
        """The hypothesis at its best on that rung, begun from x and states (W, 6) or, where there is one,
        from the fit of the rung below.
        """
        key = (rung, hypothesis.label)
        if key in self.fits and self.fits[key].chi2 < np.inf:
            return self.fits[key]
        below = self.fits.get((rung - 1, hypothesis.label))
        if below is not None:
            x = below.x
            states = self.carried(below, rung)
        elif states is None:
            states, _, _ = settle(self.problems[rung], hypothesis, x, self.guesses[rung], ROUNDS)
        good = below is not None and below.chi2 < GOOD * self.problems[rung - 1].samples
        steps = PATIENCE if good else STEPS[rung]
        made = fit(self.problems[rung], hypothesis, x, states, steps, fresh=rung >= LAST)
        self.fits[key] = made
        LOG.debug("segments of %g s: %s, chi2 %.0f", RUNGS[min(rung, LAST)], hypothesis.label, made.chi2)
        return made

    def stuck(self, made: Fit, before: float, promised: float) -> bool:
        """Whether a fit to the shortest windows, far from the data, gained little of what was promised from
        the chi2 before.
        """
        return made.chi2 > HOPELESS * self.problems[0].samples and before - made.chi2 < LITTLE * (
            before - promised
        )

    def freed(self, made: Fit) -> Fit:
        """A fit to the shortest windows begun again from one to windows half as long: in these a boat that
        keeps no course by itself has no time to run away.
        """
        if self.half is None:
            first = self.problems[0]
            self.half = Shooting(first.trials, first.weight, 0.5 * RUNGS[0])
        x, hypothesis = made.x, made.hypothesis
        for problem, guess in ((self.half, self.half.guess()), (self.problems[0], self.guesses[0])):
            states, _, _ = settle(problem, hypothesis, x, guess, ROUNDS)
            again = fit(problem, hypothesis, x, states, STEPS[0])
            x = again.x
        best = min(made, again, key=lambda one: one.chi2)
        self.fits[0, hypothesis.label] = best
        return best

    @property
    def rolled(self) -> int:
        """Steps of a boat that were rolled out so far."""
        every = [*self.problems, *([self.half] if self.half else [])]
        counts = {id(problem): problem.rolled[0] for problem in every}  # one may stand on two rungs
        return sum(counts.values())

    def put(self, rung: int, problem: Shooting) -> None:
        """Another comparison on a rung; what was fitted there is forgotten."""
        self.problems[rung], self.guesses[rung] = problem, problem.guess()
        self.fits = {key: made for key, made in self.fits.items() if key[0] != rung}

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
    """The rungs for these trials; short windows end where it matters which command stood in a lost row."""
    cautious = without_harmless(trials, weight)
    problems = [Shooting(cautious, weight, seconds) for seconds in RUNGS]
    problems.append(problems[LAST])
    return Ladder(problems, [problem.guess() for problem in problems], trials.gaps)


def whole_runs(ladder: Ladder, hypothesis: Hypothesis, x: Array) -> Fit:
    """The fit to whole runs, the commands of lost rows read as fits it best; later fits keep that reading."""
    first = ladder.problems[LAST]
    if (LAST, hypothesis.label) in ladder.fits:
        return ladder.fit(LAST, hypothesis, x)
    trials = resolved(first.trials, first.weight, ladder.gaps, hypothesis, x)
    ladder.put(LAST, Shooting(trials, first.weight, first.seconds))
    made = _with_taps(ladder, ladder.fit(LAST, hypothesis, x))
    again = reread(ladder.problems[LAST], made, ladder.gaps)
    if not np.array_equal(again.commands, ladder.problems[LAST].trials.commands):
        ladder.put(LAST, Shooting(again, first.weight, first.seconds))
        made = ladder.fit(LAST, hypothesis, made.x)
    return made


def _with_taps(ladder: Ladder, made: Fit) -> Fit:
    """A fit to whole runs with commands that only stood in lost rows, where those leave nothing but noise."""
    before, first = ladder.problems[LAST], made
    for _ in range(TAPS):
        problem = ladder.problems[LAST]
        if adequacy(problem, made).adequate or made.chi2 > NEARLY * problem.samples:
            break
        trials = tapped(problem, made)
        if trials is None:
            break
        ladder.put(LAST, Shooting(trials, problem.weight, problem.seconds))
        made = ladder.fit(LAST, made.hypothesis, made.x)
    if made is not first and not adequacy(ladder.problems[LAST], made).adequate:
        ladder.put(LAST, before)
        ladder.fits[(LAST, first.hypothesis.label)] = made = first
    return made

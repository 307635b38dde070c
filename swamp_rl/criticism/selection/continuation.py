"""Continuation in the window length: a fit to short windows, where the loss is nearly convex, starts the fit
to longer ones, which discriminate between hypotheses.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import Gap, RunSet
from swamp_rl.criticism.likelihood.adequacy import NEARLY, adequacy
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit, fit_states
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.nuisance.lost_rows import (
    with_best_commands,
    with_commands_refined,
    with_relevant_gaps,
)
from swamp_rl.criticism.nuisance.unlogged_commands import with_unlogged_commands
from swamp_rl.criticism.progress import LOG

Array = NDArray[np.float64]

WINDOW_LENGTHS = (5.0, 20.0, np.inf)  # s
MIDDLE = 1
LAST = len(WINDOW_LENGTHS) - 1  # whole runs, with the best-fitting commands in gaps
UNBROKEN = LAST + 1  # beside the window lengths: runs cut only at gaps
STEPS = (8, 10, 10, 8)  # Jacobians of a fit, by stage
ROUNDS = 12  # iterations of the first initial states
STEPS_WHEN_CLOSE = 16  # Jacobians of a fit whose shorter windows fit well
MOST_CORRECTIONS = 4  # repetitions of the search for unlogged commands
FAR = 10.0  # chi2 a sample of a fit that is far from the data
MIN_GAIN_RATIO = 0.25  # gain ratio below which a fit has not converged
CLOSE = 1.1  # chi2 a sample of a fit that is close to the data


@dataclass
class Continuation:
    """The same runs cut in windows of every length and unbroken; the fits by stage and hypothesis.

    problems: multiple shooting by stage, the stages being WINDOW_LENGTHS and UNBROKEN; initial_states: (W, 6)
    by stage.
    """

    problems: list[Shooting]
    initial_states: list[Array]
    gaps: tuple[Gap, ...] = ()
    fits: dict[tuple[int, str], Fit] = field(default_factory=dict)
    half: Shooting | None = None

    def fit(self, stage: int, hypothesis: Hypothesis, x: Array, states: Array | None = None) -> Fit:
        """The hypothesis fitted at that stage, from x and states (W, 6) or, where there is one, from the fit
        of the stage before.
        """
        key = (stage, hypothesis.label)
        if key in self.fits and self.fits[key].chi2 < np.inf:
            return self.fits[key]
        below = self.fits.get((stage - 1, hypothesis.label))
        if below is not None:
            x = below.x
            states = self.carried(below, stage)
        elif states is None:
            states, _, _ = fit_states(self.problems[stage], hypothesis, x, self.initial_states[stage], ROUNDS)
        good = below is not None and below.chi2 < CLOSE * self.problems[stage - 1].samples
        steps = STEPS_WHEN_CLOSE if good else STEPS[stage]
        made = fit(self.problems[stage], hypothesis, x, states, steps, fresh=stage >= LAST)
        self.fits[key] = made
        LOG.debug(
            "segments of %g s: %s, chi2 %.0f", WINDOW_LENGTHS[min(stage, LAST)], hypothesis.label, made.chi2
        )
        return made

    def not_converged(self, made: Fit, before: float, expected_chi2: float) -> bool:
        """Whether a fit to the shortest windows, far from the data, kept little of the expected fall of chi2
        from `before`.
        """
        return made.chi2 > FAR * self.problems[0].samples and before - made.chi2 < MIN_GAIN_RATIO * (
            before - expected_chi2
        )

    def restarted(self, made: Fit) -> Fit:
        """A fit to the shortest windows restarted from a fit to windows half as long, in which a boat that is
        unstable on course diverges less.
        """
        if self.half is None:
            first = self.problems[0]
            self.half = Shooting(first.run_set, first.weight, 0.5 * WINDOW_LENGTHS[0])
        x, hypothesis = made.x, made.hypothesis
        for problem, initial_states in (
            (self.half, self.half.initial_states()),
            (self.problems[0], self.initial_states[0]),
        ):
            states, _, _ = fit_states(problem, hypothesis, x, initial_states, ROUNDS)
            again = fit(problem, hypothesis, x, states, STEPS[0])
            x = again.x
        best = min(made, again, key=lambda one: one.chi2)
        self.fits[0, hypothesis.label] = best
        return best

    @property
    def boat_steps(self) -> int:
        """Number of simulated steps of a boat so far."""
        every = [*self.problems, *([self.half] if self.half else [])]
        counts = {id(problem): problem.boat_steps[0] for problem in every}  # stages may share a problem
        return sum(counts.values())

    def replace_problem(self, stage: int, problem: Shooting) -> None:
        """Replace the problem of a stage and drop its fits."""
        self.problems[stage], self.initial_states[stage] = problem, problem.initial_states()
        self.fits = {key: made for key, made in self.fits.items() if key[0] != stage}

    def carried(self, below: Fit, stage: int) -> Array:
        """(W, 6) initial states of this stage, from the fit of the stage before where a window began at the
        same sample.
        """
        states = self.initial_states[stage].copy()
        shorter, longer = self.problems[stage - 1].windows, self.problems[stage].windows
        starts = {(r, f): i for i, (r, f) in enumerate(zip(shorter.run, shorter.first, strict=True))}
        for w, key in enumerate(zip(longer.run, longer.first, strict=True)):
            if key in starts:
                states[w] = below.states[starts[key]]
        return states


def continuation_of(run_set: RunSet, weight: Array) -> Continuation:
    """The stages for these runs; shorter windows end at gaps in which the unknown command matters."""
    cautious = with_relevant_gaps(run_set, weight)
    problems = [Shooting(cautious, weight, seconds) for seconds in WINDOW_LENGTHS]
    problems.append(problems[LAST])
    return Continuation(problems, [problem.initial_states() for problem in problems], run_set.gaps)


def fit_whole_runs(continuation: Continuation, hypothesis: Hypothesis, x: Array) -> Fit:
    """The fit to whole runs, with the best-fitting commands in gaps; later fits keep these commands."""
    first = continuation.problems[LAST]
    if (LAST, hypothesis.label) in continuation.fits:
        return continuation.fit(LAST, hypothesis, x)
    run_set = with_best_commands(first.run_set, first.weight, continuation.gaps, hypothesis, x)
    continuation.replace_problem(LAST, Shooting(run_set, first.weight, first.seconds))
    made = _with_unlogged_commands(continuation, continuation.fit(LAST, hypothesis, x))
    again = with_commands_refined(continuation.problems[LAST], made, continuation.gaps)
    if not np.array_equal(again.commands, continuation.problems[LAST].run_set.commands):
        continuation.replace_problem(LAST, Shooting(again, first.weight, first.seconds))
        made = continuation.fit(LAST, hypothesis, made.x)
    return made


def _with_unlogged_commands(continuation: Continuation, made: Fit) -> Fit:
    """A fit to whole runs with commands that only stood in lost rows, where the residual is then noise."""
    before, first = continuation.problems[LAST], made
    for _ in range(MOST_CORRECTIONS):
        problem = continuation.problems[LAST]
        if adequacy(problem, made).adequate or made.chi2 > NEARLY * problem.samples:
            break
        run_set = with_unlogged_commands(problem, made)
        if run_set is None:
            break
        continuation.replace_problem(LAST, Shooting(run_set, problem.weight, problem.seconds))
        made = continuation.fit(LAST, made.hypothesis, made.x)
    if made is not first and not adequacy(continuation.problems[LAST], made).adequate:
        continuation.replace_problem(LAST, before)
        continuation.fits[(LAST, first.hypothesis.label)] = made = first
    return made

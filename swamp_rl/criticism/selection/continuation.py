"""Continuation in the window length: fits to short windows, nearly convex, begin those to longer ones."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import Gap, RunSet
from swamp_rl.criticism.likelihood.adequacy import adequacy
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, first_states, fit
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.scales import window_lengths
from swamp_rl.criticism.nuisance.command_timing import with_unlogged_commands
from swamp_rl.criticism.nuisance.lost_rows import (
    with_best_commands,
    with_commands_refined,
    with_relevant_gaps,
)
from swamp_rl.criticism.options import options
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.selection.best_instant import best_instant
from swamp_rl.criticism.selection.information_criterion import InformationCriterion, information_criterion
from swamp_rl.criticism.selection.score_test import neutral_start

Array = NDArray[np.float64]

MIDDLE = 1
LAST = 2  # whole runs, every hypothesis with its own best-fitting commands in gaps
CORRECTED = LAST + 1  # the same, also with commands that only stood in lost rows, each of them charged


@dataclass
class Continuation:
    """The same runs cut in windows of every length; the fits by stage and hypothesis.

    problems: multiple shooting by stage, that of whole runs with the commands as logged; initial_states:
    (W, 6) by stage; whole: whole runs by stage and hypothesis, with the commands that fit it best;
    reconstructed: `better_reconstruction` by hypothesis and its parameters.
    """

    problems: list[Shooting]
    initial_states: list[Array]
    criterion: InformationCriterion
    gaps: tuple[Gap, ...] = ()
    fits: dict[tuple[int, str], Fit] = field(default_factory=dict)
    whole: dict[tuple[int, str], Shooting] = field(default_factory=dict)
    reconstructed: dict[tuple[str, bytes], RunSet | None] = field(default_factory=dict)
    half: Shooting | None = None

    @property
    def run_set(self) -> RunSet:
        """The runs that were cut in windows, with all their gaps: those that do not matter to the windows of
        one hypothesis under one noise may under another.
        """
        return replace(self.problems[0].run_set, gaps=self.gaps)

    def problem(self, stage: int, hypothesis: Hypothesis) -> Shooting:
        """The windows that a hypothesis is fitted to at a stage."""
        return self.whole.get((stage, hypothesis.label), self.problems[stage])

    def fit(self, stage: int, hypothesis: Hypothesis, x: Array, states: Array | None = None) -> Fit:
        """The fit at that stage, from x and states (W, 6) or from the fit of the stage before."""
        key = (stage, hypothesis.label)
        if key in self.fits and self.fits[key].chi2 < np.inf:
            return self.fits[key]
        if stage == CORRECTED:
            return self._corrected(self.fit(LAST, hypothesis, x, states))
        below = self.fits.get((stage - 1, hypothesis.label))
        if below is not None:
            x = below.x
            states = self.carried(below, stage)
        good = below is not None and below.chi2 < options().noise_chi2 * self.problems[stage - 1].samples
        steps = options().steps_when_close if good else options().stage_steps[stage]
        made = self.fit_from(stage, hypothesis, x, states, steps, stage >= LAST)
        if stage == 0:
            made = self._at_best_instants(made, steps)
        return self._no_worse_than_nothing(stage, made, steps)

    def _at_best_instants(self, made: Fit, steps: int) -> Fit:
        """The fit to the shortest windows, or one from better instants of the failures in it."""
        for instance in made.hypothesis.instances:
            if instance.effect.begin == "changepoint":
                (index,) = np.flatnonzero(made.hypothesis.columns(instance.label))
                x = made.x.copy()
                x[index] = best_instant(self.problems[0], made, int(index), self.initial_states[0])
                if x[index] != made.x[index]:
                    made = self.refitted(0, made, x, made.states, steps, fresh=True)
        return made

    def _no_worse_than_nothing(self, stage: int, made: Fit, steps: int) -> Fit:
        """The fit, or one from the neutral values of its effects where the boat file fits these windows
        better: then it is in a local minimum.
        """
        nothing = self.fits.get((stage, Hypothesis().label))
        every = made.hypothesis.instances
        if nothing is None or stage >= LAST or not all(one.size for one in every):
            return made
        if made.chi2 <= nothing.chi2 + options().clearly:
            return made
        boat = self.problems[stage].boat
        neutral = [np.array(neutral_start(one, boat) * one.count) for one in every]
        return self.refitted(stage, made, np.concatenate(neutral), nothing.states, steps)

    def refitted(
        self, stage: int, made: Fit, x: Array, states: Array, steps: int, fresh: bool = False
    ) -> Fit:
        """The better of a fit and another from x (p,) and states (W, 6), kept."""
        problem = self.problem(stage, made.hypothesis)
        again = self.fit_from(stage, made.hypothesis, x, states, steps, fresh)
        if again.chi2 < made.chi2:
            return again
        self.keep(stage, problem, made)
        return made

    def at(self, stage: int, one: Fit) -> Fit:
        """The hypothesis of a fit, fitted at that stage."""
        return self.fit(stage, one.hypothesis, one.x)

    def boat_file(self, stage: int) -> Fit:
        """The boat file alone at that stage."""
        return self.fit(stage, Hypothesis(), np.zeros(0))

    def is_adequate(self, stage: int, one: Fit) -> bool:
        """Whether the residual of a fit at that stage is noise."""
        return adequacy(self.problem(stage, one.hypothesis), one).adequate

    def fit_from(
        self,
        stage: int,
        hypothesis: Hypothesis,
        x: Array,
        states: Array | None,
        steps: int,
        fresh: bool = False,
    ) -> Fit:
        """The fit at that stage from x (p,) and states (W, 6), kept; whole runs with their best commands."""
        if stage == CORRECTED:
            return self._corrected(self.fit_from(LAST, hypothesis, x, states, steps))
        problem = self.problems[stage]
        if states is None:
            states = first_states(problem, hypothesis, x, self.initial_states[stage])
        if stage == LAST:
            problem, made = fit_whole_runs(problem, self.gaps, hypothesis, x, states, steps)
        else:
            made = fit(problem, hypothesis, x, states, steps, fresh)
        self.keep(stage, problem, made)
        LOG.debug("segments of %g s: %s, chi2 %.0f", problem.seconds, hypothesis.label, made.chi2)
        return made

    def _corrected(self, below: Fit) -> Fit:
        problem, made = with_corrected_commands(self.problem(LAST, below.hypothesis), below)
        self.keep(CORRECTED, problem, made)
        return made

    def keep(self, stage: int, problem: Shooting, made: Fit) -> None:
        """Keep a fit to those windows at a stage."""
        self.fits[stage, made.hypothesis.label] = made
        if stage >= LAST:
            self.whole[stage, made.hypothesis.label] = problem

    def begin_again(self, made: Fit) -> None:
        """Keep a fit to the shortest windows; the fits to longer ones that began from another are dropped."""
        label = made.hypothesis.label
        for stage in range(len(self.problems)):
            self.fits.pop((stage, label), None)
            self.whole.pop((stage, label), None)
        self.keep(0, self.problems[0], made)

    def not_converged(self, made: Fit, before: float, expected_chi2: float) -> bool:
        """Whether a fit far from the data kept little of the expected fall of chi2 from `before`."""
        far = made.chi2 > options().far_from_data * self.problems[0].samples
        return far and before - made.chi2 < options().converged_share * (before - expected_chi2)

    def restarted(self, made: Fit) -> Fit:
        """A fit restarted from windows half as long, in which an unstable boat diverges less."""
        first = self.problems[0]
        if self.half is None:
            seconds = options().restart_share * first.seconds
            self.half = Shooting(first.run_set, first.weight, seconds)
        x, hypothesis = made.x, made.hypothesis
        for problem in (self.half, first):
            states = first_states(problem, hypothesis, x, problem.initial_states())
            again = fit(problem, hypothesis, x, states, options().stage_steps[0])
            x = again.x
        best = min(made, again, key=lambda one: one.chi2)
        self.fits[0, hypothesis.label] = best
        return best

    @property
    def boat_steps(self) -> int:
        """Number of simulated steps of a boat so far."""
        every = [*self.problems, *self.whole.values(), *([self.half] if self.half else [])]
        counts = {id(problem): problem.boat_steps[0] for problem in every}  # stages may share a problem
        return sum(counts.values())

    def carried(self, below: Fit, stage: int) -> Array:
        """(W, 6) initial states of this stage, from the stage before where a window began there."""
        shorter = self.problem(stage - 1, below.hypothesis)
        return states_carried(shorter, below.states, self.problems[stage], self.initial_states[stage])


def states_carried(shorter: Shooting, states: Array, longer: Shooting, others: Array) -> Array:
    """(W, 6) initial states, from shorter windows that begin at the same sample, else `others` (W, 6)."""
    found = others.copy()
    short, long = (zip(one.windows.run, one.windows.first, strict=True) for one in (shorter, longer))
    starts = {start: i for i, start in enumerate(short)}
    for w, start in enumerate(long):
        if start in starts:
            found[w] = states[starts[start]]
    return found


def continuation_of(run_set: RunSet, weight: Array) -> Continuation:
    """The stages for these runs; shorter windows end at gaps in which the unknown command matters."""
    cautious = with_relevant_gaps(run_set, weight)
    lengths = (*window_lengths(run_set.boat), math.inf)
    problems = [Shooting(cautious, weight, seconds) for seconds in lengths]
    problems.append(problems[LAST])
    states = [problem.initial_states() for problem in problems]
    criterion = information_criterion(run_set, problems[LAST].samples)
    return Continuation(problems, states, criterion, run_set.gaps)


def fit_whole_runs(
    logged: Shooting, gaps: Sequence[Gap], hypothesis: Hypothesis, x: Array, states: Array, steps: int
) -> tuple[Shooting, Fit]:
    """Whole runs with the best-fitting commands in gaps under a hypothesis, and its fit to them.

    logged: whole runs with the commands as logged; they and the commands of other hypotheses are left as they
    are.
    """
    run_set = with_best_commands(logged.run_set, logged.weight, gaps, hypothesis, x)
    problem = logged if run_set is logged.run_set else Shooting(run_set, logged.weight, logged.seconds)
    if len(states) != problem.windows.count:  # of the logged runs, whose windows end at gaps
        states = states_carried(logged, states, problem, problem.initial_states())
    made = fit(problem, hypothesis, x, states, steps, fresh=True)
    again = with_commands_refined(problem, made, gaps)
    if not np.array_equal(again.commands, problem.run_set.commands):
        refined = Shooting(again, problem.weight, problem.seconds)
        refitted = fit(refined, hypothesis, made.x, made.states, steps, fresh=True)
        if refitted.chi2 < made.chi2:  # they were chosen by a linearisation
            problem, made = refined, refitted
    return problem, made


def with_corrected_commands(problem: Shooting, made: Fit) -> tuple[Shooting, Fit]:
    """Whole runs with commands that only stood in lost rows, where the residual is then noise, and the fit;
    its penalty holds `unlogged_gain` for each such command, so that an effect is preferred to many of them.

    Each round takes the best command of every run, so it lowers the excess over noise less than the one
    before: the rounds end where as much in each that remains would not suffice.
    """
    before, corrected, excess = (problem, made), 0, math.inf
    for remaining in range(options().most_corrections, 0, -1):
        last, excess = excess, adequacy(problem, made).worst
        enough = excess - remaining * (last - excess) < options().whiteness_limit
        noise = excess < options().whiteness_limit
        if noise or not enough or made.chi2 > options().nearly_noise * problem.samples:
            break
        run_set = with_unlogged_commands(problem, made)
        if run_set is None:
            break
        corrected += int((run_set.commands != problem.run_set.commands).any(axis=2).sum())
        problem = Shooting(run_set, problem.weight, problem.seconds)
        made = fit(problem, made.hypothesis, made.x, made.states, options().stage_steps[LAST], fresh=True)
    if not adequacy(problem, made).adequate:
        return before
    return problem, replace(made, penalty=made.penalty + options().unlogged_gain * corrected)

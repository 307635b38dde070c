"""Prediction error by horizon under the boat file and under the extended one, on held-out runs."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import turned, within_half_turn
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting, Windows
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import Gain, Paired, Predictors
from swamp_rl.simulator.sensors import true_motion

Array = NDArray[np.float64]

QUANTITIES = {
    "position_rmse_m": [0, 1],
    "heading_rmse_rad": [2],
    "surge_rmse_m_s": [3],
    "sway_rmse_m_s": [4],
    "yaw_rate_rmse_rad_s": [5],
}


TRIVIAL = {
    "at_rest": "a boat at rest",
    "constant_velocity": "constant velocity",
    "no_thrust": "the same boat without thrust",
}


@dataclass(frozen=True)
class Errors:
    """error: (n, 6) measured less predicted, in the order of CHANNELS, NaN where nothing was measured; run:
    (n,); end: (n,) time in its run [s].
    """

    error: Array
    run: NDArray[np.int64]
    end: Array


def gains(
    run_set: RunSet, weight: Array, hypothesis: Hypothesis, numbers: Array, rng: np.random.Generator
) -> list[Gain]:
    """Errors under the boat file and under a hypothesis, at every horizon that the runs allow.

    weight: (R, T, 6); numbers: (R, p), the parameters for each run, fitted without it.
    """
    found = []
    for horizon in options().horizons:
        before = boat_file_errors(run_set, weight, horizon)
        after = errors_at(run_set, weight, horizon, hypothesis, numbers)
        block, called = blocks_of(before, horizon)
        kept = {
            name: paired
            for name, columns in QUANTITIES.items()
            if (paired := change(before.error[:, columns], after.error[:, columns], block, rng))
        }
        found.append(Gain(horizon_s=horizon, restarts=len(block), blocks=called, **kept))
    return found


def errors_at(run_set: RunSet, weight: Array, horizon: float, hypothesis: Hypothesis, x: Array) -> Errors:
    """Errors `horizon` [s] after restarts from smoothed measured states; x: (R, p)."""

    def ends(run: int, start: Restarts) -> Array:
        return start.predict(hypothesis, x[run])[:, -1]

    return errors_of(run_set, weight, horizon, ends)


def boat_file_errors(run_set: RunSet, weight: Array, horizon: float) -> Errors:
    """Errors of the boat file alone."""
    return errors_at(run_set, weight, horizon, Hypothesis(), np.zeros((len(run_set.lengths), 0)))


def errors_of(
    run_set: RunSet, weight: Array, horizon: float, ends: Callable[[int, "Restarts"], Array]
) -> Errors:
    """Errors `horizon` [s] after restarts; ends: (n, 6) predicted measurements of a run's restarts."""
    error, run_of, end = [np.zeros((0, len(CHANNELS)))], [np.zeros(0, int)], [np.zeros(0)]
    for run in range(len(run_set.lengths)):
        start = restarts(run_set, weight, run, horizon)
        if start is None:
            continue
        last = start.first + start.steps
        measured = np.where(weight[run, last] > 0, run_set.measured[run, last], np.nan)
        apart = measured - ends(run, start)
        apart[:, 2] = within_half_turn(apart[:, 2])
        error.append(apart)
        run_of.append(np.full(len(last), run))
        end.append(np.asarray(last * run_set.dt, dtype=float))
    return Errors(np.concatenate(error), np.concatenate(run_of), np.concatenate(end))


@dataclass(frozen=True)
class Restarts:
    """Where predictions start: first (n,) samples; steps of each; states (n, 6), smoothed, as CHANNELS."""

    problem: Shooting
    first: NDArray[np.int64]
    steps: int
    states: Array

    def predict(self, hypothesis: Hypothesis, x: Array) -> Array:
        """(n, steps + 1, 6) what the sensors would say under x (p,)."""
        run_set, run = self.problem.run_set, self.problem.windows.run
        records = hypothesis.records(self.problem.boat, x[None], runs=run_set.origins[run])
        of_earth = np.array(run_set.of_earth)[run] if run_set.of_earth else False
        time = np.asarray(self.first * self.problem.dt, dtype=float)
        states = true_motion(self.states, records, time, of_earth)
        return self.problem.track(hypothesis, x, states)

    def part(self, chosen: NDArray[np.bool_]) -> "Restarts":
        """Some of them (n,)."""
        return Restarts(self.problem.part(chosen), self.first[chosen], self.steps, self.states[chosen])


def restarts(run_set: RunSet, weight: Array, run: int, horizon: float) -> Restarts | None:
    """Of one run, for predictions of `horizon` [s]; None for a run too short."""
    steps = round(horizon / run_set.dt)
    every = max(1, round(max(horizon, options().restart) / run_set.dt))
    first = np.arange(int(run_set.first_compared[run]), int(run_set.lengths[run]) - steps, every)
    if len(first) == 0:
        return None
    count, nothing = len(first), np.zeros((len(first), steps + 1, len(CHANNELS)))
    windows = Windows(np.zeros(count, int), first, np.full(count, steps), nothing, nothing, 0, steps + 1)
    problem = Shooting(run_set.subset([run]), weight[run : run + 1], horizon, windows)
    return Restarts(problem, first, steps, problem.initial_states())


def blocks_of(errors: Errors, horizon: float) -> tuple[NDArray[np.int64], str]:
    """(n,) block of each restart, and the name of the blocks.

    Neighbouring restarts are correlated. Whole runs are resampled where there are `enough_runs`, else
    stretches of a run.
    """
    if len(np.unique(errors.run)) >= options().enough_runs:
        return errors.run, "runs"
    seconds = max(options().stretch, 2.0 * horizon)
    place = np.stack([errors.run, (errors.end // seconds).astype(int)], axis=1)
    _, block = np.unique(place, axis=0, return_inverse=True)
    return np.asarray(block.reshape(-1), dtype=int), f"stretches of {seconds:g} s"


def change(before: Array, after: Array, block: NDArray[np.int64], rng: np.random.Generator) -> Paired | None:
    """Root mean square errors before and after, and the interval of their difference, of errors (n, k) in
    blocks (n,); None for fewer than two blocks.

    Percentile bootstrap over blocks, expanded to the width of Student's t for few blocks (Hesterberg 2015,
    10.1080/00031305.2015.1089789).
    """
    good = np.isfinite(before).all(axis=1) & np.isfinite(after).all(axis=1)
    names, place = np.unique(block[good], return_inverse=True)
    count = len(names)
    if count < 2:
        return None
    sums = np.zeros((3, count))
    np.add.at(sums[0], place, (before[good] ** 2).sum(axis=1))
    np.add.at(sums[1], place, (after[good] ** 2).sum(axis=1))
    np.add.at(sums[2], place, 1.0)
    picked = sums @ rng.multinomial(count, np.full(count, 1.0 / count), options().error_resamples).T
    roots = np.sqrt(picked[:2] / picked[2])
    tail = 100.0 * expanded_tail(count)
    low, high = np.percentile(roots[0] - roots[1], [tail, 100.0 - tail])
    whole = np.sqrt(sums[:2].sum(axis=1) / sums[2].sum())
    return Paired(before=float(whole[0]), after=float(whole[1]), ci95=(float(low), float(high)))


def expanded_tail(count: int) -> float:
    """Probability cut from each end of a percentile bootstrap of `count` blocks."""
    from scipy.special import ndtr, stdtrit

    return float(ndtr(math.sqrt(count / (count - 1)) * stdtrit(count - 1, options().tail)))


def trivial_predictors(run_set: RunSet, weight: Array) -> list[Predictors]:
    """Position errors of the boat file and of three trivial predictors at every horizon that the runs hold.

    weight: (R, T, 6).
    """
    found = []
    for horizon in options().horizons:
        own = boat_file_errors(run_set, weight, horizon)
        if not np.isfinite(own.error[:, :2]).all(axis=1).any():
            continue
        found.append(
            Predictors(
                horizon_s=horizon,
                boat_file=position_rmse(own),
                at_rest=position_rmse(errors_of(run_set, weight, horizon, _at_rest)),
                constant_velocity=position_rmse(errors_of(run_set, weight, horizon, _constant_velocity)),
                no_thrust=position_rmse(errors_of(run_set, weight, horizon, _no_thrust)),
            )
        )
    return found


@dataclass(frozen=True)
class NoBetter:
    """A trivial predictor (its key in TRIVIAL), that a boat file is no better than, and both errors [m] at
    that horizon.
    """

    horizon_s: float
    name: str
    boat_file: float
    trivial: float

    @property
    def words(self) -> str:
        """What the boat file predicts."""
        return (
            f"positions {self.horizon_s:g} s ahead no better than {TRIVIAL[self.name]}: "
            f"{self.boat_file:.3g} m against {self.trivial:.3g} m"
        )


def no_better(predictors: Sequence[Predictors]) -> NoBetter | None:
    """At the shortest horizon at which the boat file is no better than a trivial predictor: the best of
    these."""
    for one in predictors:
        errors = {name: float(getattr(one, name)) for name in TRIVIAL}
        best = min(errors, key=errors.__getitem__)
        if one.horizon_s >= options().trivial_from and errors[best] <= one.boat_file:
            return NoBetter(one.horizon_s, best, one.boat_file, errors[best])
    return None


def _at_rest(run: int, start: Restarts) -> Array:
    """(n, 6): the boat stays where it is."""
    return np.concatenate([start.states[:, :3], np.zeros((len(start.states), 3))], axis=1)


def _constant_velocity(run: int, start: Restarts) -> Array:
    """(n, 6): straight on at the velocity over ground, turning at the yaw rate."""
    states = start.states.copy()
    seconds = start.steps * start.problem.dt
    surge, sway, yaw_rate = states[:, 3:].T
    north, east = turned(surge, sway, states[:, 2])
    states[:, 0] += seconds * north
    states[:, 1] += seconds * east
    states[:, 2] += seconds * yaw_rate
    return states


def _no_thrust(run: int, start: Restarts) -> Array:
    """(n, 6): the boat file with all thrusters stopped."""
    problem = start.problem.with_commands(without_thrust(start.problem.run_set))
    return replace(start, problem=problem).predict(Hypothesis(), np.zeros(0))[:, -1]


def without_thrust(run_set: RunSet) -> RunSet:
    """The runs with all thrusters stopped."""
    commands = run_set.commands.copy()
    commands[..., commands.shape[2] // 2 :] = 0.0
    return replace(run_set, commands=commands, within=None, instants=None)


def position_rmse(errors: Errors) -> float:
    """Root mean square of the distance [m]."""
    squares = (errors.error[:, :2] ** 2).sum(axis=1)
    return float(np.sqrt(np.nanmean(squares)))

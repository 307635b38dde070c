"""Prediction error by horizon, before and after, on runs that the numbers were not fitted to."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.data import CHANNELS, Trials
from swamp_rl.criticism.result import Gain, Paired
from swamp_rl.criticism.shooting import SETTLING, Shooting, Windows, wrap
from swamp_rl.simulator.sensors import true_pose

Array = NDArray[np.float64]

HORIZONS = (1.0, 5.0, 10.0, 30.0)  # s
RESTART = 5.0  # s between restarts, where the horizon is not longer
RESAMPLES = 4000
ENOUGH_RUNS = 4  # runs that are blocks enough; with fewer, each is cut in stretches
STRETCH = 20.0  # s of a stretch, or two horizons where that is longer
QUANTITIES = {
    "position_rmse_m": [0, 1],
    "heading_rmse_rad": [2],
    "surge_rmse_m_s": [3],
    "sway_rmse_m_s": [4],
    "yaw_rate_rmse_rad_s": [5],
}


@dataclass(frozen=True)
class Errors:
    """error: (n, 6) measured less predicted, in the order of CHANNELS, NaN where nothing was measured; run:
    (n,); end: (n,) instant in its run [s].
    """

    error: Array
    run: NDArray[np.int64]
    end: Array


def gains(
    trials: Trials, weight: Array, hypothesis: Hypothesis, numbers: Array, rng: np.random.Generator
) -> list[Gain]:
    """Errors under the boat file and under a hypothesis at every horizon that the runs hold.

    weight: (R, T, 6); numbers: (R, p), each run's own, which its own data had no part in.
    """
    none = np.zeros((len(trials.lengths), 0))
    found = []
    for horizon in HORIZONS:
        before = errors_at(trials, weight, horizon, Hypothesis(), none)
        after = errors_at(trials, weight, horizon, hypothesis, numbers)
        block, called = blocks_of(before, horizon)
        kept = {
            name: paired
            for name, columns in QUANTITIES.items()
            if (paired := change(before.error[:, columns], after.error[:, columns], block, rng))
        }
        found.append(Gain(horizon_s=horizon, restarts=len(block), blocks=called, **kept))
    return found


def errors_at(trials: Trials, weight: Array, horizon: float, hypothesis: Hypothesis, x: Array) -> Errors:
    """At the end of `horizon` [s], restarted from smoothed measured states; x: (R, p)."""
    error, run_of, end = [np.zeros((0, len(CHANNELS)))], [np.zeros(0, int)], [np.zeros(0)]
    for run in range(len(trials.lengths)):
        found = restarted(trials, weight, run, horizon, hypothesis, x[run])
        if found is None:
            continue
        first, prediction = found
        last = first + prediction.shape[1] - 1
        measured = np.where(weight[run, last] > 0, trials.measured[run, last], np.nan)
        apart = measured - prediction[:, -1]
        apart[:, 2] = wrap(apart[:, 2])
        error.append(apart)
        run_of.append(np.full(len(first), run))
        end.append(last * trials.dt)
    return Errors(np.concatenate(error), np.concatenate(run_of), np.concatenate(end))


def restarted(
    trials: Trials, weight: Array, run: int, horizon: float, hypothesis: Hypothesis, x: Array
) -> tuple[NDArray[np.int64], Array] | None:
    """First samples (n,) and what the sensors would say from there on (n, T + 1, 6); None for a run too
    short. x: (p,).
    """
    one = trials.subset([run])
    windows = _restarts(one, horizon)
    if windows is None:
        return None
    problem = Shooting(one, weight[run : run + 1], horizon, windows)
    records = np.repeat(hypothesis.records(trials.boat, x[None]), windows.count)
    states = problem.guess()
    states[:, :3] = true_pose(states[:, :3], states[:, 3:], records)
    return windows.first, problem.predict(hypothesis, x[None], states[None])[0]


def _restarts(trials: Trials, horizon: float) -> Windows | None:
    steps = round(horizon / trials.dt)
    every = max(1, round(max(horizon, RESTART) / trials.dt))
    first = np.arange(math.ceil(SETTLING / trials.dt), int(trials.lengths[0]) - steps, every)
    if len(first) == 0:
        return None
    nothing = np.zeros((len(first), steps + 1, len(CHANNELS)))
    return Windows(
        np.zeros(len(first), int), first, np.full(len(first), steps), nothing, nothing, 0, steps + 1
    )


def blocks_of(errors: Errors, horizon: float) -> tuple[NDArray[np.int64], str]:
    """(n,) which block each restart is of, and what the blocks are called.

    Neighbouring restarts share weather and manoeuvre, so they are no independent evidence: whole runs are
    resampled where there are four or more, else stretches of a run.
    """
    if len(np.unique(errors.run)) >= ENOUGH_RUNS:
        return errors.run, "runs"
    seconds = max(STRETCH, 2.0 * horizon)
    place = np.stack([errors.run, (errors.end // seconds).astype(int)], axis=1)
    _, block = np.unique(place, axis=0, return_inverse=True)
    return np.asarray(block.reshape(-1), dtype=int), f"stretches of {seconds:g} s"


def change(before: Array, after: Array, block: NDArray[np.int64], rng: np.random.Generator) -> Paired | None:
    """Of errors (n, k) in one quantity at n restarts, block by block (n,); None where fewer than two blocks
    hold any.

    The interval is the bootstrap's percentile interval, expanded to the width that Student's t gives so few
    blocks (Hesterberg 2015, 10.1080/00031305.2015.1089789).
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
    picked = sums @ rng.multinomial(count, np.full(count, 1.0 / count), RESAMPLES).T
    roots = np.sqrt(picked[:2] / picked[2])
    tail = 100.0 * expanded_tail(count)
    low, high = np.percentile(roots[0] - roots[1], [tail, 100.0 - tail])
    whole = np.sqrt(sums[:2].sum(axis=1) / sums[2].sum())
    return Paired(before=float(whole[0]), after=float(whole[1]), ci95=(float(low), float(high)))


def expanded_tail(count: int, tail: float = 0.025) -> float:
    """The share to cut from each end of a percentile bootstrap of `count` blocks."""
    from scipy.special import ndtr, stdtrit

    return float(ndtr(math.sqrt(count / (count - 1)) * stdtrit(count - 1, tail)))

"""Self-trial: how often a diagnosis finds its own answer in twins of the measured runs."""

import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.measurement_noise import repeated_samples
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.inference.finding import Finding
from swamp_rl.criticism.inference.linearised_selection import linearised_answers
from swamp_rl.criticism.likelihood.gauss_markov import SECONDS, SIZE, WHITE
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.nuisance.smoothed_channels import third_difference_variance
from swamp_rl.criticism.options import DEFAULT
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.result import SelfTrial, SmoothedNoise
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.continuation import Continuation, states_carried
from swamp_rl.criticism.selection.model_selection import select_model
from swamp_rl.criticism.selection.preparation import prepared
from swamp_rl.effects import LIBRARY
from swamp_rl.one_thread import one_thread

Array = NDArray[np.float64]
Work = Callable[[str], str]
Method = Literal["linearised", "search"]
Each = Callable[[Work, Sequence[str]], Iterable[str]]
"""Does a work on every job, perhaps in other processes, and returns the results in the jobs' order."""

TWINS = DEFAULT.twins
NOTHING, UNEXPLAINED = "nothing", "unexplained"
OMITTED = "No set of effects explains the runs, so there is no answer to simulate twins from."


@dataclass(frozen=True)
class SensorNoise:
    """The noise of six channels (SI, rad).

    white: (6,) standard deviation of the white part; process: (P, 6, 2) standard deviations and time
    constants [s] of independent Gauss-Markov parts that are added to it.
    """

    white: Array
    process: Array

    def drawn(self, rng: np.random.Generator, runs: int, rows: int, dt: float) -> Array:
        """(R, T, 6) noise in rows of dt [s], each run begun in the stationary distribution."""
        found = self.white * rng.standard_normal((runs, rows, len(CHANNELS)))
        for size, seconds in np.moveaxis(self.process, 2, 1):
            found += gauss_markov(rng.standard_normal(found.shape), size, seconds, dt)
        return found


def gauss_markov(fresh: Array, size: Array, seconds: Array, dt: float) -> Array:
    """(R, T, 6) first-order Gauss-Markov processes of standard deviation `size` (6,) and time constant
    `seconds` (6,), from independent standard normal values.
    """
    from scipy.signal import lfilter

    found = np.zeros_like(fresh)
    for channel in np.flatnonzero(size > 0.0):
        keep = math.exp(-dt / max(float(seconds[channel]), 1e-9))
        driven = fresh[..., channel] * size[channel] * math.sqrt(1.0 - keep**2)
        driven[:, 0] = fresh[:, 0, channel] * size[channel]
        found[..., channel] = lfilter([1.0], [1.0, -keep], driven, axis=1)
    return found


def sensor_noise(
    sigmas: Array, smoothed: Mapping[str, SmoothedNoise], gauss_markov: Array | None, dt: float
) -> SensorNoise:
    """The noise that a diagnosis estimated.

    sigmas: (6,) by channel, NaN where nothing was measured; smoothed: channels whose noise is white noise
    behind a filter of first order; gauss_markov: (6, 3) as in `RunSet`.
    """
    white = np.where(np.isfinite(sigmas), sigmas, 0.0)
    filtered = np.zeros((len(CHANNELS), 2))
    for channel, name in enumerate(CHANNELS):
        if name in smoothed:
            one = smoothed[name]
            pole = math.exp(-dt / one.time_constant_s)
            power = 20 * one.sample_noise**2 / third_difference_variance(pole, 1)
            white[channel], filtered[channel] = 0.0, (math.sqrt(power), one.time_constant_s)
    parts = [filtered] if smoothed else []
    if gauss_markov is not None:
        white, parts = white * gauss_markov[:, WHITE], [*parts, gauss_markov[:, [SIZE, SECONDS]]]
    return SensorNoise(white, np.array(parts).reshape(-1, len(CHANNELS), 2))


def without_noise(logged: RunSet, judged: Shooting, answer: Fit) -> RunSet:
    """The runs as the answer predicts them from their first initial states on, unbroken and without noise.

    logged: the measured runs; judged: the windows that the answer was fitted to. What was not measured is
    missing here too, and the rows before the first that is compared with a simulation are the measured ones.
    """
    runs = replace(judged.run_set, gaps=(), gauss_markov=None)
    unbroken = Shooting(runs, judged.weight, np.inf)
    states = states_carried(judged, answer.states, unbroken, unbroken.initial_states())
    track = unbroken.track(answer.hypothesis, answer.x, states)
    measured, windows = logged.measured.copy(), unbroken.windows
    for run, first, steps, predicted in zip(windows.run, windows.first, windows.steps, track, strict=True):
        part = slice(first, first + steps + 1)
        measured[run, part] = np.where(np.isfinite(measured[run, part]), predicted[: steps + 1], np.nan)
    return replace(logged, measured=measured, gauss_markov=None)


def with_noise(logged: RunSet, ideal: RunSet, noise: Array) -> RunSet:
    """The runs `ideal` with noise (R, T, 6) where simulated, and samples repeated as in the runs `logged`."""
    simulated = ideal.measured != logged.measured
    measured = np.where(simulated, ideal.measured + noise, ideal.measured)
    fresh = ~repeated_samples(logged.measured)
    rows = np.arange(measured.shape[1])[:, None]
    last = np.maximum.accumulate(np.where(fresh, rows, 0), axis=1)
    return replace(ideal, measured=np.take_along_axis(measured, last, axis=1))


@dataclass(frozen=True)
class Twins:
    """What twins are drawn from. logged: the measured runs; ideal: the same as the answer predicts them."""

    logged: RunSet
    ideal: RunSet
    noise: SensorNoise
    seed: int

    def run_set(self, number: int) -> RunSet:
        """A twin as measured runs."""
        noise = noise_of(self.logged, self.noise, self.seed, number)
        return with_noise(self.logged, self.ideal, noise)


def noise_of(logged: RunSet, noise: SensorNoise, seed: int, number: int) -> Array:
    """(R, T, 6) noise of a twin of the measured runs, from a generator of its own."""
    rng = np.random.default_rng([seed, number])
    runs, rows, _ = logged.measured.shape
    return noise.drawn(rng, runs, rows, logged.dt)


def serially(work: Work, jobs: Sequence[str]) -> list[str]:
    """Every job in this process."""
    return [work(job) for job in jobs]


def self_trial(
    logged: RunSet, finding: Finding, twins: int, method: Method, seed: int, each: Each
) -> SelfTrial:
    """How often the same causes are named again, in so many twins of the answer to the runs `logged`.

    each: has the searches of method `search` done.
    """
    found = finding.diagnosis
    if found.verdict == "unexplained":
        return SelfTrial(named=0, of=0, method=method, omitted=OMITTED)
    LOG.info("%d twins of the answer", twins)
    answers = twin_answers(logged, finding.continuation, finding.selection, twins, method, seed, each)
    minor = {cause.label for cause in found.minor}
    own = causes_in(finding.selection.winner.hypothesis.label, minor)
    counted = Counter(causes_in(answer, minor) for answer in answers)
    named = counted.pop(own, 0)
    return SelfTrial(named=named, of=twins, confused_with=dict(counted.most_common()), method=method)


def causes_in(label: str, minor: Collection[str] = ()) -> str:
    """The label of a hypothesis without minor causes, and without a nuisance beside other effects."""
    parts = [part for part in label.split(" + ") if part not in minor] if label != NOTHING else []
    named = [part for part in parts if part == UNEXPLAINED or not LIBRARY[part.split()[0]].nuisance]
    return " + ".join(named or parts) or NOTHING


def twin_answers(
    logged: RunSet,
    continuation: Continuation,
    found: Selection,
    twins: int = TWINS,
    method: Method = "linearised",
    seed: int = 0,
    each: Each = serially,
) -> list[str]:
    """The label of the hypothesis that each twin selects, minor causes and nuisances among its effects."""
    judged = continuation.problem(found.stage, found.winner.hypothesis)
    known = prepared(logged)
    noise = sensor_noise(known.sigmas, known.smoothed, judged.run_set.gauss_markov, logged.dt)
    if method == "linearised":
        noises = [noise_of(logged, noise, seed, number) for number in range(twins)]
        return [one.label for one in linearised_answers(continuation, found, noises, known.instances)]
    drawn = Twins(logged, without_noise(logged, judged, found.winner), noise, seed)
    answers = []
    for number, answer in enumerate(each(partial(searched, drawn), [str(one) for one in range(twins)]), 1):
        LOG.info("twin %d of %d: %s", number, twins, answer)
        answers.append(answer)
    return answers


@np.errstate(over="ignore", invalid="ignore")  # where a hypothesis makes the boat diverge
def searched(twins: Twins, number: str) -> str:
    """The label that a whole search selects for a twin."""
    with one_thread():
        runs = twins.run_set(int(number))
        known = prepared(runs)
        _, _, found = select_model(runs, known.weight, known.instances, known.hull)
        return found.winner.hypothesis.label if found.adequate else UNEXPLAINED

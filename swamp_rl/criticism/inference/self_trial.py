"""Self-trial: how often a diagnosis finds its own answer in twins of the measured runs."""

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.finding import Finding
from swamp_rl.criticism.inference.linearised_selection import linearised_answers
from swamp_rl.criticism.inference.twins import SensorNoise, sensor_noise, with_noise, without_noise
from swamp_rl.criticism.options import DEFAULT
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.result import SelfTrial
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.continuation import Continuation
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

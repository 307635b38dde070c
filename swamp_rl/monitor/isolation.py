"""Fault isolation: the effect and its onset whose signature in the innovations is the most likely.

Generalised likelihood ratio (Willsky and Jones 1976): a fault that begins at a known time changes the
innovations of a linear filter by a known sequence, its signature, times its size. Its fall of chi2 is what
the size of greatest likelihood gains.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, instances_of
from swamp_rl.effects import LIBRARY
from swamp_rl.monitor.options import DEFAULT, Options
from swamp_rl.monitor.signature import signatures, white_of
from swamp_rl.monitor.tracker import Step

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Onset:
    """An effect that began at the time of a step of the filter. x: (p,) its size; gain: fall of chi2; left:
    chi2 that remains, over `rows` innovations.
    """

    instance: EffectInstance
    time: float
    place: int
    x: Array
    gain: float
    left: float
    rows: int

    @property
    def criterion(self) -> float:
        """Fall of chi2 less two for each size that was fitted, as Akaike's criterion charges."""
        return self.gain - 2.0 * free(self.instance)


def nested(one: Onset, other: Onset) -> bool:
    """Whether of two effects on one thruster one has no size, as the limit of the other."""
    same = one.instance.selectors == other.instance.selectors != ()
    return same and min(free(one.instance), free(other.instance)) == 0


def simplest(found: Sequence[Onset], within: float) -> Onset:
    """The first onset, or one that is nested in it, has no size and is no more than `within` behind."""
    first = found[0]
    limits = [other for other in found if nested(first, other) and not free(other.instance)]
    return next((other for other in limits if first.criterion - other.criterion <= within), first)


def onset_candidates(boat: Boat) -> list[EffectInstance]:
    """Effects of the library that may begin while the boat sails, on each thruster."""
    sudden = [effect for effect in LIBRARY.values() if effect.sudden]
    return [instance for effect in sudden for instance in instances_of(effect, boat)]


def free(instance: EffectInstance) -> int:
    """Sizes that are fitted: none of an effect that only has an instant."""
    return 0 if instance.effect.begin == "changepoint" else instance.size


def isolate(
    boat: Boat,
    record: NDArray[Any],
    history: Sequence[Step],
    instances: Sequence[EffectInstance],
    dt: float,
    options: Options = DEFAULT,
) -> list[Onset]:
    """The best onset of every candidate, the greatest criterion first: onsets `onsets` apart for all, then
    every step about the best for the first `leaders`.
    """
    stride = max(1, round(options.onsets / dt))
    best: dict[str, Onset] = {}

    def consider(places: Sequence[int], of: Sequence[EffectInstance], iterations: int) -> None:
        for place in places:
            for found in _from(boat, record, history, of, place, dt, iterations, options):
                label = found.instance.label
                if label not in best or found.gain > best[label].gain:
                    best[label] = found

    last = len(history) - 2
    consider(range(0, last, stride), instances, 1)
    for leader in sorted(best.values(), key=lambda one: -one.criterion)[: options.leaders]:
        near = range(max(0, leader.place - stride + 1), min(last, leader.place + stride))
        consider(near, [leader.instance], options.iterations)
    return sorted(best.values(), key=lambda one: -one.criterion)


def _from(
    boat: Boat,
    record: NDArray[Any],
    history: Sequence[Step],
    instances: Sequence[EffectInstance],
    place: int,
    dt: float,
    iterations: int,
    options: Options,
) -> list[Onset]:
    """Every candidate with its onset at one step, its size by Gauss-Newton from neutral, in so many steps at
    most, of each the share that leaves the least chi2.
    """
    window = list(history)[place:]
    white, rows = white_of(window), sum(step.taken for step in window[1:])
    sizes = [neutral_x(instance, window[0].time) for instance in instances]
    sized = [i for i, instance in enumerate(instances) if free(instance)]

    def changes(tried: Sequence[tuple[EffectInstance, Array]]) -> Array:
        every = np.repeat(record, 1 + sum(len(xs) for _, xs in tried))
        begin = 1
        for instance, xs in tried:
            every[begin : begin + len(xs)] = Hypothesis((instance,)).records(boat, xs, record)
            begin += len(xs)
        return signatures(boat, every, window, dt)

    own = np.zeros((len(instances), len(white)))
    left = np.full(len(instances), white @ white)
    for _ in range(iterations if sized else 0):
        steps = {i: moved(instances[i], sizes[i]) for i in sized}
        there = iter(changes([(instances[i], steps[i]) for i in sized]))
        tried = {}
        for i in sized:
            added = np.array([next(there) for _ in steps[i]]) - own[i]
            slopes = (added / np.diag(steps[i] - sizes[i])[:, None]).T
            change = np.linalg.lstsq(slopes, white - own[i], rcond=1e-9)[0]
            low, high = np.array([(spec.low, spec.high) for spec in instances[i].specs]).T
            tried[i] = np.clip(sizes[i] + np.outer(options.shares, change), low, high)
        there, before = iter(changes([(instances[i], tried[i]) for i in sized])), left.sum()
        for i in sized:
            for x in tried[i]:
                added = next(there)
                if (rest := float(np.sum((white - added) ** 2))) < left[i]:
                    sizes[i], own[i], left[i] = x, added, rest
        if before - left.sum() < options.converged:
            break
    others = [i for i in range(len(instances)) if i not in sized]
    if others:
        own[others] = changes([(instances[i], sizes[i][None]) for i in others])
        left[others] = np.sum((white - own[others]) ** 2, axis=1)
    gain = float(white @ white) - left
    return [
        Onset(instance, window[0].time, place, sizes[i], float(gain[i]), float(left[i]), rows)
        for i, instance in enumerate(instances)
    ]


def moved(instance: EffectInstance, x: Array) -> Array:
    """(p, p) sizes x (p,), each moved by a typical one within its bounds."""
    below = np.array([x[i] - spec.scale >= spec.low for i, spec in enumerate(instance.specs)])
    return x + np.diag(np.where(below, -1.0, 1.0) * [spec.scale for spec in instance.specs])


def neutral_x(instance: EffectInstance, onset: float) -> Array:
    """(p,) sizes that change nothing; of an effect that only has an instant, the onset [s]."""
    if not free(instance):
        return np.array([onset])
    names = instance.effect.parameter_names
    return np.array([instance.effect.parameter(name).neutral or 0.0 for name in names], dtype=float)

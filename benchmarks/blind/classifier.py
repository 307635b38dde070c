"""How often the Bayes classifier names a small effect, on the linearised Gaussian problem of a blind case.

The measurement is linearised about the boat file: r = S_i theta_i + e with S_i the sensitivities by the
parameters of candidate i over the noise, the initial state of each run projected out, and e of unit
covariance. Candidates have unit-information priors (Kass and Wasserman 1995), so that the posterior
probability of candidate i is proportional to exp((r' P_i r - k_i ln n) / 2), P_i being the projection onto
S_i, and that of no effect is as large as that of all candidates together. Only the case's truth is used: its
commands, its noise, its effect. Under other priors or other commands in lost rows a diagnosis may do better.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.synthetic.cases import DT, Array, Case, Rng, deviations, measure, voyages

from benchmarks.blind.bound import START_STEP, STATES, STEPS, away_from_neutral, numbers_of
from swamp_rl.boat import Boat, load_boat
from swamp_rl.criticism.model.candidates import EffectInstance, candidates, entry_of, neutral_of
from swamp_rl.effects import EffectEntry, apply_effects, parse_effects
from swamp_rl.simulator import parameters, tank
from swamp_rl.simulator.sensors import observe
from swamp_rl.simulator.step import simulate

SHARE = 1e-3  # of a typical size, of finite differences
DRAWS = 400  # of the noise
MOST_NAMED = 3  # explanations in a set that still counts as an answer
NO_DIRECTION = 1e-9  # of the largest eigenvalue of a candidate's information


@dataclass(frozen=True)
class Rates:
    """Shares of draws in which the classifier names the truth: alone in rank, and among its best three; in
    both cases no effect is less probable than the truth.
    """

    first: float
    among_three: float


@dataclass(frozen=True)
class Column:
    """A pair of boats (2,) whose predictions differ by twice `step` in a parameter."""

    records: NDArray[Any]
    step: float


def classifier_rates(case: Case, rng: Rng, velocities: bool, runs: int = 5, seconds: float = 80.0) -> Rates:
    """Of a case with one effect, whose runs `rng` draws as `write_case` draws them."""
    boat, noise = load_boat("swamp"), deviations(case.level).copy()
    if not velocities:
        noise[3:5] = np.inf
    (entry,) = parse_effects(case.effects, "truth", boat.thruster_names)
    others = [one for one in candidates(boat, seconds) if _is_smooth(one) and not _is_the_same(one, entry)]
    columns = [columns_of_truth(boat, entry), *(columns_of(boat, one) for one in others)]
    flat = [column for one in columns for column in one]
    gram, samples = np.zeros((len(flat), len(flat))), 0
    for voyage in voyages(case, rng, runs, seconds):
        kept = measure(voyage, noise, rng)[1]
        slopes = sensitivities(boat, flat, voyage.track[:1], voyage.commands, kept, noise)
        gram += slopes @ slopes.T
        samples += int(kept.sum()) * int(np.isfinite(noise).sum())
    away = np.array([away_from_neutral(entry, name) for _, name in numbers_of([entry])])
    return _rates(gram, [len(one) for one in columns], away, samples)


def _is_smooth(instance: EffectInstance) -> bool:
    return instance.size > 0 and instance.effect.begin in ("score", "grid") and not instance.groups


def _is_the_same(instance: EffectInstance, entry: EffectEntry) -> bool:
    selected = {instance.selectors[0] if instance.selectors else None}
    return instance.effect.name == entry.effect.name and entry.thruster in selected


def columns_of_truth(boat: Boat, entry: EffectEntry) -> list[Column]:
    """Of the true effect, about its true parameters."""
    found = []
    for name in entry.effect.parameter_names:
        value = float(entry.values[name])
        step = STEPS.get(name, max(SHARE * abs(value), 1e-4))
        sides = [
            EffectEntry(entry.effect, entry.thruster, dict(entry.values) | {name: value + side})
            for side in (step, -step)
        ]
        found.append(Column(_records(boat, sides), step))
    return found


def columns_of(boat: Boat, instance: EffectInstance) -> list[Column]:
    """Of a candidate about its neutral values, or as near to them as its bounds allow."""
    steps = np.array(
        [
            STEPS.get(p.name, SHARE * s.scale)
            for p, s in zip(instance.effect.parameters, instance.specs, strict=True)
        ]
    )
    neutral = np.zeros(instance.size)
    if not instance.effect.vector:
        neutral = np.array([neutral_of(parameter, boat) for parameter in instance.effect.parameters])
    low, high = (np.array([getattr(s, side) for s in instance.specs]) for side in ("low", "high"))
    middle = np.clip(neutral, low + steps, high - steps)
    found = []
    for i, step in enumerate(steps):
        change = np.zeros(instance.size)
        change[i] = step
        sides = [entry_of(instance, middle + side) for side in (change, -change)]
        found.append(Column(_records(boat, sides), float(step)))
    return found


def _records(boat: Boat, entries: Sequence[EffectEntry]) -> NDArray[Any]:
    made = []
    for entry in entries:
        record = parameters(boat)
        apply_effects(record, [entry], boat.thruster_names)
        made.append(record)
    return np.concatenate(made)


def sensitivities(
    boat: Boat, columns: Sequence[Column], start: Array, commands: Array, kept: Array, noise: Array
) -> Array:
    """(p, M) by the columns' parameters, the initial state of the run projected out."""
    plain = np.repeat(parameters(boat), 2 * STATES)
    every = np.concatenate([*(column.records for column in columns), plain])
    starts = np.repeat(start, len(every), axis=0)
    first = 2 * len(columns)
    for k in range(STATES):
        starts[first + 2 * k, k] += START_STEP
        starts[first + 2 * k + 1, k] -= START_STEP
    given = np.repeat(commands[None, :-1], len(every), axis=0)
    track = simulate(every, tank(boat), starts, given, np.zeros(len(every), np.uint64), DT, 2)
    seen = observe(track, every, DT)[:, kept] / noise
    steps = np.array([*(column.step for column in columns), *[START_STEP] * STATES])
    slopes = (seen[0::2] - seen[1::2]).reshape(len(steps), -1) / (2.0 * steps[:, None])
    basis = np.linalg.qr(slopes[len(columns) :].T)[0]
    by_parameter = slopes[: len(columns)]
    return np.asarray(by_parameter - (by_parameter @ basis) @ basis.T)


def _rates(gram: Array, sizes: Sequence[int], away: Array, samples: int) -> Rates:
    """From the information between all columns (p, p), the truth's first; sizes: columns of each
    candidate.
    """
    ends = np.cumsum(sizes)
    scale = np.sqrt(np.maximum(np.diag(gram), 1e-30))
    scaled = gram / np.outer(scale, scale)
    values, vectors = np.linalg.eigh(scaled)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    rng = np.random.default_rng(0)
    mean = scaled[:, : sizes[0]] @ (away * scale[: sizes[0]])
    drawn = mean + rng.standard_normal((DRAWS, len(scaled))) @ root.T
    posterior = np.empty((len(sizes), DRAWS))
    for i, (size, end) in enumerate(zip(sizes, ends, strict=True)):
        own = slice(end - size, end)
        inverse = np.linalg.pinv(scaled[own, own], rcond=NO_DIRECTION, hermitian=True)
        gain = np.einsum("di,ij,dj->d", drawn[:, own], inverse, drawn[:, own])
        posterior[i] = 0.5 * (gain - size * np.log(samples))
    rank = (posterior > posterior[0]).sum(axis=0)
    there = posterior[0] > np.log(len(sizes))
    return Rates(float(((rank == 0) & there).mean()), float(((rank < MOST_NAMED) & there).mean()))

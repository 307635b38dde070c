"""Cramér-Rao bound of a blind case: the least standard errors of its parameters, from the truth alone.

The Fisher information is from finite differences of the true boat's simulation over the true noise (Kay,
Fundamentals of Statistical Signal Processing, volume I, 3.9). Unknown are each run's initial state (six
numbers) and all parameters of every effect of the case; at level D also the hull's derivatives, with the
distribution that they were drawn from as prior. Nothing of the diagnosis is used.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.synthetic.cases import (
    DT,
    HULL_SPREAD,
    Array,
    Case,
    Rng,
    Voyage,
    deviations,
    measure,
    true_record,
    voyages,
)

from swamp_rl.boat import load_boat
from swamp_rl.effects import EffectEntry, apply_effects, parse_effects
from swamp_rl.simulator import tank
from swamp_rl.simulator.sensors import observe
from swamp_rl.simulator.step import simulate

STATES = 6  # of a start: pose and velocities
START_STEP = 1e-3
UNKNOWN = 1e-12  # least scaled information of a parameter
SHARE, LEAST = 1e-3, 1e-4  # finite difference against a number, and the smallest one
# What is not smooth: commands arrive in whole rows, a failure falls in one
STEPS = {"delay": 0.02, "time": 0.05}
DIRECTIONS = ("from", "phase", "frequency", "time")  # parameters that do not measure an effect's size


@dataclass(frozen=True)
class Bound:
    """names: effect and parameter of each number; deviation: (p,) least standard deviations; evidence:
    Mahalanobis distance of the effects from their neutral values.
    """

    names: list[tuple[str, str]]
    deviation: list[float]
    evidence: float


def bound_of(case: Case, rng: Rng, velocities: bool, runs: int = 5, seconds: float = 80.0) -> Bound:
    """The bound of a case whose runs `rng` draws, as `write_case` draws them."""
    noise = deviations(case.level).copy()
    if not velocities:
        noise[3:5] = np.inf
    boat = load_boat("swamp")
    entries = parse_effects(case.effects, "truth", boat.thruster_names)
    names = numbers_of(entries)
    sailed = [(voyage, measure(voyage, noise, rng)[1]) for voyage in voyages(case, rng, runs, seconds)]
    information = np.zeros((len(names) + len(case.hull),) * 2)
    for run, (voyage, kept) in enumerate(sailed):
        own = parse_effects(case.of_run(run).effects, "truth", boat.thruster_names)
        whole = _information(case.of_run(run), own, numbers_of(own), voyage, kept, noise)
        information += _shared(whole, len(names), len(numbers_of(own)))
    prior = np.concatenate([np.zeros(len(names)), np.full(len(case.hull), HULL_SPREAD**-2.0)])
    covariance = inverse(information + np.diag(prior))
    own = inverse(covariance[: len(names), : len(names)])
    away = np.array([away_from_neutral(entries[index], name) for index, name in names])
    return Bound(
        [(entries[index].effect.name, name) for index, name in names],
        [float(value) for value in np.sqrt(np.diag(covariance)[: len(names)])],
        float(np.sqrt(away @ own @ away)),
    )


def numbers_of(entries: Sequence[EffectEntry]) -> list[tuple[int, str]]:
    """Place of its entry and name of every number."""
    return [(index, name) for index, entry in enumerate(entries) for name in entry.effect.parameter_names]


def _shared(whole: Array, shared: int, numbers: int) -> Array:
    """Information of the `shared` first numbers and of the hull, those of this run alone being unknown."""
    own = np.arange(len(whole))
    own, kept = own[shared:numbers], np.delete(own, np.s_[shared:numbers])
    if not len(own):
        return whole
    cross = whole[np.ix_(kept, own)]
    return np.asarray(whole[np.ix_(kept, kept)] - cross @ np.linalg.solve(whole[np.ix_(own, own)], cross.T))


def inverse(information: Array) -> Array:
    """Of a symmetric matrix; directions without information get a huge variance."""
    scale = np.sqrt(np.maximum(np.diag(information), 1e-30))
    scaled = information / np.outer(scale, scale) + UNKNOWN * np.eye(len(scale))
    return np.asarray(np.linalg.inv(scaled) / np.outer(scale, scale))


def away_from_neutral(entry: EffectEntry, name: str) -> float:
    """Difference of a parameter from its neutral value."""
    if name in DIRECTIONS:
        return 0.0
    neutral = entry.effect.parameter(name).neutral
    if neutral is None:
        neutral = float(np.mean(true_record(load_boat("swamp"), CLEAN)[entry.effect.parameter(name).field]))
    return float(entry.values[name]) - neutral


CLEAN = Case("A", "clean", [])


def _information(
    case: Case,
    entries: Sequence[EffectEntry],
    names: list[tuple[int, str]],
    voyage: Voyage,
    kept: NDArray[np.bool_],
    noise: Array,
) -> Array:
    """(p, p) of one run, its initial state eliminated."""
    records, sizes = _records(case, entries, names)
    numbers = len(sizes)
    every = np.repeat(voyage.record, 2 * (numbers + STATES))
    every[: 2 * numbers] = records
    starts = np.repeat(voyage.track[:1], len(every), axis=0)
    for k in range(STATES):
        starts[2 * (numbers + k), k] += START_STEP
        starts[2 * (numbers + k) + 1, k] -= START_STEP
    commands = np.repeat(voyage.commands[None, :-1], len(every), axis=0)
    boat = load_boat("swamp")
    track = simulate(every, tank(boat), starts, commands, np.zeros(len(every), np.uint64), DT, 2)
    seen = observe(track, every, DT)[:, kept] / noise
    steps = np.concatenate([sizes, np.full(STATES, START_STEP)])
    slopes = (seen[0::2] - seen[1::2]).reshape(numbers + STATES, -1) / (2.0 * steps[:, None])
    whole = slopes @ slopes.T
    cross, starts_own = whole[:numbers, numbers:], whole[numbers:, numbers:]
    return np.asarray(whole[:numbers, :numbers] - cross @ np.linalg.solve(starts_own, cross.T))


def _records(
    case: Case, entries: Sequence[EffectEntry], names: list[tuple[int, str]]
) -> tuple[NDArray[Any], Array]:
    """Records (2 p,) of the true boat with each parameter a step up and a step down, and the steps (p,)."""
    boat = load_boat("swamp")
    records, sizes = [], []
    for index, name in names:
        value = float(entries[index].values[name])
        size = STEPS.get(name, max(SHARE * abs(value), LEAST))
        for side in (size, -size):
            moved = list(entries)
            values = dict(entries[index].values) | {name: value + side}
            moved[index] = EffectEntry(entries[index].effect, entries[index].thruster, values)
            record = true_record(boat, Case(case.level, case.kind, [], hull=case.hull))
            apply_effects(record, moved, boat.thruster_names)
            records.append(record)
        sizes.append(size)
    for name in case.hull:
        for side in (SHARE, -SHARE):
            scaled = case.hull | {name: case.hull[name] + side}
            records.append(true_record(boat, Case(case.level, case.kind, case.effects, hull=scaled)))
        sizes.append(SHARE)
    return np.concatenate(records) if records else np.zeros(0), np.array(sizes)

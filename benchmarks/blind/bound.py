"""The Cramér-Rao bound of a blind case: how well anyone could know its numbers, from the truth alone.

The true boat is sailed again under the commands as given, from starts and with numbers a little off. The
differences over the true noise are the Fisher information (Kay, Fundamentals of Statistical Signal
Processing, volume I, 3.9); each run's start, six numbers, is unknown, and so are all of an effect's numbers,
of every effect of the case. Where the hull is off (level D) its derivatives are unknown as well, known
beforehand as well as they were drawn. Nothing of the diagnosis is used.
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
UNKNOWN = 1e-12  # of a number's information, below which it is none
SHARE, LEAST = 1e-3, 1e-4  # finite difference against a number, and the smallest one
# What is not smooth: commands arrive in whole rows, a failure falls in one
STEPS = {"delay": 0.02, "time": 0.05}
DIRECTIONS = ("from", "phase", "frequency", "time")  # no size of an effect lies in these


@dataclass(frozen=True)
class Bound:
    """names: effect and parameter of each number; deviation: (p,) least standard deviations; evidence: how
    many standard deviations the effects lie from their neutral values, all numbers together.
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
    names = [(index, name) for index, entry in enumerate(entries) for name in entry.effect.parameter_names]
    sailed = [(voyage, measure(voyage, noise, rng)[1]) for voyage in voyages(case, rng, runs, seconds)]
    information = sum(
        (_information(case, entries, names, voyage, kept, noise) for voyage, kept in sailed),
        np.zeros((len(names) + len(case.hull),) * 2),
    )
    prior = np.concatenate([np.zeros(len(names)), np.full(len(case.hull), HULL_SPREAD**-2.0)])
    covariance = inverse(information + np.diag(prior))
    own = inverse(covariance[: len(names), : len(names)])
    away = np.array([_away(entries[index], name) for index, name in names])
    return Bound(
        [(entries[index].effect.name, name) for index, name in names],
        [float(value) for value in np.sqrt(np.diag(covariance)[: len(names)])],
        float(np.sqrt(away @ own @ away)),
    )


def inverse(information: Array) -> Array:
    """Of a symmetric matrix; what it does not tell at all comes out enormous rather than as nothing."""
    scale = np.sqrt(np.maximum(np.diag(information), 1e-30))
    scaled = information / np.outer(scale, scale) + UNKNOWN * np.eye(len(scale))
    return np.asarray(np.linalg.inv(scaled) / np.outer(scale, scale))


def _away(entry: EffectEntry, name: str) -> float:
    """By how much a number departs from what changes nothing."""
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
    """(p, p) of one run, its start projected out."""
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
    """Records (2 p,) of the true boat with each number a step up and a step down, and the steps (p,)."""
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

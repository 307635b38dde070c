"""Simulated runs of known causes with noise, and the selection of their causes."""

from dataclasses import replace
from typing import Any

import numpy as np

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.model.candidates import candidates, hull_nuisance
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.continuation import continuation_of
from swamp_rl.effects import apply_effects, parse_effects
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.sensors import observe

SIGMA = np.array([0.05, 0.05, 0.009, 0.03, 0.03, 0.005])


DT = 0.1


SECONDS = 40.0


def commands(run: int) -> np.ndarray:
    """(T, 8) of one of three manoeuvres: zig-zag, circle with changing speed, differential thrust."""
    time = np.arange(round(SECONDS / DT)) * DT
    rows = np.zeros((len(time), 8))
    if run == 0:
        azimuth = 0.5 * np.sign(np.sin(2 * np.pi * time / 9.0))
        rows[:, :4] = np.outer(azimuth, [1, 1, -1, -1])
        rows[:, 4:] = 0.8
    elif run == 1:
        rows[:, :4] = [0.4, 0.4, -0.2, -0.2]
        rows[:, 4:] = (0.6 + 0.3 * np.sin(2 * np.pi * time / 17.0))[:, None]
    else:
        beat = 0.3 * np.sin(2 * np.pi * time / 11.0)
        rows[:, 4:] = 0.6 + np.outer(beat, [1, -1, 1, -1])
    return rows


def simulated_runs(
    effects: list[dict[str, Any]], seed: int = 0, velocities: bool = True, name: str = "swamp"
) -> RunSet:
    """Three runs of 40 s with noise, of a boat that has those effects."""
    rng = np.random.default_rng(seed)
    boat = load_boat(name)
    record = parameters(boat, 3)
    apply_effects(record, parse_effects(effects, "test", boat.thruster_names), boat.thruster_names)
    given = np.array([commands(run) for run in range(3)])
    pose = np.array([[0.0, 0.0, 0.5], [5.0, -3.0, 2.5], [-4.0, 8.0, -2.0]])
    start = initial_state(record, pose)
    track = simulate(record, tank(boat), start, given[:, :-1].copy(), np.zeros(3, np.uint64), DT, 2)
    measured = observe(track, record, DT) + SIGMA * rng.standard_normal((3, given.shape[1], 6))
    if not velocities:
        measured[..., 3:5] = np.nan
    return RunSet(boat, DT, ("a", "b", "c"), given, measured, np.full(3, given.shape[1]))


def select_effects(found: RunSet, *effects: str) -> Any:
    """The selection from every candidate, or from those effects alone."""
    weight = weights(found, noise_levels(found))
    every = [a for a in candidates(found.boat, SECONDS) if not effects or a.effect.name in effects]
    return beam_search(continuation_of(found, weight), every, None if effects else hull_nuisance(found.boat))


def driven(
    effects: list[dict[str, Any]], commands: np.ndarray, surge: float, seed: int, name: str = "swamp"
) -> RunSet:
    """Runs under commands (R, T, 8), with noise, begun at a surge [m/s], of a boat that has those effects."""
    boat, runs = load_boat(name), len(commands)
    record = parameters(boat, runs)
    apply_effects(record, parse_effects(effects, "test", boat.thruster_names), boat.thruster_names)
    pose = np.array([[0.0, 0.0, 0.5], [5.0, -3.0, 2.5], [-4.0, 8.0, -2.0]])[:runs]
    start = initial_state(record, pose)
    start[:, 3] = surge
    seeds = np.zeros(runs, np.uint64)
    track = simulate(record, tank(boat), start, commands[:, :-1].copy(), seeds, DT, 2)
    noise = SIGMA * np.random.default_rng(seed).standard_normal((*commands.shape[:2], 6))
    lengths = np.full(runs, commands.shape[1])
    return RunSet(boat, DT, ("a", "b", "c")[:runs], commands, observe(track, record, DT) + noise, lengths)


def joined(first: RunSet, more: RunSet) -> RunSet:
    """The runs of both, which are of one length."""
    return replace(
        first,
        names=(*first.names, *(f"more {name}" for name in more.names)),
        commands=np.concatenate([first.commands, more.commands]),
        measured=np.concatenate([first.measured, more.measured]),
        lengths=np.concatenate([first.lengths, more.lengths]),
    )


Array = np.ndarray


def gauss_markov_noise(
    rng: np.random.Generator, shape: tuple[int, ...], size: float, seconds: float
) -> Array:
    """First-order Gauss-Markov along the second axis."""
    keep = np.exp(-DT / seconds)
    found = np.empty(shape)
    found[:, 0] = size * rng.standard_normal((shape[0], *shape[2:]))
    for row in range(1, shape[1]):
        fresh = rng.standard_normal((shape[0], *shape[2:]))
        found[:, row] = keep * found[:, row - 1] + size * np.sqrt(1.0 - keep**2) * fresh
    return found

"""Scan of frequencies for waves: the harmonic force that lowers chi2 most beside a fit."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.force_sensitivity import (
    ForceGrid,
    force_grid,
    force_normal_equations,
    force_responses,
    transitions,
)
from swamp_rl.criticism.likelihood.multiple_shooting import NO_ACCELERATION, Shooting
from swamp_rl.criticism.likelihood.normal_equations import Normal, normal_equations
from swamp_rl.criticism.likelihood.output_error import Fit, inverse
from swamp_rl.criticism.options import options
from swamp_rl.simulator.reference import reference_of

Array = NDArray[np.float64]

COMPONENTS = 4  # of a harmonic force of known frequency: sine north, sine east, cosine north, cosine east


def wave_starts(problem: Shooting, at: Fit, by_x: Array) -> list[Array]:
    """Force towards south [N], frequency [Hz], force towards west [N] and phase [rad] of the waves that lower
    chi2 most beside `at`, best first; by_x: (W, M, p) Jacobian by its parameters.
    """
    frequencies = _frequencies(problem)
    gains, amplitudes = _gains_and_amplitudes(problem, at, by_x, frequencies)
    reach = options().peak_reach
    tops = [gains[max(0, i - reach) : i + reach + 1].max() for i in range(len(gains))]
    peaks = [i for i in np.argsort(-gains) if gains[i] == tops[i]][: options().wave_peaks]
    found = ((frequencies[i], *_polarised(amplitudes[i])) for i in peaks)
    return [np.array([south, frequency, west, phase]) for frequency, south, west, phase in found]


def scan_size(problem: Shooting) -> int:
    """Numbers in the Jacobian that `wave_starts` computes of long windows: they grow with the square of the
    runs' length.
    """
    return COMPONENTS * len(_frequencies(problem)) * problem.windows.weight.size


def _frequencies(problem: Shooting) -> Array:
    """(F,) [Hz]."""
    longest = float(problem.run_set.lengths.max()) * problem.dt
    rate = reference_of(problem.boat).rate
    return np.arange(
        options().lowest_wave * rate,
        min(options().highest_wave * rate, options().wave_sampling / problem.dt),
        1.0 / (options().wave_fineness * longest),
    )


@dataclass(frozen=True)
class _Quadratic:
    """chi2 by the four numbers of F harmonic forces, initial states eliminated: information (F, 4, 4),
    gradient (F, 4) and cross information with the p other parameters (F, 4, p).
    """

    information: Array
    gradient: Array
    cross: Array


def _gains_and_amplitudes(problem: Shooting, at: Fit, by_x: Array, frequencies: Array) -> tuple[Array, Array]:
    """Fall of chi2 (F,) beside the parameters of `at` and the initial states, and amplitudes (F, 4) [N] of
    harmonic forces. None where a simulation diverged.
    """
    grid = force_grid(problem, options().wave_piece)
    where = at.hypothesis, at.x, at.states, grid
    normal = normal_equations(at.states_jacobian, by_x, at.residual)
    if grid.count <= options().wave_pulses:
        motion = problem.motion(at.hypothesis, at.x[None], at.states[None], NO_ACCELERATION, 1)[0]
        pulses = force_normal_equations(problem, *where, (0, 1), at.states_jacobian, at.residual, beside=by_x)

        def quadratic(forces: Array) -> _Quadratic:
            return _of_pulses(pulses, forces, by_x.shape[2])

    else:
        made = transitions(problem, *where)
        motion = made.motion

        def quadratic(forces: Array) -> _Quadratic:
            return _of_responses(normal, at, by_x, force_responses(made, grid, forces))

    of_x = inverse(normal.information.sum(axis=0))
    by_own = of_x @ normal.gradient.sum(axis=0)
    gains, amplitudes = [], []
    together = max(1, options().chunk_bytes // (8 * COMPONENTS * at.residual.size))
    for some in np.split(frequencies, range(together, len(frequencies), together)):
        found = quadratic(_harmonic_forces(problem, motion, grid, some))
        H = found.information - found.cross @ of_x @ found.cross.swapaxes(1, 2)
        g = found.gradient - found.cross @ by_own
        finite = np.isfinite(H).all(axis=(1, 2)) & np.isfinite(g).all(axis=1)
        H, g = np.where(finite[:, None, None], H, 0.0), np.where(finite[:, None], g, 0.0)
        amplitudes.append((np.linalg.pinv(H, rcond=1e-12, hermitian=True) @ g[..., None])[..., 0])
        gains.append((g * amplitudes[-1]).sum(axis=1))
    return np.concatenate(gains), np.concatenate(amplitudes)


def _of_pulses(pulses: Normal, forces: Array, p: int) -> _Quadratic:
    """From the information of short pulses along surge and sway, which stand behind p other parameters."""
    windows, blocks, count = len(forces), (pulses.gradient.shape[1] - p) // 2, forces.shape[3] // COMPONENTS
    columns = forces[:, :blocks, :2].reshape(windows, 2 * blocks, -1)
    bent = pulses.information[:, p:, p:] @ columns
    shape = windows * 2 * blocks, count, COMPONENTS
    square = np.einsum("nfk,nfl->fkl", columns.reshape(shape), bent.reshape(shape), optimize=True)
    gradient = pulses.gradient[:, p:].reshape(-1) @ columns.reshape(shape[0], -1)
    cross = np.einsum("wpn,wnk->kp", pulses.information[:, :p, p:], columns, optimize=True)
    return _Quadratic(square, gradient.reshape(-1, COMPONENTS), cross.reshape(count, COMPONENTS, p))


def _of_responses(normal: Normal, at: Fit, by_x: Array, slopes: Array) -> _Quadratic:
    """From the responses (W, M, 4 F) themselves; normal: the normal equations of the other parameters."""
    p, count = by_x.shape[2], slopes.shape[2] // COMPONENTS
    known = np.concatenate([at.states_jacobian, by_x, at.residual[..., None]], axis=2)
    by_states, by_others = np.split(np.swapaxes(known, 1, 2) @ slopes, [6], axis=1)
    solved = np.linalg.solve(normal.states_information, by_states)
    across = np.concatenate([normal.cross, normal.states_gradient[..., None]], axis=2)
    left = (by_others - np.swapaxes(across, 1, 2) @ solved).sum(axis=0).T.reshape(count, COMPONENTS, p + 1)
    by = slopes.reshape(slopes.shape[0] * slopes.shape[1], count, COMPONENTS).transpose(1, 0, 2)
    shape = 6 * len(slopes), count, COMPONENTS
    of_states = np.einsum("nfk,nfl->fkl", by_states.reshape(shape), solved.reshape(shape), optimize=True)
    return _Quadratic(np.swapaxes(by, 1, 2) @ by - of_states, left[..., p], left[..., :p])


def _harmonic_forces(problem: Shooting, motion: Array, grid: ForceGrid, frequencies: Array) -> Array:
    """(W, L, 3, 4 F) surge, sway and yaw in each block of unit forces that oscillate; motion: (W, T, 6)."""
    steps = motion.shape[1] - 1
    middle = (np.arange(max(-(-steps // grid.block), grid.count)) + 0.5) * grid.block
    heading = motion[:, np.minimum(middle, steps).astype(int), 2]
    time = (problem.windows.first[:, None] + middle) * problem.dt
    phase = 2.0 * np.pi * time[..., None] * frequencies
    cos, sin = np.cos(heading)[..., None], np.sin(heading)[..., None]
    forces = np.zeros((*time.shape, 3, len(frequencies), COMPONENTS))
    for i, wave in enumerate((np.sin(phase), np.cos(phase))):
        north, east = 2 * i, 2 * i + 1
        forces[:, :, 0, :, north], forces[:, :, 1, :, north] = cos * wave, -sin * wave
        forces[:, :, 0, :, east], forces[:, :, 1, :, east] = sin * wave, cos * wave
    return forces.reshape(*time.shape, 3, -1)


def _polarised(numbers: Array) -> tuple[float, float, float]:
    """The nearest linearly polarised force: towards south and west [N], and its phase [rad].

    numbers: sine north, sine east, cosine north, cosine east.
    """
    left, size, right = np.linalg.svd(np.array([numbers[:2], numbers[2:]]).T)
    line, phase = left[:, 0] * size[0], right[0]
    return -float(line[0]), -float(line[1]), float(np.arctan2(phase[1], phase[0]))

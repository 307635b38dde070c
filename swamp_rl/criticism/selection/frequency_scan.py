"""Frequency scan for waves: least squares at each frequency without further simulations."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.force_sensitivity import force_grid, force_normal_equations
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, inverse
from swamp_rl.criticism.options import options
from swamp_rl.simulator.reference import reference_of

Array = NDArray[np.float64]


def wave_starts(problem: Shooting, at: Fit, by_x: Array) -> list[Array]:
    """Force towards south [N], frequency [Hz], force towards west [N] and phase [rad] of the waves that lower
    chi2 most beside `at`, best first; by_x: (W, M, p) Jacobian by its parameters.

    A harmonic force of known frequency is linear in four parameters: sine and cosine, north and east. Their
    information is the superposition of that of short force pulses.
    """
    grid = force_grid(problem, options().wave_piece)
    where = (problem, at.hypothesis, at.x, at.states, grid, (0, 1))
    normal = force_normal_equations(*where, at.states_jacobian, at.residual, beside=by_x)
    p = by_x.shape[2]
    turns = _turns(problem, at, grid.block, grid.count)
    start = problem.windows.first[:, None] * problem.dt
    time = start + (np.arange(grid.count) + 0.5) * grid.block * problem.dt
    longest = float(problem.run_set.lengths.max()) * problem.dt
    rate = reference_of(problem.boat).rate
    frequencies = np.arange(
        options().lowest_wave * rate,
        min(options().highest_wave * rate, options().wave_sampling / problem.dt),
        1.0 / (options().wave_fineness * longest),
    )
    found = []
    for frequency in frequencies:
        phase = 2 * np.pi * frequency * time
        basis = np.concatenate(
            [turns * np.sin(phase)[..., None, None], turns * np.cos(phase)[..., None, None]], axis=3
        ).reshape(problem.windows.count, -1, 4)
        found.append(_gain_and_amplitudes(normal.information, normal.gradient, basis, p))
    gains = np.array([gain for gain, _ in found])
    reach = options().peak_reach
    tops = [gains[max(0, i - reach) : i + reach + 1].max() for i in range(len(gains))]
    peaks = [i for i in np.argsort(-gains) if gains[i] == tops[i]][: options().wave_peaks]
    waves = ((frequencies[i], *_polarised(found[i][1])) for i in peaks)
    return [np.array([south, frequency, west, phase]) for frequency, south, west, phase in waves]


def _turns(problem: Shooting, at: Fit, block: int, count: int) -> Array:
    """(W, B, 2, 2) surge and sway force by force north and east, at the middle of each interval."""
    track = problem.predict(at.hypothesis, at.x[None], at.states[None])[0]
    middle = np.minimum((np.arange(count) + 0.5) * block, track.shape[1] - 1).astype(int)
    cos, sin = np.cos(track[:, middle, 2]), np.sin(track[:, middle, 2])
    return np.stack([np.stack([cos, sin], axis=-1), np.stack([-sin, cos], axis=-1)], axis=-2)


def _gain_and_amplitudes(information: Array, gradient: Array, basis: Array, p: int) -> tuple[float, Array]:
    """Fall of chi2, minimised over the p other parameters, and the four amplitudes, for basis (W, B axes,
    4).
    """
    H = np.zeros((p + 4, p + 4))
    H[:p, :p] = information[:, :p, :p].sum(axis=0)
    cross = np.einsum("wpb,wbk->pk", information[:, :p, p:], basis)
    H[:p, p:], H[p:, :p] = cross, cross.T
    H[p:, p:] = np.einsum("wbk,wbl->kl", basis, information[:, p:, p:] @ basis)
    g = np.concatenate([gradient[:, :p].sum(axis=0), np.einsum("wb,wbk->k", gradient[:, p:], basis)])
    if not (np.isfinite(H).all() and np.isfinite(g).all()):  # a simulation diverged
        return 0.0, np.zeros(4)
    solved = inverse(H) @ g
    return float(g @ solved), solved[p:]


def _polarised(numbers: Array) -> tuple[float, float, float]:
    """The nearest linearly polarised force: towards south and west [N], and its phase [rad].

    numbers: sine north, sine east, cosine north, cosine east.
    """
    left, size, right = np.linalg.svd(np.array([numbers[:2], numbers[2:]]).T)
    line, phase = left[:, 0] * size[0], right[0]
    return -float(line[0]), -float(line[1]), float(np.arctan2(phase[1], phase[0]))

"""Where a harmonic push may hide: a scan of frequencies that takes no rollout of its own for each."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.fit import Fit, inverse
from swamp_rl.criticism.pushes import push_normal, pushes_of
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

PIECE = 0.5  # s that a push is taken as constant
LOWEST, HIGHEST = 0.04, 1.0  # Hz
FINENESS = 4.0  # frequencies looked at for each 1 / (length of the longest run)
PEAKS = 2


def wave_starts(problem: Shooting, at: Fit, by_x: Array) -> list[Array]:
    """Frequency [Hz], push towards south and west [N] and phase [rad] of the pushes that promise most beside
    `at`, best first; by_x: (W, M, p) slopes by its numbers.

    A push that swings at a known frequency is linear in four numbers: sine and cosine, north and east. Their
    information is put together from what short pushes do (superposition), at every frequency anew.
    """
    pushes = pushes_of(problem, PIECE)
    where = (problem, at.hypothesis, at.x, at.states, pushes, (0, 1))
    normal = push_normal(*where, at.states_jacobian, at.residual, beside=by_x)
    p = by_x.shape[2]
    turns = _turns(problem, at, pushes.block, pushes.count)
    start = problem.windows.first[:, None] * problem.dt
    time = start + (np.arange(pushes.count) + 0.5) * pushes.block * problem.dt
    longest = float(problem.trials.lengths.max()) * problem.dt
    frequencies = np.arange(LOWEST, min(HIGHEST, 0.3 / problem.dt), 1.0 / (FINENESS * longest))
    found = []
    for frequency in frequencies:
        swing = 2 * np.pi * frequency * time
        basis = np.concatenate(
            [turns * np.sin(swing)[..., None, None], turns * np.cos(swing)[..., None, None]], axis=3
        ).reshape(problem.windows.count, -1, 4)
        found.append(_promise(normal.information, normal.gradient, basis, p))
    gains = np.array([gain for gain, _ in found])
    peaks = [i for i in np.argsort(-gains) if gains[i] == gains[max(0, i - 3) : i + 4].max()][:PEAKS]
    return [np.array([frequencies[i], *_polarised(found[i][1])]) for i in peaks]


def _turns(problem: Shooting, at: Fit, block: int, count: int) -> Array:
    """(W, B, 2, 2) surge and sway force by force north and east, at the middle of each piece."""
    track = problem.predict(at.hypothesis, at.x[None], at.states[None])[0]
    middle = np.minimum((np.arange(count) + 0.5) * block, track.shape[1] - 1).astype(int)
    cos, sin = np.cos(track[:, middle, 2]), np.sin(track[:, middle, 2])
    return np.stack([np.stack([cos, sin], axis=-1), np.stack([-sin, cos], axis=-1)], axis=-2)


def _promise(information: Array, gradient: Array, basis: Array, p: int) -> tuple[float, Array]:
    """Fall of chi2 (the p other numbers following) and the four numbers, for basis (W, B axes, 4)."""
    H = np.zeros((p + 4, p + 4))
    H[:p, :p] = information[:, :p, :p].sum(axis=0)
    cross = np.einsum("wpb,wbk->pk", information[:, :p, p:], basis)
    H[:p, p:], H[p:, :p] = cross, cross.T
    H[p:, p:] = np.einsum("wbk,wbl->kl", basis, information[:, p:, p:] @ basis)
    g = np.concatenate([gradient[:, :p].sum(axis=0), np.einsum("wb,wbk->k", gradient[:, p:], basis)])
    if not (np.isfinite(H).all() and np.isfinite(g).all()):  # a rollout has run away
        return 0.0, np.zeros(4)
    solved = inverse(H) @ g
    return float(g @ solved), solved[p:]


def _polarised(numbers: Array) -> tuple[float, float, float]:
    """The nearest push along one line: towards south and west [N], and its phase [rad].

    numbers: sine north, sine east, cosine north, cosine east.
    """
    left, size, right = np.linalg.svd(np.array([numbers[:2], numbers[2:]]).T)
    line, swing = left[:, 0] * size[0], right[0]
    return -float(line[0]), -float(line[1]), float(np.arctan2(swing[1], swing[0]))

"""Initial states, smoothed from the measurements about an instant."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import turned
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.data.windows import Windows
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


def smoothed_states(run_set: RunSet, weight: Array, windows: Windows) -> Array:
    """(W, 6) states at the windows' starts; weight: (R, T, 6).

    Local quadratic fits to the poses, whose slopes give velocities that were not measured. Linear
    interpolation over lost rows.
    """
    # longer for noisier positions: the error of a slope is proportional to span^(-3/2)
    noise = 1.0 / np.maximum(weight[:, :, 0].max(axis=1), 1e-6)
    seconds = np.clip(
        options().smoothing_span * (noise / (options().clean_position * run_set.boat.length)) ** (2 / 3),
        options().smoothing_span,
        options().smoothing_span_rough,
    )
    spans = np.maximum(2, np.rint(seconds / run_set.dt).astype(int))[windows.run]
    states = np.empty((windows.count, 6))
    for span in np.unique(spans):
        mine = spans == span
        states[mine] = _smoothed(run_set, weight, windows.run[mine], windows.first[mine], int(span))
    return states


def _smoothed(
    run_set: RunSet, weight: Array, run: NDArray[np.int64], first: NDArray[np.int64], span: int
) -> Array:
    place = np.arange(-span, span + 1)
    near = first[:, None] + place
    inside = (near >= 0) & (near < run_set.lengths[run][:, None])
    near = np.clip(near, 0, run_set.measured.shape[1] - 1)
    good = (weight[run[:, None], near] > 0) & inside[..., None]
    level, slope = levels_and_slopes(place / span, run_set.measured[run[:, None], near], good)
    beside = ~(good[:, : span + 1].any(axis=1) & good[:, span:].any(axis=1))
    for w, c in zip(*np.nonzero(beside), strict=True):
        level[w, c], slope[w, c] = _across(run_set, weight, (run[w], c), first[w] + span * np.arange(-1, 2))
    rate = slope[:, :3] / (span * run_set.dt)
    ahead, aside = turned(rate[:, 0], rate[:, 1], -level[:, 2])
    derived = np.stack([ahead, aside, rate[:, 2]], axis=1)
    known = good[..., 3:].sum(axis=1) >= 3
    return np.concatenate([level[:, :3], np.where(known, level[:, 3:], derived)], axis=1)


def _across(
    run_set: RunSet, weight: Array, of: tuple[np.int64, np.int64], rows: NDArray[np.int64]
) -> tuple[float, float]:
    """Value and slope at the middle row by linear interpolation: a quadratic must not be extrapolated."""
    run, channel = of
    there = np.flatnonzero(weight[run, :, channel] > 0)
    if not len(there):
        return 0.0, 0.0
    before, level, after = np.interp(rows, there, run_set.measured[run, there, channel])
    return float(level), float(after - before) / 2.0


def levels_and_slopes(place: Array, values: Array, good: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Value and slope (W, C) at place 0 of quadratic fits to the good ones of values (W, T, C) at places
    (T,); of lines through two, zeros where there is none.
    """
    powers = place[:, None] ** np.arange(5)
    moments = np.einsum("wtc,tk->wck", good.astype(float), powers)
    sums = np.einsum("wtc,tk->wck", np.where(good, values, 0.0), powers[:, :3])
    degrees = np.arange(3) < good.sum(axis=1)[..., None]
    matrix = moments[..., np.arange(3)[:, None] + np.arange(3)]
    both = degrees[..., :, None] & degrees[..., None, :]
    matrix = np.where(both, matrix, np.eye(3))
    solved = np.linalg.solve(matrix, np.where(degrees, sums, 0.0)[..., None])[..., 0]
    return solved[..., 0], solved[..., 1]

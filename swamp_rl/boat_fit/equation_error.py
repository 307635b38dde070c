"""Equation error (Ljung 1999, section 7): accelerations regressed on velocities and on what commands ask for.

No trajectory has to follow the data: one linear regression compares wirings and clocks, also with a boat file
whose numbers are wrong.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from swamp_rl.boat import Boat
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.simulator.reference import reference_of

Array = NDArray[np.float64]
Asked = tuple[Array, Array]  # (T, N) of the yaw acceleration, (T, N) of the acceleration ahead

SHARE, LEAST, MOST = 0.4, 0.6, 2.0  # of the boat's reference time, and s: the window of the derivatives


def window_of(boat: Boat, dt: float) -> int:
    """Rows, odd, over which derivatives are taken."""
    seconds = float(np.clip(SHARE * reference_of(boat).time, LEAST, MOST))
    return max(5, 2 * round(0.5 * seconds / dt) + 1)


def smoothed(values: Array, rows: int, order: int, dt: float) -> Array:
    """Values or a derivative (T, n) by parabolas through `rows` rows; NaN near ends and missing values."""
    from scipy.signal import savgol_filter

    if len(values) < rows:
        return np.full(values.shape, np.nan)
    made = savgol_filter(values, rows, 2, deriv=order, delta=dt, axis=0, mode="nearest")
    made[: rows // 2], made[len(made) - rows // 2 :] = np.nan, np.nan
    return np.asarray(made)


def answers_of(run_set: RunSet) -> list[Array]:
    """(T, 4) of each run: yaw acceleration, acceleration ahead, yaw rate, speed ahead."""
    rows = window_of(run_set.boat, run_set.dt)
    measured = zip(run_set.measured, run_set.lengths, strict=True)
    return [_answers(states[:length], rows, run_set.dt) for states, length in measured]


def _answers(measured: Array, rows: int, dt: float) -> Array:
    heading = measured[:, 2].copy()
    known = np.isfinite(heading)
    heading[known] = np.unwrap(heading[known])
    forward = np.column_stack([np.cos(heading), np.sin(heading)])
    turned = [smoothed(heading[:, None], rows, order, dt)[:, 0] for order in (1, 2)]
    moved = [(smoothed(measured[:, :2], rows, order, dt) * forward).sum(axis=1) for order in (1, 2)]
    if np.isfinite(measured[:, 5]).any():
        turned = [smoothed(measured[:, 5:6], rows, order, dt)[:, 0] for order in (0, 1)]
    if np.isfinite(measured[:, 3]).any():
        moved = [smoothed(measured[:, 3:4], rows, order, dt)[:, 0] for order in (0, 1)]
    return np.column_stack([turned[1], moved[1], turned[0], moved[0]])


def log_likelihood(
    answers: Sequence[Array], asked: Sequence[Asked], shift: int, rows: int, least: float = -math.inf
) -> float:
    """Of both accelerations, the commands taken `shift` rows later; rows within a window count as one.

    least: of the coefficients of what is asked for, 0 where its sign is known. -inf with too few rows.
    """
    total = 0.0
    for axis in (0, 1):
        tables = [
            np.hstack([answer[:, axis : axis + 1], _later(asks[axis], shift), _damping(answer)])
            for answer, asks in zip(answers, asked, strict=True)
        ]
        whole = np.vstack(tables)
        whole = whole[np.isfinite(whole).all(axis=1)][:: max(1, rows // 4)]
        if len(whole) <= 2 * whole.shape[1]:
            return -math.inf
        count = len(whole) * max(1, rows // 4) / rows
        low = np.full(whole.shape[1] - 1, -math.inf)
        low[: asked[0][axis].shape[1]] = least
        total -= 0.5 * count * math.log(max(_unexplained(whole[:, 0], whole[:, 1:], low), 1e-12))
    return total


def _later(values: Array, shift: int) -> Array:
    """Values (T, n) `shift` rows later, NaN where there are none."""
    moved = np.full(values.shape, np.nan)
    if shift >= 0:
        moved[shift:] = values[: len(values) - shift]
    else:
        moved[:shift] = values[-shift:]
    return moved


def _damping(answer: Array) -> Array:
    rate, speed = answer[:, 2], answer[:, 3]
    return np.column_stack(
        [rate, np.abs(rate) * rate, speed * rate, speed, np.abs(speed) * speed, np.ones_like(rate)]
    )


def _unexplained(target: Array, table: Array, low: Array) -> float:
    """Share of the variance of a column (N,) that the columns (N, p) with coefficients >= low leave."""
    if np.isneginf(low).all():
        left = target - table @ np.linalg.lstsq(table, target, rcond=None)[0]
    else:
        sizes = np.maximum(np.linalg.norm(table, axis=0), 1e-300)
        left = target - (table / sizes) @ lsq_linear(table / sizes, target, (low, math.inf)).x
    return float((left**2).sum() / max(((target - target.mean()) ** 2).sum(), 1e-300))

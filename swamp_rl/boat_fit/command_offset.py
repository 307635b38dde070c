"""Offset between the clocks of commands and receiver by equation error, under any wiring of the thrusters.

The yaw acceleration and the acceleration ahead are regressed on the thrust of every thruster, ahead and
across, each with a free coefficient, and on the velocities (Ljung 1999, section 7). An exchanged channel, a
wrong sign or a wrong coefficient does not move the offset of the greatest likelihood.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, PropellerRudder
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.simulator.reference import reference_of

Array = NDArray[np.float64]

LONGEST = 3.0  # s, to either side
SHARE, LEAST, MOST = 0.4, 0.6, 2.0  # of the boat's reference time, and s: the window of the derivatives
LIKELIER = 12.0  # difference of log likelihood, from which an offset is believed
GRID = 0.1  # s


def command_offset(run_set: RunSet) -> float:
    """Seconds by which the motion follows the commands, negative where it precedes them.

    The lags of actuators are part of it. 0 where no offset is clearly the likeliest, or it is at the end of
    the search.
    """
    dt = run_set.dt
    rows = _window(run_set.boat, dt)
    answers = [
        _answers(run_set.measured[run, :length], rows, dt) for run, length in enumerate(run_set.lengths)
    ]
    asked = [
        _smooth(thrusts(run_set.commands[run, :length], run_set.boat), rows, 0, dt)
        for run, length in enumerate(run_set.lengths)
    ]
    step = max(1, round(GRID / dt))
    most = round(LONGEST / dt)
    shifts = np.arange(-most, most + 1, step)
    found = np.array([_log_likelihood(answers, asked, int(shift), rows) for shift in shifts])
    best, none = int(np.argmax(found)), int(np.argmin(np.abs(shifts)))
    at_end = best in (0, len(shifts) - 1)
    return 0.0 if at_end or found[best] - found[none] < LIKELIER else float(shifts[best] * dt)


def thrusts(commands: Array, boat: Boat) -> Array:
    """(T, N) levels and squared levels with their sign, ahead and across, of commands (T, 2K): curves of
    thrust lie between the two.
    """
    count = len(boat.thrusters)
    angle, level = commands[:, :count], commands[:, count:]
    full = np.array([max(abs(t.throttle_min), t.throttle_max) for t in boat.thrusters])
    across = np.array([isinstance(t, PropellerRudder) or t.kind == "azimuth" for t in boat.thrusters])
    ahead = [isinstance(t, PropellerRudder) for t in boat.thrusters]
    cosine, sine = np.where(ahead, 1.0, np.cos(angle)), np.sin(angle)[:, across]
    laws = level / full, level * np.abs(level) / full**2
    return np.hstack([part for law in laws for part in (law * cosine, law[:, across] * sine)])


def _window(boat: Boat, dt: float) -> int:
    """Rows, odd."""
    seconds = float(np.clip(SHARE * reference_of(boat).time, LEAST, MOST))
    return max(5, 2 * round(0.5 * seconds / dt) + 1)


def _smooth(values: Array, rows: int, order: int, dt: float) -> Array:
    """Values or a derivative (T, n) by parabolas through `rows` rows; NaN near ends and missing values."""
    from scipy.signal import savgol_filter

    if len(values) < rows:
        return np.full(values.shape, np.nan)
    made = savgol_filter(values, rows, 2, deriv=order, delta=dt, axis=0, mode="nearest")
    made[: rows // 2], made[len(made) - rows // 2 :] = np.nan, np.nan
    return np.asarray(made)


def _answers(measured: Array, rows: int, dt: float) -> Array:
    """(T, 4) yaw acceleration, acceleration ahead, yaw rate, speed ahead, of measured states (T, 6)."""
    heading = measured[:, 2].copy()
    known = np.isfinite(heading)
    heading[known] = np.unwrap(heading[known])
    forward = np.column_stack([np.cos(heading), np.sin(heading)])
    turned = [_smooth(heading[:, None], rows, order, dt)[:, 0] for order in (1, 2)]
    moved = [(_smooth(measured[:, :2], rows, order, dt) * forward).sum(axis=1) for order in (1, 2)]
    if np.isfinite(measured[:, 5]).any():
        turned = [_smooth(measured[:, 5:6], rows, order, dt)[:, 0] for order in (0, 1)]
    if np.isfinite(measured[:, 3]).any():
        moved = [_smooth(measured[:, 3:4], rows, order, dt)[:, 0] for order in (0, 1)]
    return np.column_stack([turned[1], moved[1], turned[0], moved[0]])


def _log_likelihood(answers: Sequence[Array], asked: Sequence[Array], shift: int, rows: int) -> float:
    """Of both accelerations, the commands taken `shift` rows later; rows within a window count as one."""
    tables = []
    for answer, thrust in zip(answers, asked, strict=True):
        moved = np.full(thrust.shape, np.nan)
        if shift >= 0:
            moved[shift:] = thrust[: len(thrust) - shift]
        else:
            moved[:shift] = thrust[-shift:]
        rate, speed = answer[:, 2], answer[:, 3]
        damping = np.column_stack(
            [rate, np.abs(rate) * rate, speed * rate, speed, np.abs(speed) * speed, np.ones_like(rate)]
        )
        tables.append(np.hstack([answer[:, :2], moved, damping]))
    whole = np.vstack(tables)
    whole = whole[np.isfinite(whole).all(axis=1)][:: max(1, rows // 4)]
    if len(whole) <= 2 * whole.shape[1]:
        return -math.inf
    target, table = whole[:, :2], whole[:, 2:]
    left = target - table @ np.linalg.lstsq(table, target, rcond=None)[0]
    count = len(whole) * max(1, rows // 4) / rows
    share = (left**2).sum(axis=0) / np.maximum(((target - target.mean(axis=0)) ** 2).sum(axis=0), 1e-300)
    return float(-0.5 * count * np.log(np.maximum(share, 1e-12)).sum())

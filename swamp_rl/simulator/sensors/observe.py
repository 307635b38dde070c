"""From the boat's motion to what is measured of it, and back at a start."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import turned
from swamp_rl.physics.compile import compiled
from swamp_rl.simulator.state import EAST, HEADING, NORTH, SURGE, SWAY, TIME, YAW_RATE

Array = NDArray[np.float64]

CHANNELS = ("north", "east", "heading", "surge", "sway", "yaw_rate")

# fields of the record, of effects that are the same at all times and of those that are not
CONSTANT = ("antenna_x", "antenna_y", "heading_bias", "gyro_bias")
VARYING = ("position_delay", "clock_offset", "clock_drift", "heading_drift")


def observe(
    track: Array,
    params: NDArray[Any],
    dt: float,
    began: Array | None = None,
    of_earth: NDArray[np.bool_] | None = None,
) -> Array:
    """Measured channels (n, T, 6), in the order of `CHANNELS`, of tracks (n, T, S) in rows of dt [s].

    params: (n,) parameter records, read for the sensors' effects. began: (n,) time [s] of the first rows, the
    states' own where not given. Positions are the antenna's, `lateness` before now, linear between rows and
    continued straight beyond the first and the last; velocities over ground are midship's, those of surge and
    sway late by what the receiver's clock is. The heading is not wrapped. of_earth: (n,) whether surge and
    sway were measured in axes of the earth and turned by the measured heading, with its error.
    """
    measured = track[:, :, NORTH : YAW_RATE + 1].copy()
    at_midship = (params["antenna_x"] == 0.0) & (params["antenna_y"] == 0.0)
    if not at_midship.all():
        measured[:, :, :2] += antenna_offset(track[:, :, HEADING], params, (slice(None), None))
    if ran_off(params).any():
        time = np.asarray(track[:, 0, TIME] if began is None else began)[:, None] + dt * np.arange(
            track.shape[1]
        )
        of_clock = clock_error(time, params)
        late = (params["position_delay"][:, None] + of_clock) / dt
        report_late(track, measured[:, :, :2].copy(), late, of_clock / dt, late.any(axis=1), dt, measured)
        measured[:, :, HEADING] += params["heading_drift"][:, None] * time
    measured[:, :, HEADING] += params["heading_bias"][:, None]
    measured[:, :, YAW_RATE] += params["gyro_bias"][:, None]
    if of_earth is not None and of_earth.any():
        error = (measured[:, :, HEADING] - track[:, :, HEADING]) * of_earth[:, None]
        if error.any():
            seen = turned(measured[:, :, SURGE], measured[:, :, SWAY], -error)
            measured[:, :, SURGE], measured[:, :, SWAY] = seen
    return measured


def sensors_of(params: NDArray[Any]) -> NDArray[Any]:
    """(n,) what `observe` reads of parameter records (n,), which are many times as large to repeat."""
    made = np.empty(len(params), [(field, float) for field in CONSTANT + VARYING])
    for field in CONSTANT + VARYING:
        made[field] = params[field]
    return made


def is_altered(params: NDArray[Any]) -> bool:
    """Whether what is measured of any boat is anything but midship's motion itself."""
    return any(params[field].any() for field in CONSTANT) or bool(ran_off(params).any())


def ran_off(params: NDArray[Any]) -> NDArray[np.bool_]:
    """(n,) whether something that is measured depends on the time since the run began, or on another row."""
    return np.any([params[field] != 0.0 for field in VARYING], axis=0)


def clock_error(time: Array, params: NDArray[Any]) -> Array:
    """Seconds (n, T) that the receiver's clock is ahead of the commands' at time t (n, T): τ_0 + d t."""
    return params["clock_offset"][:, None] + params["clock_drift"][:, None] * time


def rows_ahead(params: NDArray[Any], last: Array | float, dt: float) -> int:
    """Rows of dt [s] that a track must go on beyond its last row, at time `last` [s], (n,) or one.

    A receiver whose clock is behind reports under each time where the boat is only later.
    """
    late = params["position_delay"] + params["clock_offset"] + params["clock_drift"] * last
    early = np.minimum(late, params["clock_offset"] + params["clock_drift"] * last).min()
    return max(0, math.ceil(-early / dt - 1e-9))


def antenna_offset(heading: Array, params: NDArray[Any], place: Any = ...) -> Array:
    """North and east [m] from midship to the antenna at each heading [rad]; params[place] fits its shape."""
    x, y = params["antenna_x"][place], params["antenna_y"][place]
    cos, sin = np.cos(heading), np.sin(heading)
    return np.stack([x * cos - y * sin, x * sin + y * cos], axis=-1)


@compiled
def between(place: float, last: int) -> tuple[int, int, float]:
    """Rows on both sides of a place, and the share [1] of the second; held beyond both ends."""
    held = min(max(place, 0.0), float(last))
    before = min(int(held), max(last - 1, 0))
    return before, min(before + 1, last), held - before


@compiled
def report_late(track: Any, position: Any, late: Any, of_clock: Any, own: Any, dt: float, seen: Any) -> None:
    """Fill seen (n, T, 6) of the boats `own` (n,) with what was `late` rows before: position (n, T, 2), which
    before the first of the states (n, T, S), and after the last, goes straight on with their velocity; and
    surge and sway, `of_clock` rows before.
    """
    last = track.shape[1] - 1
    for i in np.flatnonzero(own):
        first, final = track[i, 0], track[i, last]
        from_north, from_east = over_ground(first[HEADING], first[SURGE], first[SWAY])
        to_north, to_east = over_ground(final[HEADING], final[SURGE], final[SWAY])
        for t in range(last + 1):
            place = t - late[i, t]
            early, on = min(place, 0.0) * dt, max(place - last, 0.0) * dt
            one, two, share = between(place, last)
            north = (1.0 - share) * position[i, one, 0] + share * position[i, two, 0]
            east = (1.0 - share) * position[i, one, 1] + share * position[i, two, 1]
            seen[i, t, NORTH] = north + early * from_north + on * to_north
            seen[i, t, EAST] = east + early * from_east + on * to_east
            one, two, share = between(t - of_clock[i, t], last)
            for c in (SURGE, SWAY):
                seen[i, t, c] = (1.0 - share) * track[i, one, c] + share * track[i, two, c]


@compiled
def over_ground(heading: float, surge: float, sway: float) -> tuple[float, float]:
    """Velocity [m/s] towards north and east."""
    cos, sin = math.cos(heading), math.sin(heading)
    return surge * cos - sway * sin, surge * sin + sway * cos


def velocity_over_ground(states: Array) -> Array:
    """(n, 2) velocity [m/s] towards north and east of states (n, S)."""
    cos, sin = np.cos(states[:, HEADING]), np.sin(states[:, HEADING])
    return np.stack(
        [states[:, SURGE] * cos - states[:, SWAY] * sin, states[:, SURGE] * sin + states[:, SWAY] * cos],
        axis=1,
    )


def true_motion(
    measured: Array,
    params: NDArray[Any],
    time: NDArray[Any] | float = 0.0,
    of_earth: NDArray[np.bool_] | bool = False,
) -> Array:
    """(n, 6) north, east [m], heading [rad], surge, sway [m/s] and yaw rate [rad/s] of midship from what was
    measured of them (n, 6) at `time` [s], (n,) or one, of the run; of_earth: (n,) or one, as of `observe`.

    The inverse of the first row of `observe`.
    """
    true = measured.copy()
    error = params["heading_bias"] + params["heading_drift"] * time
    true[:, HEADING] -= error
    true[:, SURGE], true[:, SWAY] = turned(true[:, SURGE], true[:, SWAY], error * of_earth)
    true[:, YAW_RATE] -= params["gyro_bias"]
    true[:, :2] -= antenna_offset(true[:, HEADING], params)
    late = params["position_delay"] + params["clock_offset"] + params["clock_drift"] * time
    true[:, :2] += velocity_over_ground(true) * late[:, None]
    return true


def add_noise(measured: Array, deviations: Array, rng: np.random.Generator) -> Array:
    """`measured` (..., C) with independent normal noise of those standard deviations (C,)."""
    return measured + deviations * rng.standard_normal(measured.shape)

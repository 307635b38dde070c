"""Velocities and rates over a window that averages the noise of positions and headings."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.doctor.own_samples import between_samples
from swamp_rl.runs import Run

Array = NDArray[np.float64]

WINDOWS = (0.5, 1.0, 2.0, 4.0, 8.0)
"""s, of which the shortest that averages the noise enough is taken."""
NOISE_SHARE = 0.2
"""Of the speed: the greatest standard error of a velocity over a window; its direction errs by 0.2 rad."""


@dataclass(frozen=True)
class Motion:
    """A run's motion over windows of `window` s: (T,) position north + i east [m], interpolated between its
    own samples, velocity over ground north + i east [m/s], unit complex heading, rate of heading [rad/s],
    measured yaw rate, surge and sway over the same windows or None."""

    run: Run
    step: float
    window: float
    position: NDArray[np.complex128]
    velocity: NDArray[np.complex128]
    direction: NDArray[np.complex128]
    turning: Array
    yaw_rate: Array | None
    surge: Array | None
    sway: Array | None

    @property
    def rows(self) -> int:
        """Of a window."""
        return rows_of(self.window, self.step)

    @property
    def time(self) -> Array:
        """(T,) s."""
        return self.run.time

    def with_heading(self, direction: NDArray[np.complex128], turning: Array) -> "Motion":
        """The same with another heading."""
        return replace(self, direction=direction, turning=turning)


def noise_of(values: Array) -> float:
    """Deviation of white noise on a smooth signal (T,), from its second differences: 1.48 times their
    median size is that of the noise times √6."""
    if len(values) < 5:
        return 0.0
    return float(np.median(np.abs(np.diff(values, 2)))) * 1.4826 / np.sqrt(6.0)


def rows_of(window: float, step: float) -> int:
    """An odd count of rows, three or more."""
    return max(3, 2 * round(0.5 * window / step) + 1)


def slope_error(rows: int, step: float) -> float:
    """Standard error of `slope` for white noise of deviation 1."""
    half = rows // 2
    return 1.0 / (step * float(np.sqrt(half * (half + 1) * (2 * half + 1) / 3.0)))


def slope(values: Array, rows: int, step: float) -> Array:
    """(T,) slope of the least-squares line over `rows` rows about each; at the ends the last whole one."""
    half = rows // 2
    if len(values) <= rows:
        return np.full(len(values), np.polyfit(np.arange(len(values)) * step, values, 1)[0])
    weights = np.arange(-half, half + 1) / (step * half * (half + 1) * (2 * half + 1) / 3.0)
    inner = np.convolve(values, weights[::-1], mode="valid")
    return np.concatenate([np.full(half, inner[0]), inner, np.full(half, inner[-1])])


def mean_error(rows: int) -> float:
    """Standard error of `mean` for white noise of deviation 1: the weights are a parabola."""
    return float(np.sqrt(1.2 / rows))


def mean(values: Array, rows: int) -> Array:
    """(T,) mean of the same rows, with the slope's weights: a parabola that is 0 at both ends."""
    half = rows // 2
    if len(values) <= rows:
        return np.full(len(values), values.mean())
    offsets = np.arange(-half, half + 1)
    weights = (half + 1.0) ** 2 - offsets**2 - 0.0
    inner = np.convolve(values, weights / weights.sum(), mode="valid")
    return np.concatenate([np.full(half, inner[0]), inner, np.full(half, inner[-1])])


def motion_of(run: Run) -> Motion | None:
    """The motion of a run; None where it has no places and heading, is shorter than two windows, at rest, or
    so noisy that no window averages it."""
    needed = ("north", "east", "heading")
    if not set(needed) <= set(run.columns) or len(run.time) < 20:
        return None
    heading = np.unwrap(run.columns["heading"])
    step = float(np.median(np.diff(run.time)))
    if not step > 0.0 or not all(np.isfinite(run.columns[name]).all() for name in needed):
        return None
    (north, apart), (east, other) = (between_samples(run.columns[name]) for name in ("north", "east"))
    apart = max(apart, other)
    noise = np.hypot(noise_of(north[::apart]), noise_of(east[::apart]))
    for shortest in WINDOWS:
        window = max(shortest, 2.0 * apart * step)  # three samples
        rows = rows_of(window, step)
        if 2 * rows > len(north):
            break
        error = noise * slope_error(rows_of(window, apart * step), apart * step)
        velocity = slope(north, rows, step) + 1j * slope(east, rows, step)
        speed = float(np.sqrt(np.mean(np.abs(velocity) ** 2)))
        if error <= NOISE_SHARE * speed and speed > 0.0:
            unit = mean(np.cos(heading), rows) + 1j * mean(np.sin(heading), rows)
            known = {
                name: mean(values, rows)
                for name in ("yaw_rate", "surge", "sway")
                if (values := run.columns.get(name)) is not None and np.isfinite(values).all()
            }
            turning = slope(heading, rows, step)
            measured = (known.get(name) for name in ("yaw_rate", "surge", "sway"))
            return Motion(run, step, window, north + 1j * east, velocity, unit, turning, *measured)
    return None

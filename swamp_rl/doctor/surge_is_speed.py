"""Whether surge is the speed over ground, from the velocity of the positions along and across the heading.

Surge is regressed on both, which a constant error of the heading mixes, and on the excess of the speed over
the first, of which surge contains none and the speed all. Errors of the velocity bias that share (errors in
variables), as does its mean over a window in a turn. Both hypotheses are therefore simulated: a velocity
along the heading of which surge is the measurement, or the speed, over the same windows, with errors that are
the residuals of the measured velocity, shifted in time. The share is given relative to the two that result.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swamp_rl.doctor.finding import Finding
from swamp_rl.doctor.smooth import WINDOWS, Motion, mean, rows_of, slope
from swamp_rl.html_page import with_error

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

EXCESS = 0.5
"""Greatest distance from 1 of the share of the excess in surge, where it is taken for the speed."""
CERTAIN = 2.5
"""Standard errors by which the share must exceed 1 less `EXCESS`."""
SHIFTS = 8
"""Of the residuals, equally far apart: simulated samples of each hypothesis."""


class _Window(NamedTuple):
    """Of one run over windows of `rows` rows: (T,) velocity along + i across the heading, surge over the same
    rows, unit complex heading over these and of each row, surge of each row."""

    rows: int
    velocity: Complex
    given: Array
    direction: Complex
    raw_direction: Complex
    raw_given: Array


def surge_is_speed(motions: Sequence[Motion]) -> list[Finding]:
    """A fault where surge contains the excess of the speed, at the window of least standard error."""
    known = [one for one in motions if one.surge is not None]
    over = ([part for one in known if (part := _over(one, window))] for window in WINDOWS)
    found = [_relative_share(parts) for parts in over if parts]
    shares = [one for one in found if one is not None]
    if not shares:
        return []
    share, error = min(shares, key=lambda one: one[1])
    if not 1.0 - EXCESS + CERTAIN * error < share < 1.0 + EXCESS + CERTAIN * error:
        return []
    message = (
        f"is the speed over ground: it contains {with_error(share, error)} of the difference between that "
        "and the velocity along the heading, of which a surge contains none"
    )
    advice = (
        "leave it out, or import it with the course over ground: velocity_north=speed*cos(radians(course)), "
        "velocity_east=speed*sin(radians(course))"
    )
    figures = {"share": share, "standard_error": error}
    return [Finding("fault", "surge_is_speed", ("surge",), message, advice, figures=figures)]


def _over(motion: Motion, window: float) -> _Window | None:
    """Over `window` s or the motion's own, whichever is longer; None where the run is shorter than two."""
    rows = rows_of(max(window, motion.window), motion.step)
    if 2 * rows > len(motion.time):
        return None
    given, raw = motion.run.columns["surge"], np.exp(1j * motion.run.columns["heading"])
    direction = _mean(raw, rows)
    direction /= np.maximum(np.abs(direction), 1e-12)
    north, east = (
        slope(values, rows, motion.step) for values in (motion.position.real, motion.position.imag)
    )
    return _Window(rows, (north + 1j * east) * np.conj(direction), mean(given, rows), direction, raw, given)


def _mean(values: Complex, rows: int) -> Complex:
    return np.asarray(mean(values.real, rows) + 1j * mean(values.imag, rows))


def _relative_share(parts: Sequence[_Window]) -> tuple[float, float] | None:
    """The share of the excess, 0 where surge is one and 1 where it is the speed, and its standard error."""
    given = np.concatenate([one.given for one in parts])
    velocity = np.concatenate([one.velocity for one in parts])
    common = float(given @ velocity.real)
    measured = _share(given, velocity)
    if common <= 0.0 or measured is None:
        return None
    unit = float(given @ given) / common  # of surge, by the regression whose regressor has little noise
    noise = float(np.mean((velocity.real - given / unit) ** 2))
    power = float(np.mean(velocity.imag**2))
    across = np.sqrt(max(1.0 - noise / power, 0.0)) if power > 0.0 else 0.0
    expected = [_expected_share(parts, unit, float(across), speed) for speed in (False, True)]
    apart = expected[1] - expected[0]
    if not apart > 0.0:
        return None
    rows = float(np.mean([one.rows for one in parts]))  # of a window, whose errors are correlated
    return (measured[0] - expected[0]) / apart, float(np.sqrt(rows)) * measured[1] / apart


def _expected_share(parts: Sequence[_Window], unit: float, across: float, speed: bool) -> float:
    """Mean share over simulated samples in which surge is the speed, or a surge.

    unit: of surge [m/s]; across: factor of the velocity across the heading that leaves out its errors' power.
    """
    simulated = []
    for one in parts:
        along, lateral = one.raw_given / unit, across * one.velocity.imag
        if speed:
            along = np.sign(one.velocity.real) * np.sqrt(np.maximum(along**2 - lateral**2, 0.0))
        passed = _mean((along + 1j * lateral) * one.raw_direction, one.rows) * np.conj(one.direction)
        simulated.append((passed, one.velocity.real - passed.real))
    given = np.concatenate([one.given for one in parts])
    shares = []
    for number in range(1, SHIFTS + 1):
        first, second = number / (SHIFTS + 1), 2 * number % (SHIFTS + 1) / (SHIFTS + 1)
        samples = [passed + _shifted(left, first) + 1j * _shifted(left, second) for passed, left in simulated]
        shares.append(_share(given, np.concatenate(samples)))
    return float(np.mean([one[0] if one else np.nan for one in shares]))


def _shifted(values: Array, part: float) -> Array:
    return np.roll(values, round(part * len(values)))


def _share(given: Array, velocity: Complex) -> tuple[float, float] | None:
    """Coefficient of the excess over that of the velocity along the heading, and its standard error under
    white noise; None where the regressors are dependent."""
    by = np.column_stack([velocity.real, velocity.imag, np.abs(velocity) - velocity.real])
    found, _, rank, _ = np.linalg.lstsq(by, given, rcond=1e-9)
    along, _, excess = found.tolist()
    if rank < by.shape[1] or along <= 0.0:
        return None
    left = given - by @ found
    return excess / along, float(np.sqrt(np.mean(left**2) * np.linalg.inv(by.T @ by)[2, 2])) / along

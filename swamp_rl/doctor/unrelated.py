"""Consistency of heading and yaw rate, of course and heading, and of the measured velocity with the slope of
the positions, by correlation.
"""

import cmath
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.doctor.finding import Finding
from swamp_rl.doctor.smooth import WINDOWS, Motion, mean, mean_error, noise_of, rows_of, slope, slope_error

Array = NDArray[np.float64]

UNTIED = 0.5
"""Correlation up to which two records are not of one quantity: a quarter of the variance is common."""
RESOLVED = 0.5
"""Of the yaw rate's standard deviation: the greatest standard error, by white noise, of it and of the
heading's slope that are compared."""
DRIFT = 0.005
"""rad/s: the bias of a MEMS gyro varies by less; a boat that turns no more is not judged."""
LONGER, UNDER_WAY = 4, 0.7
"""Of a boat under way the speed over a window that is so much longer is at least this share of the speed; of
a receiver's error that diffuses it is half."""
FEWEST = 20
"""Windows of data from which the largest correlation of unrelated records over all lags is below UNTIED."""
LONGEST_LAG = 3.0
"""s, to either side: of a compass that is damped, or of another clock."""
SCATTER = 0.5
"""rad: white noise from row to row, beyond that of any compass."""
SPREAD = 0.8
"""Mean resultant length of courses, and of their double, up to which they point in enough directions."""
UNEXPLAINED = 0.25
"""Share of the courses' circular variance, up to which the heading explains nothing of them."""
CAUSES = (
    "check the order of a quaternion's components, yaw(w, x, y, z), the unit of an angle before its sine or "
    "cosine, and which axis is logged"
)


def heading_unrelated(motions: Sequence[Motion]) -> list[Finding]:
    """A fault where heading scatters or does not turn as yaw_rate says; without a yaw rate, a note where it
    explains nothing of the course.
    """
    scatter = float(np.median([noise_of(np.unwrap(one.run.columns["heading"])) for one in motions]))
    if scatter > SCATTER:
        message = f"scatters by {math.degrees(scatter):.0f} degrees from row to row, as no compass does"
        figures = {"scatter_rad": scatter}
        return [Finding("fault", "heading_unrelated", ("heading",), message, CAUSES, figures=figures)]
    pairs = _turning_pairs([one for one in motions if one.yaw_rate is not None])
    if not pairs:
        return _course_unrelated(motions) if all(one.yaw_rate is None for one in motions) else []
    largest = _largest_correlation(pairs)
    if largest > UNTIED:
        return []
    message = (
        "the rate of change of heading and yaw_rate are not correlated (at most "
        f"{largest:.2f} within {LONGEST_LAG:g} s)"
    )
    columns, figures = ("heading", "yaw_rate"), {"correlation": largest}
    advice = f"one of them is not of this motion: {CAUSES}"
    return [Finding("fault", "heading_unrelated", columns, message, advice, figures=figures)]


def _turning_pairs(known: Sequence[Motion]) -> list[tuple[Motion, Array, Array]]:
    """Yaw rate and slope of the heading (T,) of each motion over the shortest window in which the noise of
    both is below RESOLVED of the yaw rate; none where no window has that, or too few windows are there.
    """
    for window in WINDOWS:
        pairs, errors, count = [], np.zeros(2), 0.0
        for one in known:
            rows = rows_of(max(window, one.window), one.step)
            heading, given = np.unwrap(one.run.columns["heading"]), one.run.columns["yaw_rate"]
            if 2 * rows > len(heading):
                continue
            pairs.append((one, mean(given, rows), slope(heading, rows, one.step)))
            own = noise_of(given) * mean_error(rows), noise_of(heading) * slope_error(rows, one.step)
            errors += len(heading) * np.square(own)
            count += len(heading) / rows
        if count < FEWEST:
            break
        given = np.concatenate([one for _, one, _ in pairs])
        noise = math.sqrt(float(errors.max()) / len(given))
        if max(noise / RESOLVED, DRIFT) < float(np.std(given)):
            return pairs
    return []


def _largest_correlation(pairs: Sequence[tuple[Motion, Array, Array]]) -> float:
    """The largest size of the correlation of two records, with and without their means, over all lags."""
    every, count = [0.0], sum(len(given) for _, given, _ in pairs)
    for seconds in np.linspace(-LONGEST_LAG, LONGEST_LAG, 25):
        given, turned = (np.concatenate(parts) for parts in zip(*_lagged(pairs, seconds), strict=True))
        if 2 * len(given) < count:  # of short runs little is left
            continue
        for one, other in ((given, turned), (given - given.mean(), turned - turned.mean())):
            size = float(np.linalg.norm(one) * np.linalg.norm(other))
            every.append(abs(float(one @ other)) / size if size > 0.0 else 0.0)
    return max(every)


def _lagged(pairs: Sequence[tuple[Motion, Array, Array]], seconds: float) -> list[tuple[Array, Array]]:
    """The records of each motion, the second one so much later."""
    found = []
    for motion, given, turned in pairs:
        rows = round(seconds / motion.step)
        first = max(0, -rows)
        last = max(first, len(given) - max(0, rows))
        found.append((given[first:last], turned[first + rows : last + rows]))
    return found


def _course_unrelated(motions: Sequence[Motion]) -> list[Finding]:
    """A note where courses, weighted by the speed squared, point in many directions and no fewer of them
    relative to the heading; ahead and astern count alike in their double.
    """
    velocity = np.concatenate([one.velocity for one in motions])
    heading = np.concatenate([one.direction for one in motions])
    weight, explained = np.abs(velocity) ** 2, []
    longer = np.concatenate([_longer(one) for one in motions])
    if float(np.mean(np.abs(longer) ** 2)) < UNDER_WAY**2 * float(weight.mean()):
        return []
    for power in (1, 2):
        course = (velocity / np.maximum(np.abs(velocity), 1e-12)) ** power
        own = abs(complex(np.sum(weight * course))) / float(weight.sum())
        less = abs(complex(np.sum(weight * course * np.conj(heading) ** power))) / float(weight.sum())
        mirrored = abs(complex(np.sum(weight * course * heading**power))) / float(weight.sum())
        if own > SPREAD:
            return []
        explained.append(1.0 - (1.0 - max(less, mirrored)) / (1.0 - own))
    if max(explained) > UNEXPLAINED:
        return []
    share = max(0.0, max(explained))
    message = f"explains {share:.0%} of the variation of the course over ground"
    advice = f"unless the boat moves sideways, it is not its heading: {CAUSES}"
    figures = {"explained": share}
    return [Finding("note", "heading_unrelated", ("heading",), message, advice, figures=figures)]


def _longer(motion: Motion) -> NDArray[np.complex128]:
    """The velocity over ground over windows LONGER times as long."""
    rows = rows_of(LONGER * motion.window, motion.step)
    north, east = (
        slope(values, rows, motion.step) for values in (motion.position.real, motion.position.imag)
    )
    return np.asarray(north + 1j * east)


def measured_against_positions(motions: Sequence[Motion], aligned: float, better: float) -> str | None:
    """How the measured velocity over ground differs from that of the positions, in words; None where it does
    not or is unknown. aligned, better: the least resultant, and by how much it must pass the other.
    """
    known = [one for one in motions if one.surge is not None and one.sway is not None]
    if not known:
        return None
    moved = np.concatenate([one.velocity for one in known])
    given = np.concatenate([_over_ground(one) for one in known])
    sizes = float(np.linalg.norm(moved) * np.linalg.norm(given))
    if sizes == 0.0:
        return None
    turned, mirrored = complex(np.vdot(moved, given)) / sizes, complex(np.sum(moved * given)) / sizes
    if abs(mirrored) > max(aligned, abs(turned) + better):
        return f"is a mirror image of that of the positions{_mirror(cmath.phase(mirrored))}"
    if abs(turned) > aligned and abs(cmath.phase(turned)) > 0.25 * math.pi:
        return f"is turned by {math.degrees(cmath.phase(turned)):+.0f} degrees from that of the positions"
    like = 0.5 < float(np.linalg.norm(given) / np.linalg.norm(moved)) < 2.0
    if like and max(abs(turned), abs(mirrored)) < UNTIED:
        return f"is not correlated with that of the positions ({abs(turned):.2f})"
    return None


def _over_ground(motion: Motion) -> NDArray[np.complex128]:
    """Measured velocity north + i east, of surge and sway."""
    assert motion.surge is not None and motion.sway is not None
    unit = motion.direction / np.maximum(np.abs(motion.direction), 1e-12)
    return np.asarray((motion.surge + 1j * motion.sway) * unit)


def _mirror(angle: float) -> str:
    """What an image with that sum of both directions [rad] comes from."""
    causes = {0.0: "its east has the opposite sign", math.pi: "its north has the opposite sign"}
    causes |= {0.5 * math.pi: "its north and east are exchanged"}
    for one, cause in causes.items():
        if abs(math.remainder(angle - one, math.tau)) < 0.25 * math.pi:
            return f": {cause}"
    return ""

"""Course stability and port/starboard bias, from spirals and pull-outs."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.manoeuvres.analysis.figure import Figure, Result, interval, over_blocks
from swamp_rl.manoeuvres.analysis.motion import Motion
from swamp_rl.manoeuvres.analysis.recognise import Recognised
from swamp_rl.manoeuvres.execute import Mark

Array = NDArray[np.float64]

LAST = 1.0 / 3.0  # of a phase, in which it counts as steady
BLOCKS = 6  # of the steady part, that are resampled
TERMS = 4  # of the curve through the yaw rates of a reverse spiral
SMALL = 0.02  # rad per length sailed: a yaw rate that counts as none
NO_ANGLE = math.radians(0.5)  # of steering that counts as none


def steady_part(motion: Motion, found: Recognised, mark: Mark) -> slice:
    """Rows of the last part of a phase."""
    first, end = motion.row(mark.time), found.end(mark, motion)
    return slice(end - max(int((end - first) * LAST), 1), end)


def named(bias: float, of: str) -> str:
    """A bias by its side."""
    return f"to {'starboard' if bias > 0 else 'port'}: {of}"


def analyse_spiral(motion: Motion, found: Recognised, result: Result, rng: np.random.Generator) -> None:
    """Direct spiral: what yaw rate is left amidships on the way to either side, and the loop that makes."""
    steps = found.of("step")
    parts = [steady_part(motion, found, mark) for mark in steps]
    rates = [over_blocks(np.degrees(motion.yaw_rate[rows]), BLOCKS, "deg/s", rng) for rows in parts]
    angles = np.degrees([mark.angle for mark in steps])
    result.traces |= {"angle": angles, "rate": np.array([rate.value for rate in rates])}
    half = int(np.argmin(angles * np.sign(angles[0])))  # the largest angle to the other side
    both = min(half, len(steps) - 1 - half)  # steps that were made there and back
    amid = [i for i, angle in enumerate(angles) if abs(angle) < math.degrees(NO_ANGLE)]
    if len(amid) < 2 or both == 0:
        result.notes.append("the spiral does not pass amidships twice: no loop to measure")
        return
    if np.abs(angles[half - both : half] - angles[half + both : half : -1]).max() > math.degrees(NO_ANGLE):
        result.notes.append("the spiral's angles there are not those back: no loop to measure")
        return
    there, back = rates[amid[0]], rates[amid[1]]
    neutral = [_crossing(angles[half::-1], result.traces["rate"][half::-1])]
    neutral.append(_crossing(angles[half:], result.traces["rate"][half:]))
    speed = float(np.hypot(motion.surge, motion.sway)[parts[amid[0]]].mean())
    # The loop need not lie amidships: a biased boat has it about its neutral angle.
    ways = (result.traces["rate"][rows] for rows in (slice(half - both, half), slice(half + both, half, -1)))
    height = float(np.abs(np.subtract(*ways)).max())
    _loop(result, (there, back), neutral, height, math.degrees(SMALL * speed / motion.length))


def _loop(
    result: Result, left: tuple[Figure, Figure], neutral: list[float], height: float, small: float
) -> None:
    there, back = left
    bias = 0.5 * (there.value + back.value)
    result.figures = {
        "residual_rate_there": there,
        "residual_rate_back": back,
        "loop_height": Figure(height, "deg/s"),
        "loop_width": Figure(abs(neutral[1] - neutral[0]), "deg"),
        "bias_rate": Figure(bias, "deg/s"),
        "neutral_angle": Figure(float(np.mean(neutral)), "deg"),
    }
    # Both are NaN where the yaw rate does not pass zero on one of the ways.
    width, angle = (result.figures[name].value for name in ("loop_width", "neutral_angle"))
    wide, at = f" and {width:.1f} deg wide", f", neutral angle {angle:+.2f} deg"
    if math.isnan(angle):
        wide, at = ", its width unknown", ", neutral angle not reached"
    result.verdicts["course_stability"] = (
        f"stable: both branches agree within {height:.2f} deg/s"
        if height <= small
        else f"unstable: a loop {height:.2f} deg/s high{wide}"
    )
    result.verdicts["bias"] = (
        f"none: {bias:+z.2f} deg/s amidships"
        if abs(bias) <= 0.5 * small
        else named(bias, f"{bias:+.2f} deg/s amidships{at}")
    )


def _crossing(angles: Array, rates: Array) -> float:
    """The angle at which the yaw rate, from port to starboard, passes zero; NaN where it does not."""
    order = np.argsort(angles, kind="stable")
    angles, rates = angles[order], rates[order]
    for i in range(len(rates) - 1):
        if rates[i] <= 0.0 < rates[i + 1]:
            return float(angles[i] - rates[i] * (angles[i + 1] - angles[i]) / (rates[i + 1] - rates[i]))
    return math.nan


def analyse_reverse_spiral(
    motion: Motion, found: Recognised, result: Result, rng: np.random.Generator
) -> None:
    """Reverse spiral: the curve delta(r) through the held yaw rates, whose slope tells the stability."""
    parts = [steady_part(motion, found, mark) for mark in found.of("hold")]
    rates = np.array([np.degrees(motion.yaw_rate[rows]).mean() for rows in parts])
    angles = np.array([np.degrees(motion.angle[rows]).mean() for rows in parts])
    result.traces |= {"angle": angles, "rate": rates}
    if not np.isfinite(angles).all():
        result.notes.append("its commands give no steering angle: no curve through the yaw rates")
        return
    if len(rates) < 8:
        result.notes.append("fewer than eight steady yaw rates: no curve through them")
        return
    curve = _curve(rates, angles)
    picks = rng.integers(0, len(rates), (300, len(rates)))
    enough = [pick for pick in picks if len(set(rates[pick])) > TERMS]
    again = np.array([_curve(rates[pick], angles[pick]) for pick in enough])
    rows = np.linspace(rates.min(), rates.max(), 201)
    width = np.array([_width(rows, other) for other in again])
    (low_0, high_0), (low_1, high_1), (low, high) = (interval(v) for v in (again[:, 0], again[:, 1], width))
    neutral, slope = float(curve[0]), float(curve[1])
    result.figures = {
        "neutral_angle": Figure(neutral, "deg", low=low_0, high=high_0),
        "slope": Figure(slope, "deg per deg/s", low=low_1, high=high_1),
        "loop_width": Figure(_width(rows, curve), "deg", low=low, high=high),
    }
    result.traces |= {"curve_rate": rows, "curve_angle": _basis(rows) @ curve}
    result.verdicts["course_stability"] = (
        f"stable: {slope:+.2f} deg of steering per deg/s about straight running"
        if slope > 0.0
        else f"unstable: {slope:+.2f} deg of steering per deg/s about straight running"
    )
    # Steering must be held against a bias, so it lies on the other side.
    result.verdicts["bias"] = (
        f"none: neutral angle {neutral:+z.2f} deg"
        if low_0 <= 0.0 <= high_0 or abs(neutral) < 0.1
        else named(-neutral, f"the neutral angle is {neutral:+.2f} deg")
    )


def _basis(rates: Array) -> Array:
    """(N, TERMS) terms of the curve: 1, r, r abs(r), r^3; the quadratic one is the cross flow's."""
    return np.column_stack([np.ones_like(rates), rates, rates * np.abs(rates), rates**3])


def _curve(rates: Array, angles: Array) -> Array:
    """Coefficients (TERMS,) of the curve by least squares."""
    return np.asarray(np.linalg.lstsq(_basis(rates), angles, rcond=None)[0], np.float64)


def _width(rates: Array, curve: Array) -> float:
    """How wide [deg] the curve folds back on itself about straight running, 0 for a stable boat.

    NaN where the rates (N,) are all to one side.
    """
    if rates.min() > 0.0 or rates.max() < 0.0:
        return math.nan
    angles = _basis(rates) @ curve
    return max(float(angles[rates <= 0.0].max() - angles[rates >= 0.0].min()), 0.0)


def analyse_pull_out(motion: Motion, found: Recognised, result: Result, rng: np.random.Generator) -> None:
    """Pull-outs: the yaw rate that is left amidships after a turn to either side."""
    pulls, residual = found.of("pull-out"), {}
    for pull in pulls:
        first, end = motion.row(pull.time), found.end(pull, motion)
        side = "starboard" if motion.yaw_rate[first] > 0 else "port"
        rates = np.degrees(motion.yaw_rate)
        residual[side] = over_blocks(rates[steady_part(motion, found, pull)], BLOCKS, "deg/s", rng)
        result.figures[f"residual_rate_{side}"] = residual[side]
        result.traces[f"pull_out_{side}"] = np.stack([motion.time[first:end] - pull.time, rates[first:end]])
    if len(residual) < 2:
        if result.kind == "pull-out":
            result.notes.append("a pull-out from one side only: stability and bias need both")
        return
    speed = float(np.hypot(motion.surge, motion.sway)[steady_part(motion, found, pulls[-1])].mean())
    small = math.degrees(SMALL * max(speed, motion.pace) / motion.length)
    judge_pull_outs(result, residual["starboard"], residual["port"], small)


def judge_pull_outs(result: Result, starboard: Figure, port: Figure, small: float) -> None:
    """Verdicts on the yaw rates [deg/s] left after a turn to either side; `small` counts as none."""
    apart, bias = starboard.value - port.value, 0.5 * (starboard.value + port.value)
    result.figures["bias_rate"] = Figure(bias, "deg/s")
    changed = max(abs(rate.each[-1] - rate.each[0]) for rate in (starboard, port))
    if changed > small:
        result.verdicts["course_stability"] = (
            f"undetermined: the yaw rate still changed by {changed:.2f} deg/s"
        )
        result.verdicts["bias"] = "undetermined, for the same reason: use a longer pull-out"
        return
    result.verdicts["course_stability"] = (
        f"stable: both pull-outs end within {abs(apart):.2f} deg/s of one another"
        if abs(apart) <= small
        else f"unstable: {apart:.2f} deg/s remain between the pull-outs from starboard and from port"
    )
    result.verdicts["bias"] = (
        f"none: {bias:+z.2f} deg/s is left"
        if abs(bias) <= 0.5 * small
        else named(bias, f"{bias:+.2f} deg/s is left, the mean of both pull-outs")
    )

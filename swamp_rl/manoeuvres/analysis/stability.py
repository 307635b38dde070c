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
    half = len(steps) // 2
    amid = [i for i, angle in enumerate(angles) if abs(angle) < math.degrees(NO_ANGLE)]
    if len(amid) < 2:
        result.notes.append("the spiral does not pass amidships twice: no loop to measure")
        return
    there, back = rates[amid[0]], rates[amid[1]]
    neutral = [_crossing(angles[half::-1], result.traces["rate"][half::-1])]
    neutral.append(_crossing(angles[half:], result.traces["rate"][half:]))
    speed = float(np.hypot(motion.surge, motion.sway)[parts[amid[0]]].mean())
    _loop(result, there, back, neutral, math.degrees(SMALL * speed / motion.length))


def _loop(result: Result, there: Figure, back: Figure, neutral: list[float], small: float) -> None:
    height = there.value - back.value
    bias = 0.5 * (there.value + back.value)
    result.figures = {
        "residual_rate_there": there,
        "residual_rate_back": back,
        "loop_height": Figure(abs(height), "deg/s"),
        "loop_width": Figure(abs(neutral[1] - neutral[0]), "deg"),
        "bias_rate": Figure(bias, "deg/s"),
        "neutral_angle": Figure(float(np.mean(neutral)), "deg"),
    }
    stable = abs(height) <= small
    result.verdicts["course_stability"] = (
        f"stable: {abs(height):.2f} deg/s of loop amidships"
        if stable
        else f"unstable: a loop of {abs(height):.2f} deg/s amidships"
    )
    angle = result.figures["neutral_angle"].value
    result.verdicts["bias"] = (
        f"none: {bias:+.2f} deg/s amidships"
        if abs(bias) <= 0.5 * small
        else named(bias, f"{bias:+.2f} deg/s amidships, neutral angle {angle:+.2f} deg")
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
    """Reverse spiral: the cubic delta(r) through the held yaw rates, whose slope tells the stability."""
    parts = [steady_part(motion, found, mark) for mark in found.of("hold")]
    rates = np.array([np.degrees(motion.yaw_rate[rows]).mean() for rows in parts])
    angles = np.array([np.degrees(motion.angle[rows]).mean() for rows in parts])
    result.traces |= {"angle": angles, "rate": rates}
    if len(rates) < 6:
        result.notes.append("fewer than six yaw rates were held: no curve through them")
        return
    a_0, a_1, a_3 = _cubic(rates, angles)
    picks = rng.integers(0, len(rates), (300, len(rates)))
    again = np.array([_cubic(rates[pick], angles[pick]) for pick in picks if len(np.unique(pick)) > 5])
    width = np.array([_width(*found) for found in again])
    (low_0, high_0), (low_1, high_1), (low, high) = (interval(v) for v in (again[:, 0], again[:, 1], width))
    result.figures = {
        "neutral_angle": Figure(a_0, "deg", low=low_0, high=high_0),
        "slope": Figure(a_1, "deg per deg/s", low=low_1, high=high_1),
        "loop_width": Figure(_width(a_0, a_1, a_3), "deg", low=low, high=high),
    }
    result.traces["cubic"] = np.array([a_0, a_1, a_3])
    result.verdicts["course_stability"] = (
        f"stable: {a_1:+.2f} deg of steering per deg/s about straight running"
        if a_1 > 0.0
        else f"unstable: {a_1:+.2f} deg of steering per deg/s about straight running"
    )
    # Steering must be held against a bias, so it lies on the other side.
    result.verdicts["bias"] = (
        f"none: neutral angle {a_0:+.2f} deg"
        if low_0 <= 0.0 <= high_0 or abs(a_0) < 0.1
        else named(-a_0, f"the neutral angle is {a_0:+.2f} deg")
    )


def _cubic(rates: Array, angles: Array) -> tuple[float, float, float]:
    """Coefficients of delta = a0 + a1 r + a3 r^3 by least squares."""
    design = np.column_stack([np.ones_like(rates), rates, rates**3])
    solved = np.linalg.lstsq(design, angles, rcond=None)[0]
    return float(solved[0]), float(solved[1]), float(solved[2])


def _width(a_0: float, a_1: float, a_3: float) -> float:
    """Width [deg] between the turning points of the cubic, 0 for a stable one."""
    if a_1 >= 0.0 or a_3 <= 0.0:
        return 0.0
    return 4.0 / (3.0 * math.sqrt(3.0)) * (-a_1) ** 1.5 / math.sqrt(a_3)


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
    judge_pull_outs(result, residual["starboard"].value, residual["port"].value, small)


def judge_pull_outs(result: Result, starboard: float, port: float, small: float) -> None:
    """Verdicts on the yaw rates [deg/s] left after a turn to either side; `small` counts as none."""
    apart, bias = starboard - port, 0.5 * (starboard + port)
    result.figures["bias_rate"] = Figure(bias, "deg/s")
    result.verdicts["course_stability"] = (
        f"stable: both pull-outs end within {abs(apart):.2f} deg/s of one another"
        if abs(apart) <= small
        else f"unstable: {apart:.2f} deg/s remain between the pull-outs from starboard and from port"
    )
    result.verdicts["bias"] = (
        f"none: {bias:+.2f} deg/s is left"
        if abs(bias) <= 0.5 * small
        else named(bias, f"{bias:+.2f} deg/s is left, the mean of both pull-outs")
    )

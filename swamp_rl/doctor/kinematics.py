"""Whether positions, heading, speed and yaw rate of the runs agree with one another."""

import cmath
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.constants import FOOT, KNOT
from swamp_rl.doctor.finding import Finding
from swamp_rl.doctor.smooth import Motion
from swamp_rl.doctor.surge_is_speed import surge_is_speed
from swamp_rl.doctor.surge_scale import surge_scale
from swamp_rl.doctor.unrelated import heading_unrelated, measured_against_positions

Array = NDArray[np.float64]

ALIGNED = 0.8
"""Mean resultant length of course minus heading, weighted by speed squared, from which the two are taken as
tied to each other: the root mean square angle between them is then below 0.67 rad."""
BETTER = 0.15
"""By how much the resultant of course plus heading must pass that of course minus heading."""
LARGEST_DRIFT = math.radians(30.0)
"""A boat's mean drift angle over whole runs stays below it; ENU, astern and magnetic mistakes of heading are
larger or cannot be distinguished from drift."""
TIED = 0.7
"""Correlation from which the ratio of two records is a unit: half of the variance is common."""
SPEEDS = {"kn": 1.0 / KNOT, "km/h": 3.6, "cm/s": 100.0, "mm/s": 1000.0, "ft/s": 1.0 / FOOT}
TURNS = {"deg/s": 180.0 / math.pi, "rpm": 30.0 / math.pi}
UNIT_TOLERANCE = 0.25
"""Of the logarithm of a ratio: half the distance between knots and feet per second, or 1 and knots, is 0.23
and 0.33."""


def kinematic_findings(
    motions: Sequence[Motion], exchanged: bool | None = None
) -> tuple[list[Finding], list[Motion]]:
    """What contradicts itself, and the motions with the heading and yaw rate that would be consistent.

    exchanged: whether north and east are, and not the heading of another frame, where one of these is; None:
    as the yaw rate suggests.
    """
    if not motions:
        return [], []
    doubted = _wrong_heading(motions)
    if any(one.level == "fault" for one in doubted):
        return doubted, []  # the other checks rest on the heading
    velocity, motions = _velocity_against_positions(motions)
    heading, motions = _heading_against_course(motions, exchanged)
    turning = _yaw_rate_against_heading(motions)
    found = [*doubted, *velocity, *heading, *turning]
    known = [one for one in motions if one.surge is not None]
    if known:
        surge = np.concatenate([one.surge for one in known if one.surge is not None])
        moved = np.concatenate([one.velocity * np.conj(one.direction) for one in known])
        units = _surge_against_speed(known, surge, moved.real)
        found += units or surge_scale(known)
        found += surge_is_speed(known) if not velocity + heading else []
    signs = [finding.figures.get("sign", 1.0) for finding in turning]
    if signs and signs[0] < 0.0:
        motions = [_with_flipped_yaw_rate(one) for one in motions]
    return found, motions


def _wrong_heading(motions: Sequence[Motion]) -> list[Finding]:
    """The findings of a heading that is not of the motion, or in another unit."""
    unrelated = heading_unrelated(motions)
    return unrelated or [one for one in _yaw_rate_against_heading(motions) if one.columns == ("heading",)]


def _velocity_against_positions(motions: Sequence[Motion]) -> tuple[list[Finding], list[Motion]]:
    """Whether the measured velocity is of other axes than the positions, where the heading agrees with these;
    and the motions without it.
    """
    without = [_without_velocity(one) for one in motions]
    message = measured_against_positions(motions, ALIGNED, BETTER)
    if message is None or _heading_against_course(without, None)[0]:
        return [], list(motions)
    advice = "check which columns are mapped to the velocity, and their axes (--frame)"
    columns = ("surge", "sway")
    return [Finding("fault", "velocity_disagrees", columns, message, advice)], without


def _without_velocity(motion: Motion) -> Motion:
    return replace(motion, surge=None, sway=None)


def _resultants(motions: Sequence[Motion]) -> tuple[complex, complex]:
    """Mean of exp(i (course − heading)) and exp(i (course + heading)), weighted by the speed squared."""
    difference = total = 0j
    weight = 0.0
    for one in motions:
        forward = np.ones(len(one.velocity)) if one.surge is None else np.where(one.surge < 0.0, -1.0, 1.0)
        moved = one.velocity * np.abs(one.velocity) * forward
        difference += complex(np.sum(moved * np.conj(one.direction)))
        total += complex(np.sum(moved * one.direction))
        weight += float(np.sum(np.abs(one.velocity) ** 2 * np.abs(one.direction)))
    return (difference / weight, total / weight) if weight > 0.0 else (0j, 0j)


def _heading_against_course(
    motions: Sequence[Motion], exchanged: bool | None
) -> tuple[list[Finding], list[Motion]]:
    difference, total = _resultants(motions)
    figures = {"resultant_difference": abs(difference), "resultant_sum": abs(total)}
    if abs(total) > max(ALIGNED, abs(difference) + BETTER):
        angle = cmath.phase(total)
        agrees = (_slope_of_turning(motions) or -1.0) > 0.0
        mirrored = _mirrored(angle, figures, agrees, agrees if exchanged is None else exchanged)
        if mirrored.code == "axes_exchanged":
            return [mirrored], [replace(one, velocity=1j * np.conj(one.velocity)) for one in motions]
        corrected = [
            one.with_heading(np.conj(one.direction) * cmath.exp(1j * angle), -one.turning) for one in motions
        ]
        if mirrored.code == "heading_enu" and agrees:
            corrected = [_with_flipped_yaw_rate(one) for one in corrected]
        return [mirrored], corrected
    angle = cmath.phase(difference)
    if abs(difference) > ALIGNED and abs(angle) > LARGEST_DRIFT:
        message = f"course over ground minus heading is {math.degrees(angle):+.0f} degrees on average"
        advice = "check what its zero is (north, east, the stern), or whether north and east changed sign"
        finding = Finding(
            "fault", "heading_offset", ("heading",), message, advice, figures=figures | {"offset_rad": angle}
        )
        return [finding], [
            one.with_heading(one.direction * cmath.exp(1j * angle), one.turning) for one in motions
        ]
    return [], list(motions)


def _mirrored(angle: float, figures: dict[str, float], agrees: bool, exchanged: bool) -> Finding:
    """Course plus heading is constant: the heading counts the other way, or the axes are exchanged. agrees:
    whether yaw_rate has the sign of the heading's slope.
    """
    figures = figures | {"sum_rad": angle}
    message = (
        f"course over ground plus heading is constant ({math.degrees(angle):+.0f} degrees), minus it is not"
    )
    message += ", and heading agrees with yaw_rate" if agrees else ""
    if abs(math.remainder(angle - 0.5 * math.pi, 2.0 * math.pi)) >= LARGEST_DRIFT:
        advice = "heading counts counterclockwise: change its sign (or that of east)"
        return Finding("fault", "heading_flipped", ("heading",), message, advice, figures=figures)
    if exchanged:
        advice = (
            "north and east are exchanged (x, y of an ENU frame, or latitude for longitude): map them the "
            "other way round"
        )
        return Finding("fault", "axes_exchanged", ("north", "east"), message, advice, figures=figures)
    columns, verb = (("heading", "yaw_rate"), "are") if agrees else (("heading",), "is")
    advice = f"{' and '.join(columns)} {verb} counted from east to north (ENU)"
    advice += "" if agrees else ", or north and east are exchanged"
    advice += ": import with --frame enu, mapping yaw"
    return Finding("fault", "heading_enu", columns, message, advice, figures=figures)


def _with_flipped_yaw_rate(motion: Motion) -> Motion:
    return motion if motion.yaw_rate is None else replace(motion, yaw_rate=-motion.yaw_rate)


def _slope_of_turning(motions: Sequence[Motion]) -> float | None:
    """The ratio of yaw rate to the heading's slope, None where they are not tied or one is missing."""
    known = [one for one in motions if one.yaw_rate is not None]
    if not known:
        return None
    given = np.concatenate([one.yaw_rate for one in known if one.yaw_rate is not None])
    turned = np.concatenate([one.turning for one in known])
    size = float(np.linalg.norm(given) * np.linalg.norm(turned))
    if size == 0.0 or abs(float(given @ turned)) < TIED * size:
        return None
    return float(np.sign(given @ turned) * np.linalg.norm(given) / np.linalg.norm(turned))


def _yaw_rate_against_heading(motions: Sequence[Motion]) -> list[Finding]:
    ratio = _slope_of_turning(motions)
    if ratio is None:
        return []
    found = []
    figures = {"ratio": ratio, "sign": math.copysign(1.0, ratio)}
    if ratio < 0.0:
        message = f"has the sign opposite to the rate of change of heading (ratio {ratio:.3g})"
        advice = "change its sign: positive when the bow turns to starboard (z down)"
        found.append(Finding("fault", "yaw_rate_flipped", ("yaw_rate",), message, advice, figures=figures))
    if unit := _unit(abs(ratio), TURNS):
        message = f"is {abs(ratio):.3g} times the rate of change of heading, as {unit} are"
        found.append(
            Finding("fault", "unit", ("yaw_rate",), message, "give it in rad/s (--unit)", figures=figures)
        )
    elif unit := _unit(1.0 / abs(ratio), {"degrees": TURNS["deg/s"]}):
        message = f"changes {1.0 / abs(ratio):.3g} times as fast as yaw_rate, as if in {unit}"
        advice = "give it in rad: --degrees, or radians() within an expression"
        found.append(Finding("fault", "unit", ("heading",), message, advice, figures=figures))
    return found


def _surge_against_speed(known: Sequence[Motion], given: Array, moved: Array) -> list[Finding]:
    """given, moved: (N,) surge and velocity along the heading [m/s] of all motions `known`."""
    size = float(np.linalg.norm(given) * np.linalg.norm(moved))
    if size == 0.0 or abs(float(given @ moved)) < TIED * size:
        return []
    ratio = float(np.linalg.norm(given) / np.linalg.norm(moved))
    figures = {"ratio": ratio}
    found = []
    if given @ moved < 0.0:
        message, advice = "has the sign opposite to the speed made good along the heading", "change its sign"
        found.append(Finding("fault", "surge_flipped", ("surge",), message, advice, figures=figures))
    units = (known[0].run.meta.model_extra or {}).get("units")
    was = units.get("surge") if isinstance(units, dict) else None  # the unit that the import took it for
    if (unit := _unit(ratio * SPEEDS.get(str(was), 1.0), SPEEDS)) and unit != was:
        message = f"is {ratio:.3g} times the speed of the positions along the heading, as {unit} are"
        message += f" that were taken for {was}" if was in SPEEDS else ""
        found.append(
            Finding(
                "fault", "unit", ("surge",), message, f"give it in m/s (--unit surge={unit})", figures=figures
            )
        )
    return found


def _unit(ratio: float, units: dict[str, float]) -> str | None:
    """The unit of which a ratio is nearest, unless 1 is nearer or none is near."""
    distances = {name: abs(math.log(ratio / one)) for name, one in {"": 1.0, **units}.items()}
    nearest = min(distances, key=lambda name: distances[name])
    return nearest if nearest and distances[nearest] < UNIT_TOLERANCE else None

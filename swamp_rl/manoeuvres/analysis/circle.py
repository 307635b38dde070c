"""Figures of a turning circle (ITTC 7.5-04-02-01), as they are and with the drift of its centre removed."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.manoeuvres.analysis.drift import Drift, Turning, drift_of, turning_of
from swamp_rl.manoeuvres.analysis.figure import RESAMPLES, Figure, Result, interval, over
from swamp_rl.manoeuvres.analysis.motion import Motion
from swamp_rl.manoeuvres.analysis.recognise import Recognised

Array = NDArray[np.float64]
FULL = 2.0 * math.pi
LARGEST_DRIFT = 45.0  # deg; ships turn with 10 to 20, fishing vessels with up to 35
TIGHTEST = 1.0  # lengths of the steady diameter; ships turn in 2 to 5
FARTHEST_RUDDER = math.radians(45.0)
PLACES = {  # turned angle [rad], and whether the way there is measured across the first heading
    "advance": (0.5 * math.pi, False),
    "transfer": (0.5 * math.pi, True),
    "tactical_diameter": (math.pi, True),
}


@dataclass(frozen=True)
class Circle:
    """A turn by the angle turned, with the heading [rad] it began on and its side (+1 starboard).

    approach: velocity over ground (2,) before it [m/s]; turns: how many were completed; noise: standard
    deviation [m] of a place, by the track's third differences.
    """

    turning: Turning
    heading: float
    side: float
    approach: Array
    turns: int
    noise: float


def circle_of(motion: Motion, found: Recognised) -> Circle:
    """The turning phase of a recognised turning circle."""
    marks = found.of("turning")
    first, last = motion.row(marks[0].time), found.end(marks[-1], motion)
    rows = slice(first, min(last + 1, len(motion.time)))
    heading = motion.heading_before(first)
    side = math.copysign(1.0, motion.heading[rows][-1] - heading)
    turned = side * (motion.heading[rows] - motion.heading[rows][0])
    turning = turning_of(motion.time[rows], motion.position[rows], turned)
    before = motion.row(motion.time[first] - 3.0)
    approach = np.array([math.nan, math.nan])
    if before < first:
        made = motion.position[first] - motion.position[before]
        approach = made / (motion.time[first] - motion.time[before])
    turns = int(turning.turned[-1] / FULL + 1e-3)
    rough = np.diff(motion.position[rows], 3, axis=0)  # of white noise 20 times its variance
    noise = float(np.sqrt(np.mean(rough**2) / 20.0)) if len(rough) else 0.0
    return Circle(turning, heading, side, approach, turns, noise)


def analyse_circle(motion: Motion, found: Recognised, result: Result, rng: np.random.Generator) -> None:
    """Fill in the figures, raw and corrected, of a turning circle; what is missing is a note."""
    circle = circle_of(motion, found)
    drift = drift_of(circle.turning, rng)
    result.figures = circle_figures(circle, None, rng)
    result.traces |= {"raw": circle.turning.place, "heading": np.array(circle.heading)}
    asked = found.setting.get("angle", circle.side)
    if asked * circle.side < 0.0:
        to, against = ("starboard", "port") if circle.side > 0 else ("port", "starboard")
        result.notes.append(f"the boat turned to {to}, against the steering to {against}")
    if circle.turns == 0:
        turned = math.degrees(circle.turning.turned[-1])
        result.notes.append(
            f"no complete turn, {turned:.0f} deg only: first-turn figures as far as available"
        )
    if drift is None:
        result.notes.append(
            "less than 1.75 turns: the drift of the centre is not identifiable and not corrected"
        )
        return
    result.corrected = circle_figures(circle, drift, rng)
    result.notes += extraordinary(result.corrected, motion.length, asked)
    speed, toward = np.hypot(*drift.velocity), math.atan2(drift.velocity[1], drift.velocity[0])
    low, high = interval(np.hypot(*drift.resamples.T))
    result.figures["drift_speed"] = Figure(float(speed), "m/s", low=low, high=high)
    result.figures["drift_towards"] = Figure(math.degrees(toward) % 360.0, "deg")
    away = circle.turning.time - circle.turning.time[0]
    result.traces["corrected"] = circle.turning.place - away[:, None] * drift.velocity


def extraordinary(figures: dict[str, Figure], length: float, angle: float) -> list[str]:
    """A line where a circle is outside what boats under way do by a rudder or a nozzle, else none.

    length [m] of the boat; angle [rad] of the steering: thrusters that turn farther turn a boat on the spot.
    """
    drift_angle, diameter = figures["drift_angle"].value, figures["steady_diameter"].value / length
    if abs(angle) > FARTHEST_RUDDER or not (drift_angle > LARGEST_DRIFT or diameter < TIGHTEST):
        return []
    return [
        f"drift angle {drift_angle:.0f} deg, steady diameter {diameter:.2f} L: boats under way keep below "
        f"{LARGEST_DRIFT:g} deg and above {TIGHTEST:g} L; check the length, and in a boat file the draught "
        "and the yaw damping"
    ]


def circle_figures(circle: Circle, drift: Drift | None, rng: np.random.Generator) -> dict[str, Figure]:
    """Every figure of a circle, over ground, or through the water where a drift is given."""
    water = np.zeros(2) if drift is None else drift.velocity
    away = circle.turning.time - circle.turning.time[0]
    turning = Turning(
        circle.turning.turned, circle.turning.time, circle.turning.place - away[:, None] * water
    )
    ahead = np.array([math.cos(circle.heading), math.sin(circle.heading)])
    aside = circle.side * np.array([-ahead[1], ahead[0]])
    found = {}
    for name, (angle, across) in PLACES.items():
        along = aside if across else ahead
        found[name] = _way(circle, turning, drift, along, angle, rng)
    steady = [_steady(circle, turning, k) for k in range(circle.turns)]
    later = steady[len(steady) // 2 :]  # the boat loses speed in the turns before
    for i, (name, unit) in enumerate(STEADY.items()):
        found[name] = over([values[i] for values in later], unit, rng)
    start = float(np.hypot(*(circle.approach - water)))
    found["approach_speed"] = Figure(start, "m/s")
    start = start or math.nan  # from rest there is no speed to lose
    speed = found["steady_speed"]
    found["speed_loss"] = Figure(
        1.0 - speed.value / start,
        "1",
        tuple(1.0 - each / start for each in speed.each),
        1.0 - speed.high / start,
        1.0 - speed.low / start,
    )
    return found


STEADY = {"steady_diameter": "m", "steady_speed": "m/s", "drift_angle": "deg", "turning_rate": "deg/s"}


def _way(
    circle: Circle,
    turning: Turning,
    drift: Drift | None,
    along: Array,
    angle: float,
    rng: np.random.Generator,
) -> Figure:
    """The way along a direction from the start of each turn to `angle` further on; the first counts."""
    starts = [FULL * k for k in range(circle.turns + 1)]
    each = [float((turning.at(start + angle) - turning.at(start)) @ along) for start in starts]
    off = rng.normal(0.0, math.sqrt(2.0) * circle.noise, RESAMPLES)  # of its two ends
    if drift is not None:
        # The way hangs on the drift linearly, so the resampled drifts need no new search for the angle.
        gone = turning.moment(angle) - turning.moment(0.0)
        off -= gone * (drift.resamples - drift.velocity) @ along
    low, high = interval(each[0] + off)
    return Figure(each[0], "m", tuple(way for way in each if math.isfinite(way)), low, high)


def _steady(circle: Circle, turning: Turning, number: int) -> tuple[float, float, float, float]:
    """Diameter [m], speed [m/s], drift angle [deg], positive with the bow inwards, rate [deg/s] of a turn."""
    rows = (turning.turned >= FULL * number - 1e-9) & (turning.turned <= FULL * (number + 1) + 1e-9)
    place, turned, time = turning.place[rows], turning.turned[rows], turning.time[rows]
    heading = circle.heading + circle.side * 0.5 * (turned[1:] + turned[:-1])
    way, lasted = np.diff(place, axis=0), float(time[-1] - time[0])
    surge = float(np.sum(way[:, 0] * np.cos(heading) + way[:, 1] * np.sin(heading))) / lasted
    sway = float(np.sum(way[:, 1] * np.cos(heading) - way[:, 0] * np.sin(heading))) / lasted
    drift_angle = math.degrees(math.atan2(-circle.side * sway, surge))
    return fitted_diameter(place), math.hypot(surge, sway), drift_angle, 360.0 / lasted


def fitted_diameter(place: Array) -> float:
    """Diameter [m] of the circle through places (N, 2), by linear least squares (Kasa 1976)."""
    centred = place - place.mean(axis=0)
    design = np.column_stack([centred, np.ones(len(centred))])
    (a, b, c), *_ = np.linalg.lstsq(design, (centred**2).sum(axis=1), rcond=None)
    return float(2.0 * math.sqrt(max(c + 0.25 * (a * a + b * b), 0.0)))

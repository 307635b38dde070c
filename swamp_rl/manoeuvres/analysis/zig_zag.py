"""Figures of a zig-zag: overshoots, initial turning ability, times (ITTC 7.5-04-02-01)."""

import math
from itertools import pairwise

import numpy as np

from swamp_rl.manoeuvres.analysis.figure import Figure, Result, over
from swamp_rl.manoeuvres.analysis.motion import Motion
from swamp_rl.manoeuvres.analysis.recognise import Recognised

INITIAL = math.radians(10.0)  # change of heading that the initial turning ability is measured to
SETTLED = 1.0  # deg between two overshoots to one side, so that they count as the same
ABOUT = 0.5  # s to either side of the highest heading that the peak is taken from


def analyse_zig_zag(motion: Motion, found: Recognised, result: Result, rng: np.random.Generator) -> None:
    """Fill in the figures of a zig-zag; a later overshoot that was not recorded to its end is left out."""
    executes = found.of("execute")
    rows = [motion.row(mark.time) for mark in executes]
    end = found.end(executes[-1], motion)
    first = rows[0]
    deviation = motion.heading - motion.heading_before(first)
    side = [math.copysign(1.0, mark.angle) for mark in executes]
    peaks = []
    for i, (row, until) in enumerate(pairwise([*rows[1:], min(end, len(motion.time) - 1)])):
        peak, at = _peak(side[i] * deviation, motion.time, row, until)
        peaks.append(
            (math.degrees(peak - side[i] * deviation[row]), at - motion.time[row], side[i], at, peak)
        )
    overshoots = [overshoot for overshoot, *_ in peaks]
    figures = {
        "approach_speed": Figure(motion.speed_before(first), "m/s"),
        "first_overshoot": Figure(overshoots[0] if peaks else math.nan, "deg"),
        "second_overshoot": Figure(overshoots[1] if len(peaks) > 1 else math.nan, "deg"),
        "overshoot": over(overshoots, "deg", rng),
        "overshoot_starboard": over([peak[0] for peak in peaks if peak[2] > 0], "deg", rng),
        "overshoot_port": over([peak[0] for peak in peaks if peak[2] < 0], "deg", rng),
        "overshoot_time": over([peak[1] for peak in peaks], "s", rng),
        "period": over([b.time - a.time for a, b in zip(executes, executes[2:], strict=False)], "s", rng),
        "initial_turning": _initial_turning(motion, side[0] * deviation, first),
    }
    result.figures = figures
    result.traces |= {
        "time": motion.time[first:] - motion.time[first],
        "heading": np.degrees(deviation[first:]),
        "angle": np.degrees(motion.angle[first:]),
        "place": motion.position[first : min(end, len(motion.time) - 1) + 1],
        "course": np.array(motion.heading_before(first)),
    }
    if len(executes) < 2:
        result.notes.append("the heading never reached the second execute: no overshoot")
    _bias(result)


def _peak(deviation: np.ndarray, time: np.ndarray, row: int, until: int) -> tuple[float, float]:
    """Highest deviation [rad] between two rows and its time [s], by a parabola through what is about it."""
    top = row + int(np.argmax(deviation[row : until + 1]))
    near = np.abs(time - time[top]) <= ABOUT
    if near.sum() < 4 or top in (row, until):
        return float(deviation[top]), float(time[top])
    a, b, c = np.polyfit(time[near] - time[top], deviation[near], 2)
    if a >= 0.0 or abs(b / (2.0 * a)) > ABOUT:
        return float(deviation[top]), float(time[top])
    return float(c - b * b / (4.0 * a)), float(time[top] - b / (2.0 * a))


def _initial_turning(motion: Motion, deviation: np.ndarray, first: int) -> Figure:
    """Way [m] from the first execute until the heading has changed by 10 degrees."""
    reached = np.flatnonzero(deviation[first:] >= INITIAL)
    if len(reached) == 0 or reached[0] == 0:  # never, or the boat was turning already
        return Figure(math.nan, "m")
    last = first + int(reached[0])
    steps = np.diff(motion.time[first : last + 1])
    speed = np.hypot(motion.surge, motion.sway)[first : last + 1]
    way = float(np.sum(0.5 * (speed[1:] + speed[:-1]) * steps))
    beyond = (deviation[last] - INITIAL) / max(deviation[last] - deviation[last - 1], 1e-12)
    return Figure(way - float(beyond * steps[-1] * speed[-1]), "m")


def _bias(result: Result) -> None:
    """The last overshoots to either side, once they repeat: an unstable boat first swings up to them."""
    starboard, port = (result.figures[f"overshoot_{side}"].each for side in ("starboard", "port"))
    longer = max(starboard, port, key=len)
    if len(longer) < 2 or not (starboard and port):
        return
    change = abs(longer[-1] - longer[-2])
    more = starboard[-1] - port[-1]
    if change > SETTLED:
        result.verdicts["bias"] = f"undetermined: the overshoots still changed by {change:.1f} deg"
    elif abs(more) <= SETTLED:
        result.verdicts["bias"] = f"none: the last overshoots to either side differ by {more:+z.1f} deg"
    else:
        toward = "starboard" if more > 0 else "port"
        result.verdicts["bias"] = f"to {toward}: it overshoots {abs(more):.1f} deg more to that side"

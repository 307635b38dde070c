"""Figures of stopping trials and of straight runs."""

import math

import numpy as np

from swamp_rl.manoeuvres.analysis.figure import Figure, Result, over_blocks
from swamp_rl.manoeuvres.analysis.motion import Motion
from swamp_rl.manoeuvres.analysis.recognise import Recognised

BLOCKS = 6


def analyse_stopping(motion: Motion, found: Recognised, result: Result, rng: np.random.Generator) -> None:
    """Track reach, head reach, lateral deviation, time; to where the surge over ground first is zero."""
    mark = found.of("astern")[0]
    first, end = motion.row(mark.time), min(found.end(mark, motion), len(motion.time) - 1)
    stopped = np.flatnonzero(motion.surge[first : end + 1] <= 0.0)
    last = first + int(stopped[0]) if len(stopped) else end
    heading = motion.heading_before(first)
    made = motion.position[last] - motion.position[first]
    ahead = np.array([math.cos(heading), math.sin(heading)])
    speed = np.hypot(motion.surge, motion.sway)[first : last + 1]
    way = float(np.sum(0.5 * (speed[1:] + speed[:-1]) * np.diff(motion.time[first : last + 1])))
    result.figures = {
        "approach_speed": Figure(motion.speed_before(first), "m/s"),
        "track_reach": Figure(way, "m"),
        "head_reach": Figure(float(made @ ahead), "m"),
        "lateral_deviation": Figure(float(made @ np.array([-ahead[1], ahead[0]])), "m"),
        "stopping_time": Figure(float(motion.time[last] - motion.time[first]), "s"),
        "heading_change": Figure(math.degrees(motion.heading[last] - heading), "deg"),
    }
    result.traces |= {
        "time": motion.time[first : last + 1] - motion.time[first],
        "surge": motion.surge[first : last + 1],
    }
    if not len(stopped):
        result.notes.append("the boat did not stop: the figures are those at the end of the run")


def analyse_straight(motion: Motion, found: Recognised, result: Result, rng: np.random.Generator) -> None:
    """Mean speed over ground of the measured part, positive ahead, and how straight it was."""
    marks = found.of("measured")
    if not marks:
        result.notes.append("the measured part was not reached: no speed")
        return
    first, end = motion.row(marks[0].time), found.end(marks[0], motion)
    rows = slice(first, end)
    result.figures = {
        "speed": over_blocks(motion.surge[rows], BLOCKS, "m/s", rng),
        "throttle": Figure(float(np.mean(np.abs(motion.throttle[rows]))), "1"),
        "heading_sd": Figure(float(np.degrees(motion.heading[rows]).std()), "deg"),
        "steering_mean": over_blocks(np.degrees(motion.angle[rows]), BLOCKS, "deg", rng),
    }

"""Propellers matched to the Typhoon against its two papers, 003 and 004, and an independent program."""

import math
from functools import cache

import numpy as np

from benchmarks.validation.check import Check, check
from swamp_rl.boat.screw import Disc, bollard_factor
from swamp_rl.constants import KNOT
from swamp_rl.design.matching import best_ranges, drag_factor, load_match, matches
from swamp_rl.physics.thrusters import azimuth_after

SHARE = 0.03
JOULES = 3.6e6  # of a kWh
DRAG = ((1, 12.54, 0.1431), (2, 22.40, 0.1278), (3, 31.16, 0.1202), (5, 48.87, 0.1115))  # table 2: m/s, N, 1
STEPS = (  # table 5: first and last speed [r/min], sample time, rise [s], mean acceleration [rad/s2]
    (1000, -1000, 0.288, 0.6, 350.0),  # printed 21000: the sign misread
    (1400, -1400, 0.288, 0.6, 480.0),
    (1500, -1500, 0.288, 0.7, 445.0),
    (0, 1000, 0.144, 0.15, 600.0),
    (0, 1500, 0.144, 0.15, 900.0),
)
DIAMETER, DENSITY = 0.33, 1025.0  # m, kg/m3


@cache
def matching_checks() -> list[Check]:
    """What 004 prints: the rule of its powers at best range, its table of drag, its steps, its energy."""
    design = load_match("typhoon_cfd")
    found = []
    for one in best_ranges(design):
        power = f"{one.onboard_power:g} W on board"
        share = one.onboard_power / one.propulsion_power
        number = "W_inst / W_e at best range"
        found.append(check(f"{number} with {power}", "(24)", 2, share, SHARE, reading_of=number))
    for speed, force, coefficient in DRAG:
        drag = drag_factor(coefficient, DIAMETER, DENSITY) * speed**2
        reason = (
            f"by (1) the printed C_DX = {coefficient:g} gives {drag:.1f} N; the printed {force:g} N are "
            "ρ A C_DX u, linear in the speed, which is ρ A C_DX u²/2 at 2 m/s alone."
        )
        what = f"drag at {speed} m/s, N"
        found.append(check(what, "table 2", force, drag, SHARE, reason=reason, contradicted=True))
    found += rise_checks()
    return [*found, check("energy of two packs, kWh", "table 3", 3.84, design.energy / JOULES, SHARE)]


def rise_checks() -> list[Check]:
    """004's step tests: the time in which a drive that accelerates as printed makes the printed step.

    By the law that limits the rate of a throttle; the rise is resolved to one sample of the drive's log.
    """
    found = []
    for test, (first, last, sample, rise, acceleration) in enumerate(STEPS, 1):
        start, end = (2.0 * math.pi / 60.0 * speed for speed in (first, last))
        near = np.linspace(0.0, 2.0 * rise, 2001)
        speeds = np.array([azimuth_after(start, end, 0.0, acceleration, float(time)) for time in near])
        ours = float(near[np.argmax(np.abs(speeds - end) < 1e-9)])
        what = f"rise of {abs(last - first)} r/min, test {test}, s"
        found.append(check(what, "table 5, its mean acceleration", rise, ours, 0.0, 0.5 * sample))
    return found


def independent_checks() -> list[Check]:
    """What the papers draw but do not print: an independent program's numbers for the same equations."""
    found = [
        check(f"speed of best range with {one.onboard_power:g} W on board, kn", "004 (23)", *pair, SHARE)
        for one, printed in zip(best_ranges(load_match("typhoon_cfd")), (2.6, 4.1), strict=True)
        for pair in [(printed, one.speed / KNOT)]
    ]
    ends = matches(load_match("typhoon_match"))
    for match, value in ((ends[0], 0.59), (ends[-1], 0.75)):
        pitch = match.pitch
        what = f"J* at p/d {pitch.pitch_ratio:g}, K_tb {pitch.bollard_coefficient:g} (assumed)"
        found.append(check(what, "004 (15)", value, match.advance, SHARE))
    for ratio, value in ((0.8, 0.399), (1.0, 0.559), (1.2, 0.714), (1.4, 0.858)):
        ours = bollard_factor(Disc(kind="disc", pitch_ratio=ratio))
        found.append(
            check(f"K_t(0) of a boat file's disc at p/d {ratio:g}", "003 (11), (15)", value, ours, SHARE)
        )
    return found

"""Excitation that the runs lack: motions without which some effects are not identifiable."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.checks import reach_of
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.options import options
from swamp_rl.simulator.reference import reference_of

Array = NDArray[np.float64]


def missing_motion(run_set: RunSet, held_out: bool = False) -> list[str]:
    """What the runs lack, as sentences that say what to record; empty where nothing is missing.

    held_out: whether the gain is measured on other runs.
    """
    read, of = _read(run_set), reference_of(run_set.boat)
    speed, turn, heading = (np.concatenate(parts) for parts in zip(*read, strict=True))
    way, turning = options().least_way * of.speed, options().least_turning * of.rate
    moving = speed > way
    # the heading of one run covers a full turn under way
    circled = any((fast > way).any() and np.ptp(course[fast > way]) >= math.tau for fast, _, course in read)
    lacks = []
    if not _often(moving):
        lacks.append("way through the water: the boat hardly moves; run ahead at two speeds")
    elif not _two_speeds(speed[moving]):
        lacks.append(
            "a second speed: run ahead slower or faster as well, and let the boat gather way and stop"
        )
    sides = [
        side
        for side, turns in (("starboard", turn > turning), ("port", turn < -turning))
        if not _often(turns)
    ]
    if sides:
        lacks.append(f"turns to {' and to '.join(sides)}: sail circles or zig-zags")
    if np.ptp(turn) < turning and not sides:
        lacks.append("turns of another rate: sail circles of two sizes")
    if not circled and len(_quadrants(heading[moving])) < options().quadrants:
        lacks.append("courses in all directions, to separate wind, current and heading bias")
    lacks += _idle(run_set)
    lacks += _standing(run_set)
    if run_set.too_short:
        lacks.append(
            f"length in {', '.join(run_set.too_short)}: shorter than {options().shortest_run:g} s, left out"
        )
    if len(run_set.lengths) == 1 and not held_out:
        lacks.append("a second run, to hold out: with one, nothing is held out")
    return lacks


def _read(run_set: RunSet) -> list[tuple[Array, Array, Array]]:
    """Speed over ground [m/s], turning rate [rad/s] and heading [rad] of each run, over `speed_span`."""
    reach = max(1, round(options().speed_span / run_set.dt))
    found = []
    for run, length in enumerate(run_set.lengths):
        track = run_set.measured[run, :length, :3]
        there = track[np.isfinite(track).all(axis=1)]
        if len(there) <= reach:
            there = np.repeat(there[:1], reach + 1, axis=0)
        moved = (there[reach:] - there[:-reach]) / (reach * run_set.dt)
        found.append((np.hypot(moved[:, 0], moved[:, 1]), moved[:, 2], there[reach:, 2]))
    return found


def _often(flags: NDArray[np.bool_]) -> bool:
    return bool(flags.mean() >= options().least_share)


def _two_speeds(speed: Array) -> bool:
    low, high = np.quantile(speed, [options().least_share, 1.0 - options().least_share])
    return bool(high > options().speeds_apart * low)


def _quadrants(heading: Array) -> set[int]:
    places = np.floor(np.mod(heading, 2.0 * np.pi) / (2.0 * np.pi / options().quadrants)).astype(int)
    return {int(place) for place in np.unique(places) if _often(places == place)}


def _standing(run_set: RunSet) -> list[str]:
    """Names of the runs in which the boat stands still under thrust, as a sentence."""
    levels = np.abs(run_set.commands[..., len(run_set.boat.thrusters) :]).max(axis=-1)
    still = [
        run_set.names[run]
        for run, length in enumerate(run_set.lengths)
        if _often(levels[run, :length] > options().running_command * max(float(levels.max()), 1e-9))
        and _is_still(run_set, run)
    ]
    if not still:
        return []
    return [
        f"way in {', '.join(still)}: the boat stands still there under thrust; if it was moored, or measured "
        "at another time, leave the run out"
    ]


def _is_still(run_set: RunSet, run: int) -> bool:
    travelled, turned = reach_of(run_set.measured[run, : run_set.lengths[run], :3], run_set.dt)
    return travelled < options().still_lengths * run_set.boat.length and turned < options().still_turn


def _idle(run_set: RunSet) -> list[str]:
    """Thrusters that hardly run, that never turn, or whose thrust never changes, as sentences."""
    names = run_set.boat.thruster_names
    commands = np.concatenate([run_set.commands[run, :length] for run, length in enumerate(run_set.lengths)])
    angles, levels = commands[:, : len(names)], np.abs(commands[:, len(names) :])
    running = levels > options().running_command * max(float(levels.max()), 1e-9)
    stopped = [name for k, name in enumerate(names) if not _often(running[:, k])]
    works = [k for k, name in enumerate(names) if name not in stopped]
    fixed = [
        names[k]
        for k in works
        if np.ptp(angles[:, k]) < options().least_steering and run_set.boat.thrusters[k].kind != "fixed"
    ]
    ends = [options().least_share, 1 - options().least_share]
    steady = [
        names[k]
        for k in works
        if np.ptp(np.quantile(levels[:, k], ends)) < options().least_throttle_range * levels.max()
    ]
    lacks = []
    if stopped:
        lacks.append(f"thrust of {', '.join(stopped)}: run {'it' if len(stopped) == 1 else 'them'} as well")
    if fixed:
        lacks.append(
            f"steering by {', '.join(fixed)}: turn {'it' if len(fixed) == 1 else 'them'} while running"
        )
    if steady:
        lacks.append(f"other thrust levels of {', '.join(steady)}: step the throttle up and down")
    return lacks

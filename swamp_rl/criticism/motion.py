"""Excitation that the runs lack: motions without which some causes are not identifiable."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.refusals import SHORTEST, STILL, UNTURNED, reach_of

Array = NDArray[np.float64]

SPAN = 2.0  # s over which speed and turning are read off the track
MOVING = 0.1  # m/s, below which a boat lies still
SPEEDS_APART = 1.4  # the faster over the slower, of two speeds
TURNING = 0.05  # rad/s
SHARE = 0.05  # of the time that a motion must last to be there at all
RUNNING = 0.02  # of the most that a thruster was ever asked for
TURNED = 0.1  # rad that an azimuth or a rudder must move
QUADRANTS = 4  # of the compass
FULL_TURN = 2.0 * np.pi  # rad


def missing_motion(trials: Trials, held_out: bool = False) -> list[str]:
    """What the runs do not hold, in words that say what to record; empty where nothing is missing.

    held_out: whether there are other runs, which the gain is measured on.
    """
    speed, turn, heading = (np.concatenate(parts) for parts in zip(*_read(trials), strict=True))
    moving = speed > MOVING
    lacks = []
    if not _often(moving):
        lacks.append("way through the water: the boat hardly moves; run ahead at two speeds")
    elif not _two_speeds(speed[moving]):
        lacks.append(
            "a second speed: run ahead slower or faster as well, and let the boat gather way and stop"
        )
    sides = [
        side
        for side, turns in (("starboard", turn > TURNING), ("port", turn < -TURNING))
        if not _often(turns)
    ]
    if sides:
        lacks.append(f"turns to {' and to '.join(sides)}: sail circles or zig-zags")
    if np.ptp(turn) < TURNING and not sides:
        lacks.append("turns of another rate: sail circles of two sizes")
    if not _full_circle(trials) and len(_quadrants(heading[moving])) < QUADRANTS:
        lacks.append("courses all round the compass, without which wind, current and a heading bias hide")
    lacks += _idle(trials)
    lacks += _standing(trials)
    if trials.too_short:
        lacks.append(f"length in {', '.join(trials.too_short)}: shorter than {SHORTEST:g} s, left out")
    if len(trials.lengths) == 1 and not held_out:
        lacks.append("a second run, to hold out: with one, nothing is held out")
    return lacks


def _read(trials: Trials) -> list[tuple[Array, Array, Array]]:
    """Speed over ground [m/s], turning [rad/s] and heading [rad] of each run, over spans of SPAN."""
    reach = max(1, round(SPAN / trials.dt))
    found = []
    for run, length in enumerate(trials.lengths):
        track = trials.measured[run, :length, :3]
        there = track[np.isfinite(track).all(axis=1)]
        if len(there) <= reach:
            there = np.repeat(there[:1], reach + 1, axis=0)
        moved = (there[reach:] - there[:-reach]) / (reach * trials.dt)
        found.append((np.hypot(moved[:, 0], moved[:, 1]), moved[:, 2], there[reach:, 2]))
    return found


def _often(flags: NDArray[np.bool_]) -> bool:
    return bool(flags.mean() >= SHARE)


def _two_speeds(speed: Array) -> bool:
    low, high = np.quantile(speed, [SHARE, 1.0 - SHARE])
    return bool(high > SPEEDS_APART * low)


def _quadrants(heading: Array) -> set[int]:
    places = np.floor(np.mod(heading, 2.0 * np.pi) / (2.0 * np.pi / QUADRANTS)).astype(int)
    return {int(place) for place in np.unique(places) if _often(places == place)}


def _full_circle(trials: Trials) -> bool:
    """Whether a run turns once all round under way, however long the others keep one course."""
    return any(
        bool(np.ptp(heading[speed > MOVING]) >= FULL_TURN)
        for speed, _, heading in _read(trials)
        if (speed > MOVING).any()
    )


def _standing(trials: Trials) -> list[str]:
    """Runs in which the boat stands still under thrust."""
    levels = np.abs(trials.commands[..., len(trials.boat.thrusters) :]).max(axis=-1)
    still = [
        trials.names[run]
        for run, length in enumerate(trials.lengths)
        if _often(levels[run, :length] > RUNNING * max(float(levels.max()), 1e-9)) and _is_still(trials, run)
    ]
    if not still:
        return []
    return [
        f"way in {', '.join(still)}: the boat stands still there under thrust; if it was moored, or measured "
        "at another time, leave the run out"
    ]


def _is_still(trials: Trials, run: int) -> bool:
    travelled, turned = reach_of(trials.measured[run, : trials.lengths[run], :3], trials.dt)
    return travelled < STILL and turned < UNTURNED


def _idle(trials: Trials) -> list[str]:
    """Thrusters that hardly ever run, and those that never turn or never change their thrust."""
    names = trials.boat.thruster_names
    commands = np.concatenate([trials.commands[run, :length] for run, length in enumerate(trials.lengths)])
    angles, levels = commands[:, : len(names)], np.abs(commands[:, len(names) :])
    running = levels > RUNNING * max(float(levels.max()), 1e-9)
    stopped = [name for k, name in enumerate(names) if not _often(running[:, k])]
    works = [k for k, name in enumerate(names) if name not in stopped]
    fixed = [
        names[k] for k in works if np.ptp(angles[:, k]) < TURNED and trials.boat.thrusters[k].kind != "fixed"
    ]
    steady = [
        names[k] for k in works if np.ptp(np.quantile(levels[:, k], [SHARE, 1 - SHARE])) < 0.1 * levels.max()
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

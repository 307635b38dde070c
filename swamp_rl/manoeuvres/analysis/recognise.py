"""Which manoeuvre a run holds and where its phases begin: from its metadata or from its commands."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, get_args

import numpy as np

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.analysis.motion import Motion
from swamp_rl.manoeuvres.controller import DONE, GAVE_UP, Kind
from swamp_rl.manoeuvres.execute import Mark
from swamp_rl.runs import RunMeta

LEAST = math.radians(2.0)  # of steering that counts as an order
WAY = 0.5  # of the median speed, that a boat must make for an order to count
HELD = 0.5  # s that an order is held at least
EXECUTES = 3  # of the steering, to either side in turn, that make a zig-zag
RAMP_SPAN, RAMP_SHARE = 0.25, 0.2  # s over which steering moves by that share of its fastest, in a ramp
TURNED = math.pi / 2  # of heading that makes a turning circle
BRIEF = 0.2
"""Of the duration of an order: what is shorter before a zig-zag is none, and it is passed for no longer."""
APART = 0.2  # of a turning circle's duration, by which another one begins later or ends earlier
AT_LEAST = 0.5  # of the most held angle, where the steering is not held but stays on its side
LARGEST = {"angle": math.tau, "heading": math.tau, "throttle": 1.0}  # numbers of a setting [rad, rad, 1]


@dataclass(frozen=True)
class Recognised:
    """A manoeuvre in a run: its kind, what is known of its setting, and its marks in order of time; others:
    how many more turning circles the run holds."""

    kind: Kind
    setting: dict[str, Any]
    marks: list[Mark]
    others: int = 0

    def of(self, phase: str) -> list[Mark]:
        """The marks that begin a phase of that name."""
        return [mark for mark in self.marks if mark.phase == phase]

    def end(self, mark: Mark, motion: Motion) -> int:
        """The row at which the phase of a mark is over: that of the next mark, or one beyond the last."""
        later = [other.time for other in self.marks if other.time > mark.time]
        return motion.row(later[0]) if later else len(motion.time)


def recognised(meta: RunMeta, motion: Motion, name: str) -> Recognised:
    """The manoeuvre of a run; UserError with one line where its metadata name none and none can be found.

    dataset.yaml may tell `manoeuvre`, a kind or a mapping with a key `kind`, and `marks`.
    """
    setting = _setting(meta, name)
    kind = setting.get("kind")
    if kind is not None and kind not in get_args(Kind):
        raise UserError(f"run {name}: manoeuvre {kind!r} is none of {', '.join(get_args(Kind))}; correct it")
    marks = [_mark(given, name) for given in listed(meta, "marks", name)]
    if kind is not None and marks:
        ordered = [mark.angle for mark in marks if math.isfinite(mark.angle) and mark.angle != 0.0]
        if not ordered and "angle" not in setting and kind not in ("stopping", "straight"):
            raise UserError(f"run {name}: marks of a {kind} need the angle [rad] that was ordered; add it")
        return Recognised(kind, ({"angle": ordered[0]} if ordered else {}) | setting, marks)
    found = _found(motion, kind)
    if found is None:
        what = f"no {kind}" if kind else "no turning circle or zig-zag"
        raise UserError(
            f"run {name}: {what} found in its commands; give manoeuvre and marks for it in dataset.yaml"
        )
    return replace(found, setting=found.setting | setting)


def _setting(meta: RunMeta, name: str) -> dict[str, Any]:
    """What the meta of the run `name` tells of its manoeuvre; UserError for a value that no manoeuvre has."""
    entry = (meta.model_extra or {}).get("manoeuvre")
    setting = entry if isinstance(entry, dict) else {"kind": entry} if entry else {}
    for key, value in setting.items():
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if key in LARGEST and not (number and abs(value) <= LARGEST[key]):
            allowed = f"must be a number from {-LARGEST[key]:.3g} to {LARGEST[key]:.3g}"
        elif number and not math.isfinite(value):
            allowed = "must be a finite number"
        elif not isinstance(value, str | int | float | None) or not isinstance(key, str):
            allowed = "must be a number, a text, true or false"
        else:
            continue
        entry = f"manoeuvre: {clipped(key)}: {allowed}, not {clipped(repr(value))}"
        raise UserError(f"run {name}: {entry}; correct dataset.yaml")
    return setting


def listed(meta: RunMeta, key: str, name: str) -> list[Any]:
    """The list that the meta of the run `name` holds under a key, empty where there is none; UserError for
    anything else."""
    given = (meta.model_extra or {}).get(key)
    if given is not None and not isinstance(given, list):
        raise UserError(f"run {name}: {key} must be a list, not {clipped(repr(given))}; correct dataset.yaml")
    return given or []


def _mark(given: Any, name: str) -> Mark:
    try:
        time, angle = float(given["time"]), float(given.get("angle", math.nan))
        mark = Mark(time, str(given["phase"]), int(given.get("number", 0)), angle)
        if math.isfinite(time) and not abs(angle) > LARGEST["angle"]:
            return mark
    except (KeyError, TypeError, ValueError, OverflowError, AttributeError):
        pass
    raise UserError(
        f"run {name}: marks must be mappings with time [s], phase, number and angle [rad], not "
        f"{clipped(repr(given))}; correct dataset.yaml"
    )


def _found(motion: Motion, kind: Kind | None) -> Recognised | None:
    """A zig-zag or a turning circle in the steering angle alone, or None."""
    angle = motion.angle
    if not np.isfinite(angle).all():
        return None
    ordered = _most_held(angle)
    over = np.abs(np.abs(angle) - ordered) <= max(LEAST, 0.1 * ordered)
    side = _from_beyond(np.where(over & (np.abs(angle) > LEAST), np.sign(angle), 0.0), angle, ordered)
    last = len(motion.time) - 1
    held = [(a, b) for a, b in _stretches(side) if motion.time[min(b, last)] - motion.time[a] >= HELD]
    if not held:
        return _round(motion, angle, ordered, kind)
    speed = np.hypot(motion.surge, motion.sway)
    way = WAY * float(np.median(speed[held[0][0] : held[-1][1]]))
    # What is ordered before the boat has way on is no trial yet.
    held = [(a, b) for a, b in held if speed[a] >= way] or held
    orders = _orders(held, side, angle, ordered)
    weaves = len(orders) >= EXECUTES and _heading_span(motion, orders) < 2.0 * TURNED
    if kind == "zig-zag" or (kind is None and weaves):
        return _as_zig_zag(motion, orders)
    if kind in ("turning-circle", None):
        return _as_circle(motion, held) or _round(motion, angle, ordered, kind)
    return None


def _round(motion: Motion, angle: Any, ordered: float, kind: Kind | None) -> Recognised | None:
    """A full circle under steering to one side that is not held, as of a measured rudder that wanders."""
    if kind not in ("turning-circle", None):
        return None
    side = np.where(np.abs(angle) > AT_LEAST * ordered, np.sign(angle), 0.0)
    turning = _stretches(side)
    return _as_circle(motion, turning, math.tau) if turning else None


def _stretches(side: Any) -> list[tuple[int, int]]:
    """First row, and one beyond the last, of each stretch of steering to one side (T,), 0 for none."""
    rows = [0, *(np.flatnonzero(np.diff(side) != 0.0) + 1).tolist(), len(side)]
    return [(a, b) for a, b in pairwise(rows) if side[a] != 0.0]


def _from_beyond(side: Any, angle: Any, ordered: float) -> Any:
    """The sides (T,) with those of the rows just before a stretch in which the steering went beyond it: by
    hand an order is passed and taken back."""
    found = side.copy()
    for a, b in _stretches(side):
        row = a
        while row > 0 and a - row < BRIEF * (b - a) and angle[row - 1] * side[a] > ordered:
            row -= 1
        found[row:a] = side[a]
    return found


def _most_held(angle: Any) -> float:
    """The size [rad] of steering that was held the longest, to either side: an approach steers by many."""
    sizes = np.abs(angle[np.abs(angle) > LEAST])
    if len(sizes) == 0:
        return math.inf
    counts, edges = np.histogram(sizes, np.arange(0.0, sizes.max() + 2.0 * LEAST, LEAST))
    fullest = int(np.argmax(counts))
    return float(np.median(sizes[(sizes >= edges[fullest]) & (sizes <= edges[fullest + 1])]))


def _orders(held: list[tuple[int, int]], side: Any, angle: Any, ordered: float) -> list[tuple[int, int]]:
    """Stretches of steering to either side in turn: those to the same side joined where the steering stays on
    it between them, else the longer one; without short ones before the first, which keep the course."""
    orders: list[tuple[int, int]] = []
    for a, b in held:
        if not orders or side[orders[-1][0]] != side[a]:
            orders.append((a, b))
            continue
        first, last = orders[-1]
        if a <= last or np.median(angle[last:a] * side[a]) > AT_LEAST * ordered:
            orders[-1] = (first, b)
        elif b - a > last - first:
            orders[-1] = (a, b)
    usual = float(np.median([b - a for a, b in orders])) if orders else 0.0
    while len(orders) > EXECUTES and orders[0][1] - orders[0][0] < BRIEF * usual:
        orders.pop(0)
    return orders


def _heading_span(motion: Motion, orders: list[tuple[int, int]]) -> float:
    """How far the heading [rad] swings between the first order and the last."""
    return float(np.ptp(motion.heading[orders[0][0] : orders[-1][0] + 1]))


def _began(motion: Motion, row: int) -> int:
    """The row in which the steering began to move to the angle that it has from `row` on: where not the order
    but the steering itself was recorded, it takes its time."""
    angle = motion.angle * np.sign(motion.angle[row])
    span = max(1, motion.row(motion.time[0] + RAMP_SPAN))
    moved = np.concatenate([np.zeros(span), angle[span:] - angle[:-span]])
    fastest = moved[row]
    while row > 0 and moved[row - 1] > RAMP_SHARE * fastest:
        row -= 1
        fastest = max(fastest, moved[row])
    ahead = angle[min(row + span, len(angle) - 1)] - angle[row]
    if ahead > RAMP_SHARE * fastest:  # a ramp: it began where a line meets the angle before it
        row -= min(span, round(span * moved[row] / ahead))
    return row


def _as_zig_zag(motion: Motion, orders: list[tuple[int, int]]) -> Recognised | None:
    if len(orders) < 2:
        return None
    marks = [
        Mark(float(motion.time[_began(motion, a)]), "execute", i + 1, float(np.median(motion.angle[a:b])))
        for i, (a, b) in enumerate(orders)
    ]
    marks.append(Mark(float(motion.time[min(orders[-1][1], len(motion.time) - 1)]), DONE, len(orders), 0.0))
    return Recognised("zig-zag", {"kind": "zig-zag", "angle": marks[0].angle}, marks)


def _as_circle(motion: Motion, held: list[tuple[int, int]], least: float = TURNED) -> Recognised | None:
    ways = [abs(motion.heading[b - 1] - motion.heading[a]) for a, b in held]
    first, last = held[int(np.argmax(ways))]
    turned = np.abs(motion.heading[first:last] - motion.heading[first])
    if turned.max() < least:
        return None
    angle = float(np.median(motion.angle[first:last]))
    marks = [Mark(float(motion.time[_began(motion, first)]), "turning", 1, angle)]
    for number in range(1, int(turned.max() // (2.0 * math.pi)) + 1):
        row = first + int(np.argmax(turned >= 2.0 * math.pi * number))
        marks.append(Mark(float(motion.time[row]), "turning", number + 1, angle))
    marks.append(Mark(float(motion.time[last - 1]), GAVE_UP if len(marks) == 1 else DONE, 0, 0.0))
    apart = APART * (last - first)  # rows; a circle under steering that wanders is several stretches
    others = [
        b <= first - apart or a >= last + apart
        for (a, b), way in zip(held, ways, strict=True)
        if way >= TURNED
    ]
    return Recognised("turning-circle", {"kind": "turning-circle", "angle": angle}, marks, sum(others))

"""Whether the boat answers its commands as its thrusters are placed: exchanged or flipped columns, latency.

Equation error (Ljung 1999, section 7): the yaw acceleration is regressed on the moment that the commands
ask for and on the yaw rate, the surge acceleration on the force ahead and on the drag, over a window that
averages the noise. Thrust is a sum of the level and its square with positive coefficients. Each exchange of
columns, change of sign and shift of time is one hypothesis; the commands as logged are kept unless another
has the greater likelihood by far. Beside the velocities, a shifted periodic command, or one with the other
sign half a period later, explains nearly what the logged one does: it does not count as more likely.
"""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from swamp_rl.boat import Boat
from swamp_rl.doctor.finding import Finding
from swamp_rl.doctor.layout import Place, demanded, followed, places_of
from swamp_rl.doctor.smooth import WINDOWS, Motion, mean, noise_of, rows_of, slope, slope_error

Array = NDArray[np.float64]
Columns = Mapping[str, Array]
Pair = tuple[Array, Array]
Shifted = tuple[Sequence[Pair], float]  # demands of every run, and by how many seconds they act later

LIKELIER = 12.0
"""Difference of log likelihood: exp(12) to one, for at most some twenty hypotheses that are tried."""
FEWEST = 8.0
"""Windows of data, for a regression on three numbers."""
EXPLAINED = 0.1
"""Share of the acceleration's variance that the likeliest commands must explain, else there is no finding."""
ALIKE = 0.85
"""Share of what one hypothesis explains that another would: from it on, commands do not tell them apart."""
LONGEST_SHIFT = 4.0
"""s, to either side."""
COARSE = 0.4
"""s: of the first search, less than a window on either side."""
SHORTEST_LATENCY = 0.5
"""s: below it, latency cannot be distinguished from lags of pumps, propeller races and waves of the hull."""
SHORTEST_STEPS = 2.0
"""Rows: a row's command may have been given up to a step before, and slopes reach a step to either side."""


@dataclass(frozen=True)
class Hypothesis:
    """What may have been done to the columns, and how it is undone."""

    code: str
    message: str
    columns: tuple[str, ...]
    undo: Callable[[Columns], Columns]


@dataclass(frozen=True)
class Answer:
    """A velocity of a run and its rate of change (T,), both over windows of so many rows."""

    rows: int
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class Answers:
    """How one run moved: yaw and surge."""

    motion: Motion
    yaw: Answer
    surge: Answer


def response_findings(motions: Sequence[Motion], boat: Boat | None) -> list[Finding]:
    """An exchange or flip of command columns, or a latency; nothing where the commands say too little."""
    places = places_of(boat, {name: values for one in motions for name, values in one.run.columns.items()})
    answers = [_answers(one) for one in motions if _commanded(one.run.columns, places)]
    if not places or not answers:
        return []
    own = Hypothesis("", "", (), lambda columns: columns)
    tried = [own, *_hypotheses(places, answers[0].motion.run.columns)]
    # Logged commands may be what was asked of the actuators, or how these followed.
    direct = [place.without_lags() for place in places]
    demands = [
        (_demands(answers, places, hypothesis), _demands(answers, direct, hypothesis)) for hypothesis in tried
    ]
    shifted = [tuple(_latest(answers, demand) for demand in pair) for pair in demands]
    likeliest = [
        max(zip(pair, latest, strict=True), key=lambda one: one[1][1])
        for pair, latest in zip(demands, shifted, strict=True)
    ]
    at_best: list[Shifted] = [(asked, shift) for asked, (shift, _, _) in likeliest]
    gains = [_gain(answers, one, at_best[0]) for one in at_best]
    best = max(range(len(tried)), key=lambda i: (gains[i], -i))
    explained = likeliest[best][1][2]
    found = []
    if gains[best] > LIKELIER and explained > EXPLAINED:
        rivals = [i for i in range(1, len(tried)) if i != best and gains[best] - gains[i] < LIKELIER]
        message = " or ".join(tried[i].message for i in (best, *rivals))
        message += f": the boat answers as if so (log likelihood {gains[best]:+.0f})"
        advice = "check the mapping, the axes (--frame) and the sign conventions of the commands; it obeys "
        advice += " or ".join(_mapped(tried[i]) for i in (best, *rivals))
        figures = {"log_likelihood_gain": gains[best], "explained": explained}
        code, columns = tried[best].code, tried[best].columns
        found.append(Finding("fault", code, columns, message, advice, figures=figures))
    else:
        best = 0
    late = _latency(answers, demands[best][0], shifted[best][0], places, boat is not None)
    early = _latency(answers, demands[best][1], shifted[best][1], places, boat is not None)
    return (
        found
        + [finding for finding in late if finding.figures["latency_s"] > 0.0]
        + [finding for finding in early if finding.figures["latency_s"] < 0.0]
    )


def _commanded(columns: Columns, places: Sequence[Place]) -> bool:
    """Whether the commands of all thrusters are there in every row."""
    names = [name for place in places for name in (place.level, place.angle) if name is not None]
    return all(name in columns and bool(np.isfinite(columns[name]).all()) for name in names)


def _answers(motion: Motion) -> Answers:
    """Measured velocities over windows that average their own noise, else those of heading and positions."""
    speed = np.real(motion.velocity * np.conj(motion.direction / np.maximum(np.abs(motion.direction), 1e-9)))
    surge = motion.run.columns["surge"] if motion.surge is not None else None
    if motion.yaw_rate is None:
        heading = np.unwrap(np.angle(motion.direction))
        yaw = _answer(slope(heading, motion.rows, motion.step), motion.step, motion.rows)
    else:
        raw = motion.run.columns["yaw_rate"]
        flipped = float(motion.yaw_rate @ mean(raw, rows_of(motion.window, motion.step))) < 0.0
        yaw = _answer(-raw if flipped else raw, motion.step)
    return Answers(
        motion,
        yaw,
        _answer(speed, motion.step, motion.rows) if surge is None else _answer(surge, motion.step),
    )


def _answer(velocity: Array, step: float, least: int = 3) -> Answer:
    """Over the shortest window whose slopes have a tenth of noise, and of `least` rows."""
    noise = noise_of(velocity)
    rows = least
    for window in WINDOWS:
        rows = max(least, rows_of(window, step))
        found = slope(velocity, rows, step)
        error = noise * slope_error(rows, step)
        if error < 0.5 * float(np.sqrt(np.mean(found**2))):
            break
    return Answer(rows, mean(velocity, rows), slope(velocity, rows, step))


def _hypotheses(places: Sequence[Place], columns: Columns) -> Iterator[Hypothesis]:
    """Exchanges of thrusters that mirror each other, flips of levels, both together, flips of all angles."""
    exchanges, flips = list(_exchanges(places)), list(_flips(places, columns))
    yield from exchanges
    yield from flips
    for exchange, flip in itertools.product(exchanges, flips):
        yield _both(exchange, flip)
    angles = tuple(place.angle for place in places if place.angle is not None)
    if angles:
        what = "rudder angles" if all(place.rudder for place in places) else "azimuths"
        yield Hypothesis("angles_flipped", f"{what} have the opposite sign", angles, _negated(angles))


def _exchanges(places: Sequence[Place]) -> Iterator[Hypothesis]:
    """Exchanged commands of port and starboard, of bow and stern."""
    sides = [(a, b) for a in places for b in places if a.x == b.x and 0.0 < b.y == -a.y and _alike(a, b)]
    ends = [(a, b) for a in places for b in places if a.y == b.y and 0.0 < a.x == -b.x and _alike(a, b)]
    for pairs, what in ((sides, "port and starboard"), (ends, "bow and stern")):
        if pairs:
            swapped = {
                one: other
                for a, b in pairs
                for one, other in (
                    (a.level, b.level),
                    (b.level, a.level),
                    (a.angle, b.angle),
                    (b.angle, a.angle),
                )
                if one is not None and other is not None
            }
            names = tuple(swapped)
            yield Hypothesis(
                "commands_exchanged", f"commands of {what} are exchanged", names, _renamed(swapped)
            )


def _flips(places: Sequence[Place], columns: Columns) -> Iterator[Hypothesis]:
    """Opposite sign of the level of each thruster that may reverse, and of all of them."""
    names = [place.level for place in places if place.reverses or (columns[place.level] < 0.0).any()]
    for name in names:
        yield Hypothesis("levels_flipped", f"{name} has the opposite sign", (name,), _negated((name,)))
    if len(names) > 1:
        yield Hypothesis("levels_flipped", "levels have the opposite sign", tuple(names), _negated(names))


def _both(one: Hypothesis, other: Hypothesis) -> Hypothesis:
    """Both changes of the logged commands; undoes `other` first."""
    columns = (*one.columns, *(name for name in other.columns if name not in one.columns))
    message = f"{one.message} and {other.message}"
    return Hypothesis(one.code, message, columns, lambda logged: one.undo(other.undo(logged)))


def _mapped(hypothesis: Hypothesis) -> str:
    """The commands that a hypothesis makes of the logged ones, as `--map` gives them."""
    names = hypothesis.columns
    made = hypothesis.undo({name: np.array([number]) for number, name in enumerate(names, 1)})
    signed = {name: int(made[name][0]) for name in names}
    return ", ".join(f"{name}={'-' * (i < 0)}{names[abs(i) - 1]}" for name, i in signed.items())


def _alike(a: Place, b: Place) -> bool:
    return (a.angle is None) == (b.angle is None)


def _renamed(names: Mapping[str, str]) -> Callable[[Columns], Columns]:
    return lambda columns: {**columns, **{one: columns[other] for one, other in names.items()}}


def _negated(names: Sequence[str]) -> Callable[[Columns], Columns]:
    return lambda columns: {**columns, **{name: -columns[name] for name in names}}


def _demands(answers: Sequence[Answers], places: list[Place], hypothesis: Hypothesis) -> list[Pair]:
    """Yaw moment and force ahead (T, 2) that the commands of each run ask for, smoothed as the motion is."""
    found = []
    for answer in answers:
        columns = hypothesis.undo(answer.motion.run.columns)
        force, moment = demanded(followed(columns, places, answer.motion.step), places)
        found.append((_smoothed(moment, answer.yaw.rows), _smoothed(force, answer.surge.rows)))
    return found


def _smoothed(laws: Array, rows: int) -> Array:
    """Means (T, 2) of both laws of thrust."""
    return np.column_stack([mean(law, rows) for law in laws.T])


def _score(answers: Sequence[Answers], demands: Sequence[Pair], shift: float) -> tuple[float, float]:
    """Log likelihood of the two accelerations but for a constant, and the larger share that is explained."""
    total, largest = 0.0, 0.0
    for axis in (0, 1):
        (table, asked), count = _table(answers, axis, [(demands, shift)])
        if count >= FEWEST:
            share = _explained(table, asked)[0]
            total, largest = total - 0.5 * count * math.log1p(-share), max(largest, share)
    return total, largest


def _gain(answers: Sequence[Answers], one: Shifted, other: Shifted) -> float:
    """Log likelihood of demands less that of others, each shifted by so many seconds. An acceleration that
    does not tell them apart may speak for the others alone.
    """
    total = 0.0
    for axis in (0, 1):
        (acceleration, first, second), count = _table(answers, axis, [one, other])
        if count >= FEWEST:
            share, fitted = _explained(acceleration, first)
            gain = 0.5 * count * math.log((1.0 - _explained(acceleration, second)[0]) / (1.0 - share))
            total += gain if _explained(fitted, second)[0] < ALIKE else min(gain, 0.0)
    return total


def _table(answers: Sequence[Answers], axis: int, every: Sequence[Shifted]) -> tuple[list[Array], float]:
    """An acceleration (N, 1) and what each of `every` asks for there (N, 2), less what velocities explain of
    them, and the number of windows.
    """
    parts, count = [], 0.0
    for number, answer in enumerate(answers):
        own = (answer.yaw, answer.surge)[axis]
        rows = [round(shift / answer.motion.step) for _, shift in every]
        used = slice(max(0, *rows) + own.rows, len(own.velocity) + min(0, *rows) - own.rows)
        if used.stop - used.start < 3 * own.rows:
            continue
        v, u = own.velocity[used], answer.surge.velocity[used]
        damping = np.abs(v) * v if axis else u * v
        asked = [
            np.roll(demands[number][axis], late, axis=0)[used]
            for (demands, _), late in zip(every, rows, strict=True)
        ]
        thin = max(1, own.rows // 4)
        table = np.column_stack([v, damping, np.ones_like(v), own.acceleration[used], *asked])
        parts.append(table[::thin])
        count += len(parts[-1]) * thin / own.rows
    whole = np.vstack(parts) if parts else np.zeros((0, 4 + 2 * len(every)))
    rest, wanted = whole[:, :3], whole[:, 3:]
    left = wanted - rest @ np.linalg.lstsq(rest, wanted, rcond=None)[0]
    # What the velocities explain wholly leaves a rounding error only.
    left[:, np.linalg.norm(left, axis=0) < 3e-5 * np.linalg.norm(wanted, axis=0)] = 0.0
    return np.split(left, np.arange(1, left.shape[1], 2), axis=1), count


def _explained(target: Array, asked: Array) -> tuple[float, Array]:
    """Share of the variance of a column (N, 1) that others (N, 2) explain, with coefficients that are not
    negative (Lawson and Hanson 1974), and what they explain of it.
    """
    sizes = np.linalg.norm(asked, axis=0)
    whole = float(np.linalg.norm(target))
    if whole == 0.0 or not sizes.any():
        return 0.0, np.zeros_like(target)
    scaled = asked / np.where(sizes > 0.0, sizes, 1.0)
    numbers, left = nnls(scaled, target[:, 0] / whole)
    return min(1.0 - left**2, 1.0 - 1e-9), whole * (scaled @ numbers)[:, None]


def _latest(answers: Sequence[Answers], demands: Sequence[Pair]) -> tuple[float, float, float]:
    """The shift [s] of the commands with the greatest likelihood, its logarithm, and the share explained."""
    grid = max(answers[0].motion.step, 0.1)
    coarse = np.arange(-LONGEST_SHIFT, LONGEST_SHIFT + 0.5 * COARSE, max(COARSE, grid))
    first = _likeliest(answers, demands, coarse)
    return _likeliest(answers, demands, np.arange(first[0] - COARSE, first[0] + COARSE + 0.5 * grid, grid))


def _likeliest(
    answers: Sequence[Answers], demands: Sequence[Pair], shifts: Array
) -> tuple[float, float, float]:
    scores = [_score(answers, demands, float(shift)) for shift in shifts]
    best = max(range(len(scores)), key=lambda i: scores[i][0])
    return float(shifts[best]), *scores[best]


def _latency(
    answers: Sequence[Answers],
    demands: Sequence[Pair],
    latest: tuple[float, float, float],
    places: list[Place],
    known: bool,
) -> list[Finding]:
    """The likeliest shift, where it is significant and not small."""
    shift, score, explained = latest
    shortest = max(SHORTEST_LATENCY, SHORTEST_STEPS * answers[0].motion.step)
    if abs(shift) < shortest or explained < EXPLAINED:
        return []
    nearest = math.copysign(shortest - 1e-6, shift)
    gain = score - max(_score(answers, demands, at)[0] for at in (0.0, 0.5 * nearest, nearest))
    if min(gain, _gain(answers, (demands, shift), (demands, 0.0))) < LIKELIER:
        return []
    names = tuple(place.level for place in places)
    figures = {"latency_s": shift, "log_likelihood_gain": gain}
    if shift > 0.0:
        after = "beyond the lags in the boat file" if known else "with the actuators' lags"
        message = f"the motion follows the commands after {shift:.1f} s {after}"
        advice = "check the clocks of the tables (--clock) and the delay of the radio link"
    else:
        message = f"the motion precedes the commands by {-shift:.1f} s"
        advice = f"the clocks differ: import with --clock A~B or --commands-earlier {-shift:.1f}"
    return [Finding("fault", "latency", names, message, advice, figures=figures)]

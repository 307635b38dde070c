"""Whether the numbers of one run make sense: finite, in range, in radians, at the dataset's fixed rate."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat.plausible import implausible_sizes
from swamp_rl.clipped import clipped
from swamp_rl.names import LONGEST
from swamp_rl.runs.columns import ENDLESS, ONE_TURN, Span, UnknownThrusterError, missing_columns, span_of
from swamp_rl.runs.faults import NO_NUMBER, Fault, faults_at
from swamp_rl.runs.schema import LEAST_RATE, META, MOST_RATE, DatasetMeta
from swamp_rl.runs.table import Table

STEP_TOLERANCE = 0.05  # of the period, for one step: room for times rounded to a few digits
DRIFT_TOLERANCE = 0.5  # of the period, over the whole run
DEGREES = 180.0 / math.pi
FASTEST_TURN = 1.5  # rad/s that a boat keeps up; in degrees a second hardly more than a drift
FASTEST_COMMAND = 2.0 * math.pi  # rad/s of the azimuth of a thruster without limits, in most rows
TURN = 2.0 * math.pi + 1e-6  # rad
LARGEST_RUDDER = 0.5 * math.pi  # rad: no rudder turns further
MOST_REPEATED = 0.5
"""Of the steps of time: where more are 0, the clock is coarser than the rows."""
BARELY_BEYOND = 1.1
"""Greatest command [1] whose zero or full value is taken for a little off."""
LEAST_PERCENT = 20.0
"""Percent that the commands of a boat under way reach."""
REPEATS = "repeats"
WRAP = "wrap it into that range"
MISSING = "is missing; add it"
NOT_FINITE = "is not a finite number"
FORMULA = "=+-@"
"What a spreadsheet takes for the beginning of a formula, in a header too, when it opens a run as CSV."
ODD_NAME = (
    f"is not a column name: it is not blank, has at most {LONGEST} bytes, all print and the first is none "
    f"of {FORMULA}; rename it, or leave it out"
)


def check_load(meta: DatasetMeta, boat: Boat) -> list[Fault]:
    """A fault of `dataset.yaml` for mass, draught and density of water that its boat cannot have."""
    load = {"mass": meta.mass, "draught": meta.draught, "water_density": meta.water_density}
    faults = implausible_sizes(boat.model_copy(update=load))
    return [Fault(META, None, None, f"{key}: {complaint}") for key, complaint in faults]


@np.errstate(over="ignore", invalid="ignore")  # differences of numbers near the end of their range
def check_table(file: str, table: Table, boat: Boat | None, sample_rate: float | None) -> list[Fault]:
    """Every fault of one run's table; without a `sample_rate` the run's own mean rate must be fixed."""
    faults = list(table.faults)
    if not table.columns:
        return faults
    faults += [
        Fault(file, None, clipped(name).strip() or "''", ODD_NAME) for name in table.columns if _is_odd(name)
    ]
    faults += [
        Fault(file, None, name, f"{MISSING}{_near_miss(name, list(table.columns))}")
        for name in missing_columns(list(table.columns), boat)
    ]
    for name in table.columns:
        faults += check_column(file, name, table, boat)
    if len(table.rows) < 2:
        rows = "1 row" if len(table.rows) == 1 else "no rows"
        faults.append(
            Fault(file, None, None, f"holds {rows}, a run needs two or more; record it again or remove it")
        )
    elif repeated := repeated_times(table.columns.get("time", np.zeros(0))):
        faults.append(Fault(file, None, "time", f"{REPEATS}: {repeated}; give each row its own"))
    elif table.whole and "time" in table.columns and np.isfinite(table.columns["time"]).all():
        time = table.columns["time"]
        late = _check_order(file, table) or _check_apart(file, time)
        late = late or _check_rate(file, time, table.rows, sample_rate)
        faults += late or _check_degrees_against_yaw_rate(file, table.columns)
    return faults


def check_column(file: str, name: str, table: Table, boat: Boat | None) -> list[Fault]:
    """Every fault of a column of the table: that it names no thruster of the boat, values out of range."""
    faults, span = [], None
    try:
        span = span_of(name, boat)
    except UnknownThrusterError as error:
        faults.append(Fault(file, None, name, str(error)))
    return faults + _check_values(file, name, table, span or Span("?"))


def _is_odd(name: str) -> bool:
    size = len(name.encode("utf-8", "surrogatepass"))
    begins = name.lstrip()[:1]
    return not begins or size > LONGEST or not name.isprintable() or begins in FORMULA


def unknown_columns(names: list[str], boat: Boat | None) -> list[str]:
    """The columns the format does not know: kept, and to be reported."""
    found = []
    for name in names:
        try:
            if span_of(name, boat) is None:
                found.append(name)
        except UnknownThrusterError:
            continue
    return found


def _near_miss(name: str, names: list[str]) -> str:
    alike = [other for other in names if other != name and other.strip().lower() == name]
    return f" (column {alike[0]!r} must be named {name!r})" if alike else ""


def _check_values(file: str, name: str, table: Table, span: Span) -> list[Fault]:
    values = table.columns[name]
    if span == ENDLESS and not command_counts_turns(values, table.columns.get("time")):
        span = ONE_TURN
    if len(values) and np.isnan(values).all() and not table.unread.get(name, np.zeros(1, bool)).any():
        return [Fault(file, None, name, NO_NUMBER)]
    infinite = ~np.isfinite(values) & ~table.unread.get(name, np.zeros(len(values), bool))
    faults = faults_at(
        file,
        name,
        table.rows,
        infinite,
        lambda i: f"{values[i]} {NOT_FINITE}; correct it or cut the run here",
    )
    with np.errstate(invalid="ignore"):
        outside = np.isfinite(values) & ((values < span.low) | (values > span.high))
    if span.above:
        outside |= values == span.low
    if not outside.any():
        return faults
    heading = name == "heading" and counts_turns(values, table.columns.get("time"))
    hint = WRAP if heading else _unit_mistake(values[np.isfinite(values)], span)
    return faults + faults_at(
        file, name, table.rows, outside, lambda i: f"{values[i]:.6g} is outside {span}; {hint}"
    )


def counts_turns(
    angle: NDArray[np.float64],
    time: NDArray[np.float64] | None,
    fastest: float = FASTEST_TURN,
    farthest: float = math.inf,
) -> bool:
    """Whether an angle (T,) [rad] may pass a full turn: it begins within one, and nearly always turns more
    slowly than `fastest` [rad/s], which its degrees would not.

    time: (T,) [s]; without it the rate is not judged. farthest: greatest step between rows [rad].
    """
    known = np.isfinite(angle) if time is None else np.isfinite(angle) & np.isfinite(time)
    turned = np.abs(np.diff(angle[known], prepend=0.0))
    if not len(turned) or turned[0] > TURN or turned.max() > farthest:
        return False
    if time is None:
        return True
    steps = np.diff(time[known])
    speed = turned[1:][steps > 0.0] / steps[steps > 0.0]
    return not len(speed) or bool(np.quantile(speed, 0.95) < fastest)


def command_counts_turns(azimuth: NDArray[np.float64], time: NDArray[np.float64] | None) -> bool:
    """`counts_turns` of the azimuth of a thruster without limits: every direction lies within a turn of where
    it points, and it mostly turns less than once a second.
    """
    return counts_turns(azimuth, time, FASTEST_COMMAND, TURN)


def _unit_mistake(values: NDArray[np.float64], span: Span) -> str:
    """What to do about a column that leaves its span, from how far it does."""
    largest = np.abs(values).max()
    if span.unit in ("1", "rad") and np.quantile(np.abs(values), 0.5) >= 800.0 and largest <= 2500.0:
        times = "" if span.unit == "1" else f" * {_greatest(span):.4g}"
        return f"it looks like a pulse width in us, map it to the range, as in (pwm - 1500) / 400{times}"
    if span.unit in ("rad", "rad/s") and largest > 2.0 * math.pi + 1e-6:
        return f"it looks like degrees, give it in {span.unit} (multiply by pi/180)"
    if span.unit == "rad" and span.above:
        return WRAP
    if span.unit == "1" and LEAST_PERCENT < largest <= 100.0:
        return "it looks like percent, divide by 100"
    if span.unit == "1" and 1.0 < largest <= BARELY_BEYOND:
        return "a little beyond its range, clip it, as in clip((pwm - 1510) / 400, -1, 1)"
    if span.unit == "1" and largest > 1.0:
        return (
            f"it reaches {largest:.4g}; divide it by its value at full throttle, such as the most revolutions"
        )
    if span.unit == "1" and span.low == 0.0 and values.min() < 0.0 and largest <= 1.0:
        return "if the thruster reverses, give it astern_linear and astern_quadratic in the boat file"
    if span.unit in ("m", "m/s"):
        return f"correct it, or give the column in {span.unit}"
    return "correct it, or the limits of the boat file"


def _greatest(span: Span) -> float:
    """The greatest size [rad] of an angle, half a turn of one without limits."""
    return span.high if span.high < math.pi else math.pi


def _check_order(file: str, table: Table) -> list[Fault]:
    """The faults of times that do not increase, with what to do about each."""
    time = table.columns["time"]
    steps = np.diff(time)
    if (steps > 0.0).all():
        return []
    cells = np.stack(list(table.columns.values()))
    before, after = cells[:, :-1], cells[:, 1:]
    same = np.all((before == after) | (np.isnan(before) & np.isnan(after)), axis=0)
    found = []
    for wrong, remedy in (
        (steps < 0.0, "put the rows in order of time"),
        ((steps == 0.0) & same, "the row is there twice, leave one out"),
        ((steps == 0.0) & ~same, "give each row its own time"),
    ):

        def message(i: int, remedy: str = remedy) -> str:
            return f"{time[i + 1]:.6g} s does not come after {time[i]:.6g} s; {remedy}"

        found += faults_at(file, "time", table.rows[1:], wrong, message)
    return found


def _check_apart(file: str, time: NDArray[np.float64]) -> list[Fault]:
    """The fault of increasing times so close to each other, or so far apart, that they have no rate."""
    step = float(np.median(np.diff(time)))
    if 1.0 / MOST_RATE <= step <= 1.0 / LEAST_RATE:
        return []
    return [Fault(file, None, "time", f"rows are {step:.3g} s apart; give the times in s")]


def _check_rate(
    file: str, time: NDArray[np.float64], rows: NDArray[np.int64], sample_rate: float | None
) -> list[Fault]:
    """The faults of increasing times that are not at the sample rate, or at no fixed one."""
    steps = np.diff(time)
    period = 1.0 / sample_rate if sample_rate else typical_step([time])
    named = f"{1.0 / period:.6g} Hz" + (" of dataset.yaml" if sample_rate else "")
    uneven = np.abs(steps - period) > STEP_TOLERANCE * period
    typical = float(np.median(steps))
    drift = abs(time[-1] - time[0] - period * len(steps))
    wrong_rate = abs(typical - period) > STEP_TOLERANCE * period
    if wrong_rate or (not uneven.any() and drift > DRIFT_TOLERANCE * period):
        rate = 1.0 / typical if wrong_rate else len(steps) / (time[-1] - time[0])
        message = f"is sampled at {rate:.6g} Hz, not the {named}; correct sample_rate, or resample the run"
        return [Fault(file, None, "time", message)]
    return faults_at(
        file,
        "time",
        rows[1:],
        uneven,
        lambda i: (
            f"{steps[i]:.6g} s after the row before, not the {period:.6g} s of {named}; resample the run"
        ),
    )


def repeated_times(time: NDArray[np.float64]) -> str:
    """How many rows have each time, of rows that mostly have the time of the row before, or how many times
    there are where these are rounded ever more; nothing of others."""
    steps = np.diff(time[np.isfinite(time)])
    later = np.flatnonzero(steps > 0.0)
    if not len(later) or np.mean(steps == 0.0) <= MOST_REPEATED:
        return ""
    counts, step = np.diff(later, prepend=-1), float(np.median(steps[later]))
    count = float(np.median(counts))
    if counts[counts > 2.0 * count].sum() > MOST_REPEATED * len(steps):
        rate = len(steps) / float(steps[later].sum())
        return (
            f"{len(steps) + 1} rows have {len(later) + 1} times, as if rounded, at {rate:.4g} Hz on the whole"
        )
    return f"{count:g} rows have each time, {step:.3g} s apart, as at {count / step:.4g} Hz"


def typical_step(times: Sequence[NDArray[np.float64]]) -> float:
    """The step between rows [s], of the times of one or more runs: the median, or the mean where a run at the
    median would end half a step away and all steps are like the mean, as of 30 Hz in whole milliseconds.
    """
    steps = np.concatenate([np.diff(time) for time in times])
    median, mean = float(np.median(steps)), float(np.mean(steps))
    drift = max(abs(time[-1] - time[0] - median * (len(time) - 1)) for time in times)
    alike = bool(np.all(np.abs(steps - mean) <= STEP_TOLERANCE * mean))
    return mean if alike and drift > DRIFT_TOLERANCE * median else median


def _check_degrees_against_yaw_rate(file: str, columns: dict[str, NDArray[np.float64]]) -> list[Fault]:
    """Small angles in degrees stay inside the radians' range, but the two columns then disagree by 180/pi."""
    if not {"heading", "yaw_rate"} <= set(columns) or len(columns["time"]) < 10:
        return []
    heading, yaw_rate = columns["heading"], columns["yaw_rate"]
    if not (np.isfinite(heading).all() and np.isfinite(yaw_rate).all()):
        return []
    turned = np.diff(np.unwrap(heading)) / np.diff(columns["time"])
    given = 0.5 * (yaw_rate[1:] + yaw_rate[:-1])
    size = float(np.linalg.norm(turned)), float(np.linalg.norm(given))
    if min(size) == 0.0 or turned @ given < 0.9 * size[0] * size[1]:
        return []
    ratio = size[1] / size[0]
    for name, mistaken, unit, evidence in (
        ("yaw_rate", ratio, "rad/s", "it is {:.3g} times the slope of heading"),
        ("heading", 1.0 / ratio, "rad", "its slope is {:.3g} times yaw_rate"),
    ):
        if abs(mistaken / DEGREES - 1.0) < 0.25:
            message = f"looks like degrees: {evidence.format(mistaken)}; give it in {unit}"
            return [Fault(file, None, name, message)]
    return []

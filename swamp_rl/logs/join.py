"""Series with times of their own on one even grid of times."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.runs.faults import Fault
from swamp_rl.runs.resample import at_times, is_held, most_rows

Array = NDArray[np.float64]

POSITIONS = "north", "x", "latitude"
LEAST_REGULAR = 0.1
"""Length of the stamps' mean direction, below which no phase is theirs."""
NEAR = 1e-3
"""Steps that a phase is kept at 0 within."""
GAP_STEPS = 5.0
"""Median steps of a table: after a longer pause its values are not interpolated."""


@dataclass(frozen=True)
class Series:
    """Values (T,) of one column at their times (T,) [s], and the table that has them."""

    table: str
    time: Array
    values: Array


@dataclass(frozen=True)
class Joined:
    """`columns` (N,) with `time`, NaN and `unread` where a table pauses, the faults that say so, and what was
    done."""

    columns: dict[str, Array]
    unread: dict[str, NDArray[np.bool_]]
    faults: list[Fault]
    told: str


def joined(file: str, series: Mapping[str, Series], rate: float, fill: float) -> Joined:
    """All series at `rate` [Hz] over the time that all of them cover; linear, angles the short way round,
    commands held.

    Where the messages of a table pause for more than GAP_STEPS median steps and `fill` [s], its columns are
    missing; commands, which may be sent at a change only, are held. UserError where nothing is in common.
    """
    series = {name: _whole(file, name, one) for name, one in series.items()}
    start = max(float(one.time[0]) for one in series.values())
    ends = [float(one.time[-1]) for name, one in series.items() if not is_held(name)]
    if not ends:
        raise UserError(f"{file}: the mapping has commands alone; map north and east, and heading")
    end, start = min(ends), start + _phase(series, start, rate)
    rows = (end - start) * rate + 1.0 + 1e-9
    if rows < 2.0:
        spans = "; ".join(_spans(series))
        raise UserError(f"{file}: the tables have no time in common ({spans}); map other tables, or --clock")
    given = max(len(one.time) for one in series.values())
    most = most_rows(len(series) + 1, given)
    if not rows < most:
        told = f"{rows:.3g} rows at {rate:g} a second from {given} messages, at most {most}"
        raise UserError(f"{file}: {told}; give --resample HZ, or divide the log where its times jump")
    even = start + np.arange(math.floor(rows)) / rate
    columns: dict[str, Array] = {"time": even - start}
    unread: dict[str, NDArray[np.bool_]] = {}
    faults: list[Fault] = []
    for name, one in series.items():
        columns[name] = at_times("heading" if name == "yaw" else name, one.time, one.values, even)
        if is_held(name):
            continue
        missing, found = _pauses(file, name, one, even, max(fill, 1.0 / rate))
        if missing.any():
            unread[name], columns[name] = missing, np.where(missing, np.nan, columns[name])
            faults += found
    return Joined(columns, unread, faults, _told(series, rate))


def _phase(series: Mapping[str, Series], start: float, rate: float) -> float:
    """Seconds [0, 1/rate) from `start` to rows that lie next to the stamps of the positions.

    Linear interpolation halfway between two stamps averages them: the noise would lose what is near the
    Nyquist frequency. The phase is the mean direction of the stamps on the circle of one step.
    """
    place = next((series[name] for name in POSITIONS if name in series), next(iter(series.values())))
    turns = (place.time - start) * rate
    mean = np.exp(2j * np.pi * turns).mean()
    phase = float(np.angle(mean)) / (2.0 * np.pi) if abs(mean) > LEAST_REGULAR else 0.0
    return 0.0 if abs(phase) < NEAR else (phase % 1.0) / rate


def _whole(file: str, name: str, one: Series) -> Series:
    """The finite values at increasing times: of messages with one stamp the last."""
    known = np.isfinite(one.values) & np.isfinite(one.time)
    time, values = one.time[known], one.values[known]
    order = np.argsort(time, kind="stable")
    time, values = time[order], values[order]
    last = np.append(np.diff(time) > 0.0, True)[: len(time)]
    if last.sum() < 2:
        raise UserError(f"{file}: {one.table} has fewer than two values of {name}; map another field")
    return Series(one.table, time[last], values[last])


def _pauses(
    file: str, name: str, one: Series, even: Array, shortest: float
) -> tuple[NDArray[np.bool_], list[Fault]]:
    steps = np.diff(one.time)
    long = np.flatnonzero(steps > max(GAP_STEPS * float(np.median(steps)), shortest))
    missing = np.zeros(len(even), bool)
    faults = []
    for i in long.tolist():
        first, last = np.searchsorted(even, [one.time[i] + 1e-9, one.time[i + 1] - 1e-9])
        missing[first:last] = True
        if last > first:
            told = (
                f"{one.table} has no value for {steps[i]:.3g} s; --fill SECONDS interpolates, --bad-rows cuts"
            )
            faults.append(Fault(file, int(first) + 1, name, told, int(last)))
    return missing, faults


def _tables(series: Mapping[str, Series]) -> dict[str, Series]:
    return {one.table: one for one in series.values()}


def _spans(series: Mapping[str, Series]) -> Sequence[str]:
    return [f"{name} {one.time[0]:.3f} to {one.time[-1]:.3f} s" for name, one in _tables(series).items()]


def _told(series: Mapping[str, Series], rate: float) -> str:
    rates = [
        f"{name} {1.0 / float(np.median(np.diff(one.time))):.3g} Hz" for name, one in _tables(series).items()
    ]
    return f"{', '.join(rates)}; at {rate:g} Hz, linear between messages, commands held"

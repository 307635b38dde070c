"""False alarms in clean driving, and faults by name and delay, of `swamp-rl watch`.

    python -m benchmarks.monitor --hours 100 --faults 200 --first 1000

Writes the tables of docs/watch.md; that of which nothing is asked (0) stays as it is. `--minutes` ends each
part after so long: its table then has fewer cases.
"""

import argparse
import itertools
import math
import os
import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TypeVar

import numpy as np
from scipy.stats import chi2
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from benchmarks.monitor.sail import BOAT, Fault, stream
from swamp_rl.link import Sample
from swamp_rl.monitor import Monitor, Notice

Result = TypeVar("Result")

HALF_HOUR = 1800.0
BEGIN = 60.0  # s at which a fault begins, and up to 20 s later
HEARD = 20.0  # s after it for which the monitor is heard
KINDS = ("thruster_failure", "current", "gyro_bias", "heading_bias", "frozen")
SEAS = {"calm": False, "wind": True}
ALARM_HEAD = ["sea", "hours", "false alarms", "95 % upper limit, in 100 h"]
FAULT_HEAD = [
    "fault",
    "sea",
    "cases",
    "detected within 20 s",
    "median delay, s",
    "90 % quantile, s",
    "identified",
    "identified or an alternative",
]


def heard(samples: Iterable[Sample]) -> Iterator[Notice]:
    """What a new monitor says of a stream."""
    monitor = Monitor(BOAT)
    for sample in samples:
        yield from monitor.feed(sample)


def clean(seed: int, rough: bool) -> list[Notice]:
    """Half an hour in which nothing begins."""
    return list(heard(stream(seed, HALF_HOUR, rough)))


def drawn(seed: int) -> Fault:
    """A fault from its seed: each kind in turn, of a random size and thruster."""
    rng = np.random.default_rng([7, seed])
    time, kind = BEGIN + rng.uniform(0.0, 20.0), KINDS[seed % len(KINDS)]
    sign = rng.choice([-1.0, 1.0])
    if kind == "thruster_failure":
        name = str(rng.choice(BOAT.thruster_names))
        return Fault(f"{kind} {name}", time, {"effect": kind, "thruster": name, "time": 0.0})
    if kind == "current":
        angle, speed = rng.uniform(-np.pi, np.pi), rng.uniform(0.2, 0.5)
        north, east = float(speed * np.cos(angle)), float(speed * np.sin(angle))
        return Fault(kind, time, {"effect": kind, "north": north, "east": east}, ramp=2.0)
    if kind == "gyro_bias":
        return Fault(kind, time, {"effect": kind, "bias": float(sign * rng.uniform(0.02, 0.1))})
    if kind == "heading_bias":
        return Fault(kind, time, {"effect": kind, "bias": float(sign * rng.uniform(0.05, 0.5))})
    name, channels = [("position", (0, 1)), ("heading", (2,)), ("velocity", (3, 4)), ("yaw_rate", (5,))][
        int(rng.integers(4))
    ]
    return Fault(f"{name} frozen", time, frozen=channels)


def upper_limit(alarms: int, hours: float) -> float:
    """The rate [1/h] below which the true one lies with 95 % confidence, after so many alarms (Poisson)."""
    return float(chi2.ppf(0.95, 2 * (alarms + 1))) / (2.0 * hours)


def faulty(seed: int, rough: bool) -> tuple[str, float, str]:
    """Kind of a fault, delay of the first notice after it [s], and whether that is `right`, has the truth
    `among` its rivals, or what it says.
    """
    fault = drawn(seed)
    notices = heard(stream(10_000 + seed, fault.time + HEARD, rough, fault))
    first = next((notice for notice in notices if notice.time >= fault.time), None)
    kind = "frozen" if fault.frozen else fault.name.split()[0]
    if first is None:
        return kind, np.inf, ""
    if first.cause == fault.name or _failed(first, fault):
        return kind, first.time - fault.time, "right"
    return kind, first.time - fault.time, "among" if fault.name in first.rivals else first.cause


def _failed(notice: Notice, fault: Fault) -> bool:
    """Whether a loss of most of the thrust is what it says of a thruster that has failed."""
    return notice.cause == fault.name.replace("failure", "gain") and notice.values.get("gain", 1.0) < 0.35


def rows_of(results: Sequence[tuple[str, float, str]], rough: Sequence[bool]) -> list[list[str]]:
    """A row for each kind of fault in each sea, and one for all in each and in both."""
    rows = []
    for kind in (*KINDS, "all"):
        for sea in (*SEAS, "both") if kind == "all" else SEAS:
            mine = [
                one
                for one, own in zip(results, rough, strict=True)
                if kind in (one[0], "all") and SEAS.get(sea, own) == own
            ]
            if mine:
                rows.append([kind, sea, *figures(mine)])
    return rows


def figures(results: Sequence[tuple[str, float, str]]) -> list[str]:
    """How many, how many of them were heard and how soon, and how many named."""
    delays = np.array([one[1] for one in results])
    named = sum(one[2] == "right" for one in results)
    among = named + sum(one[2] == "among" for one in results)
    late = np.quantile(delays, 0.9, method="lower")
    return [
        str(len(results)),
        f"{np.isfinite(delays).mean():.3f}",
        f"{np.median(delays):.1f}",
        f"{late:.1f}",
        f"{named / len(results):.3f}",
        f"{among / len(results):.3f}",
    ]


def alarm_rows(counted: Iterable[list[Notice]]) -> list[list[str]]:
    """A row for each sea, of half hours without a fault in one sea after the other, and one for both."""
    counts, halves = dict.fromkeys(SEAS, 0), dict.fromkeys(SEAS, 0)
    for sea, notices in zip(itertools.cycle(SEAS), counted):
        halves[sea] += 1
        counts[sea] += len(notices)
        print(f"{sea}: {halves[sea] / 2:g} h", *(notice.text for notice in notices), flush=True)
    counts["both"], halves["both"] = sum(counts.values()), sum(halves.values())
    return [
        [sea, f"{halves[sea] / 2:g}", str(count), f"{100.0 * upper_limit(count, halves[sea] / 2):.1f}"]
        for sea, count in counts.items()
        if halves[sea]
    ]


def fault_rows(numbers: Sequence[int], counted: Iterable[tuple[str, float, str]]) -> list[list[str]]:
    """The rows of faults, every second five of them in wind."""
    results = []
    for seed, one in zip(numbers, counted, strict=False):
        print(seed, drawn(seed).name, *one[1:], flush=True)
        results.append(one)
    return rows_of(results, [rough_of(seed) for seed in numbers[: len(results)]])


def rough_of(seed: int) -> bool:
    """Whether the fault of that seed begins in wind."""
    return bool(seed // len(KINDS) % 2)


def main() -> None:
    """Count, and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--hours", type=float, default=100.0)
    parser.add_argument("--faults", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="number of the first half hour and fault")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument(
        "--minutes", type=float, default=math.inf, help="for each table, then what is counted"
    )
    parser.add_argument("--into", default=str(DOCS / "watch.md"))
    given = parser.parse_args()
    parts = {}
    with ProcessPoolExecutor(given.workers) as pool:
        mapped = pool.map if given.workers > 1 else map
        if (halves := round(2.0 * given.hours)) > 0:
            seeds, rough = [given.first + n // 2 for n in range(halves)], [bool(n % 2) for n in range(halves)]
            counted = within(given.minutes, mapped(clean, seeds, rough))
            parts["false alarms"] = table(ALARM_HEAD, alarm_rows(counted))
        if given.faults > 0:
            numbers = range(given.first, given.first + given.faults)
            counted = within(given.minutes, mapped(faulty, numbers, map(rough_of, numbers)))
            parts["faults"] = table(FAULT_HEAD, fault_rows(numbers, counted))
        write_parts(Path(given.into), parts)


def within(minutes: float, results: Iterable[Result]) -> Iterator[Result]:
    """The results that come in that time, and the first after it."""
    end = time.monotonic() + 60.0 * minutes
    for one in results:
        yield one
        if time.monotonic() > end:
            return


if __name__ == "__main__":
    main()

"""False alarms in clean driving, and faults by name and delay, of `swamp-rl watch`.

    python -m benchmarks.monitor --hours 100 --faults 200

Writes the tables of docs/watch.md.
"""

import argparse
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from benchmarks.monitor.sail import BOAT, Fault, stream
from swamp_rl.monitor import Monitor, Notice

HALF_HOUR = 1800.0
BEGIN = 60.0  # s at which a fault begins, and up to 20 s later
HEARD = 20.0  # s after it for which the monitor is heard
KINDS = ("thruster_failure", "current", "gyro_bias", "heading_bias", "frozen")
LATEST = 3.0  # s, the bar


def heard(samples: partial) -> list[Notice]:  # type: ignore[type-arg]
    """What a new monitor says of a stream."""
    monitor = Monitor(BOAT)
    return [notice for sample in samples() for notice in monitor.feed(sample)]


def clean(seed: int, rough: bool) -> list[Notice]:
    """Half an hour in which nothing begins."""
    return heard(partial(stream, seed, HALF_HOUR, rough))


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


def faulty(seed: int, rough: bool) -> tuple[str, float, str]:
    """Kind of a fault, delay of the first notice after it [s], and whether that is `right`, has the truth
    `among` its rivals, or what it says.
    """
    fault = drawn(seed)
    notices = heard(partial(stream, 10_000 + seed, fault.time + HEARD, rough, fault))
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


def rows_of(results: Sequence[tuple[str, float, str]]) -> list[list[str]]:
    """A row for each kind of fault, and one for all."""
    rows = []
    for kind in (*KINDS, "all"):
        mine = [one for one in results if kind in (one[0], "all")]
        delays = np.array([one[1] for one in mine])
        named = sum(one[2] == "right" for one in mine)
        among = named + sum(one[2] == "among" for one in mine)
        late = np.quantile(delays, 0.9, method="lower")
        rows.append(
            [
                kind,
                str(len(mine)),
                f"{np.isfinite(delays).mean():.3f}",
                f"{np.median(delays):.1f}",
                f"{late:.1f}",
                f"{named / len(mine):.3f}",
                f"{among / len(mine):.3f}",
            ]
        )
    return rows


def main() -> None:
    """Count, and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--hours", type=float, default=100.0)
    parser.add_argument("--faults", type=int, default=200)
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--into", default=str(DOCS / "watch.md"))
    given = parser.parse_args()
    halves = round(given.hours)  # of an hour, for each sea
    with ProcessPoolExecutor(given.workers) as pool:
        alarms = {}
        for sea, rough in (("calm, steady current", False), ("wind with gusts", True)):
            heard_of = list(pool.map(clean, range(halves), [rough] * halves))
            alarms[sea] = [notice.text for notices in heard_of for notice in notices]
            print(sea, alarms[sea], flush=True)
        results = list(
            pool.map(faulty, range(given.faults), [bool(seed // 5 % 2) for seed in range(given.faults)])
        )
    for seed, one in enumerate(results):
        if one[2] != "right":
            print(seed, drawn(seed), one)
    clean_rows = [[sea, f"{halves / 2:g}", str(len(said))] for sea, said in alarms.items()]
    heads = [
        "what begins",
        "cases",
        "heard within 20 s",
        "median s",
        "90 % s",
        "named first",
        "or among its rivals",
    ]
    write_parts(
        Path(given.into),
        {
            "false alarms": table(["sea", "hours", "false alarms"], clean_rows),
            "faults": table(heads, rows_of(results)),
        },
    )


if __name__ == "__main__":
    main()

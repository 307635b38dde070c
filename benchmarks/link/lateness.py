"""How punctual a helm's commands are in real time, over loopback: the table of docs/link.md.

    python -m benchmarks.link.lateness [SECONDS OF EACH ROW, 10 by default]

A virtual vehicle runs in a process of its own. Real-time scheduling needs root. The bar, 2 ms at the
99th percentile, is for an idle machine; the load is reported. Six rows: a minute by default.
"""

import math
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from swamp_rl.envs.aboard import Aboard
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.link.addresses import addresses
from swamp_rl.link.helm import Voyage, helm
from swamp_rl.link.priority import schedule_in_real_time
from swamp_rl.link.socket_link import socket_link
from swamp_rl.link.voyage_log import lateness_figures
from swamp_rl.pilots.arguments import asked_pilot, opened

ADDRESS = "127.0.0.1:29680"
PILOTS = ("line-of-sight", "reservoir", "cloning")
HEAD = ["pilot", "scheduling", "commands", "mean, ms", "99 %, ms", "max, ms", "missed", "stale", "load"]


class Endless(Aboard):
    """A pilot that goes on when its course has ended."""

    outcome = None  # type: ignore[assignment]


@contextmanager
def vehicle() -> Iterator[None]:
    """A virtual vehicle in a process of its own."""
    words = [sys.executable, "-m", "swamp_rl", "vehicle", "swamp", "--address", ADDRESS]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        process.stdout.readline()  # it answers from now on
        try:
            yield
        finally:
            process.terminate()


def driven(pilot: str, seconds: float) -> Voyage:
    """The voyage of a pilot for so long."""
    bridge = Endless(opened(asked_pilot(pilot)), boat="swamp", course="camogli")
    bridge.decide(0.0, np.zeros(6))
    bridge.begin()
    with vehicle(), socket_link(addresses(ADDRESS, len(bridge.boat.thrusters))) as link:
        return helm(link, bridge, len(bridge.boat.thrusters), time.monotonic, seconds)


def row(pilot: str, scheduling: str, seconds: float) -> list[str]:
    """A row of the table."""
    voyage = driven(pilot, seconds)
    late = [f"{1e3 * value:.2f}" for value in lateness_figures(voyage).values()]
    counts = [len(voyage.lateness), voyage.missed, voyage.silent]
    return [pilot, scheduling, str(counts[0]), *late, *map(str, counts[1:]), f"{os.getloadavg()[0]:.1f}"]


def main() -> None:
    """Measure and write the table."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    if not math.isfinite(seconds) or seconds <= 0.0:
        raise SystemExit(__doc__)
    rows = [row(pilot, "ordinary", seconds) for pilot in PILOTS]
    schedule_in_real_time()
    rows += [row(pilot, "real-time", seconds) for pilot in PILOTS]
    cores = f"{os.cpu_count()} processor cores; load: runnable processes, mean of the last minute.\n"
    write_parts(DOCS / "link.md", {"lateness": f"{table(HEAD, rows)}\n\n{cores}"})


if __name__ == "__main__":
    main()

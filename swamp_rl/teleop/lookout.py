"""The watch beside a run: a monitor in a thread of its own, for which the clock never waits."""

import queue
import threading
from collections import deque
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.link.stream import Sample
from swamp_rl.monitor import Monitor
from swamp_rl.monitor.options import DEFAULT

Array = NDArray[np.float64]

WAITING = 300
"""Samples that may wait for the monitor; further ones are left out, as on a network."""
LINES = 64
"""Lines that are kept until they are fetched."""
WARM_UP = 15.0
"""Seconds of driving in which the monitor learns; a run has some 30."""
LEAST_WALK = 0.05
"""Of the monitor's process noise: another run may be in other weather than the one in which it learns."""
OPTIONS = replace(DEFAULT, warm_up=WARM_UP, least_walk=LEAST_WALK)
LEARNS, WATCHES = "learns the noise of the sensors", "watching"


class Lookout:
    """Takes the samples of one run after another and says what a `Monitor` of the boat says of them.

    What it has learned of a boat's sensors in one run it knows in the next.
    """

    def __init__(self, noise: Array | None = None) -> None:
        """noise: (6,) standard deviations of the sensors that the monitor gets; none by default."""
        self._noise, self._rng = noise, np.random.default_rng(0)
        self._orders: queue.Queue[Boat | Sample | None] = queue.Queue(WAITING)
        self._lines: deque[str] = deque(maxlen=LINES)
        self._monitors: dict[str, Monitor] = {}
        self._thread = threading.Thread(target=self._work, name="lookout", daemon=True)
        self._thread.start()

    def begin(self, boat: Boat) -> None:
        """A new run of a boat begins."""
        self._order(boat)

    def see(self, sample: Sample) -> None:
        """Take the run's next sample."""
        if self._noise is not None:
            noise = self._noise * self._rng.standard_normal(6)
            sample = replace(sample, senses=sample.senses + noise)
        self._order(sample)

    def messages(self) -> list[str]:
        """Messages since the last call: first of a run whether it watches already."""
        return [self._lines.popleft() for _ in range(len(self._lines))]

    @property
    def waiting(self) -> int:
        """Samples that wait for the monitor."""
        return self._orders.qsize()

    def close(self) -> None:
        """End the thread, after what it has been given; wait for it."""
        self._orders.put(None)
        self._thread.join()

    def _order(self, order: Boat | Sample) -> None:
        try:
            self._orders.put_nowait(order)
        except queue.Full:
            if isinstance(order, Sample):
                return
            with self._orders.mutex:  # what waits is of runs that are over
                self._orders.queue.clear()
            self._orders.put_nowait(order)

    def _work(self) -> None:
        monitor, watched = None, False
        while (order := self._orders.get()) is not None:
            try:
                if isinstance(order, Sample):
                    if monitor is None:
                        continue
                    notices = monitor.feed(order)
                    if monitor.watching and not watched:
                        self._lines.append(WATCHES)
                    watched = monitor.watching
                    self._lines.extend(notice.text for notice in notices)
                else:
                    if order.name not in self._monitors:
                        self._monitors[order.name] = Monitor(order, OPTIONS)
                    monitor = self._monitors[order.name]
                    monitor.begin_again()
                    watched = False
                    self._lines.append(LEARNS)
            except Exception as error:  # the boat sails on, whatever happens to its watch
                self._lines.append(f"stopped: {error}")
                monitor = None

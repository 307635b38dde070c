"""A monitor of a live stream: what began, when, and how large, in the terms of the effect library."""

import math
from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.data.measurement_noise import noise_floor
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.effects import LIBRARY
from swamp_rl.link.stream import Sample
from swamp_rl.monitor.change_test import ChangeTest
from swamp_rl.monitor.frozen import SENSORS, Repetition
from swamp_rl.monitor.isolation import Onset, free, isolate, nested, onset_candidates, simplest
from swamp_rl.monitor.options import DEFAULT, Options
from swamp_rl.monitor.rougher_sea import lead_over_sea
from swamp_rl.monitor.tracker import CURRENT, Tracker, tracker_of
from swamp_rl.simulator import parameters
from swamp_rl.simulator.sensors import CHANNELS

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Notice:
    """What a monitor says. time: when [s]; since: when it began [s]; cause: label of an effect, `SENSOR
    frozen`, `SENSOR back` or `unexplained`; values: the effect's parameters; rivals: labels of causes that
    are not distinguishable from it; channels: where the innovations changed.
    """

    time: float
    since: float
    cause: str
    values: dict[str, float]
    rivals: tuple[str, ...] = ()
    channels: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """In one line."""
        effect = LIBRARY.get(self.cause.partition(" ")[0])
        units = {one.name: one.unit for one in effect.parameters if one.unit != "1"} if effect else {}
        numbers = ", ".join(
            f"{name} {value:.3g} {units.get(name, '')}".strip() for name, value in self.values.items()
        )
        others = f"; or {', or '.join(self.rivals)}" if self.rivals else ""
        where = f" in {', '.join(self.channels)}" if self.cause == "unexplained" else ""
        cause = f"{self.cause} ({numbers})" if numbers else self.cause
        return f"{self.time:.1f} s: {cause}{where}, since {self.since:.1f} s{others}"


class Monitor:
    """Feed it samples; it says what began.

    boat: as the pilot believes it to be.
    """

    def __init__(self, boat: Boat, options: Options = DEFAULT) -> None:
        self.boat, self.options = boat, options
        self.record = parameters(boat)
        self.instances = onset_candidates(boat)
        self.first: list[Sample] = []
        self.repetition = Repetition(options)
        self.tracker: Tracker | None = None
        self.alarm: float | None = None
        self.settled = -np.inf
        "Time [s] before which the filter of a stream that has begun again is not judged."
        self.again = False
        self.asked = -np.inf
        self.last_named = "", -np.inf
        self.notices = 0

    @property
    def watching(self) -> bool:
        """Whether the first seconds are over, from which noise and usual innovations are estimated."""
        return self.tracker is not None and not self.again and self.tracker.last.time >= self.settled

    def begin_again(self) -> None:
        """Take the next sample as the first of another stream of the boat and its sensors, from the boat file
        again; what is known of the noise and of usual innovations is kept.
        """
        self.first, self.repetition = [], Repetition(self.options, usual=self.repetition.usual)
        self.again = self.tracker is not None

    def feed(self, sample: Sample) -> list[Notice]:
        """Take the next sample; notices that it gives rise to. One that is not later than the last is
        ignored.
        """
        if self.first and sample.time <= self.first[-1].time:
            return []
        if self.tracker is None:
            self._warm_up(sample)
            return []
        if self.again:
            self._restart(sample)
            return []
        if sample.time <= self.tracker.last.time:
            return []
        notices = self._frozen(sample)
        step = self.tracker.advance(sample, self.repetition.channels)
        self.samples.append(sample)
        if sample.time < self.settled:
            return []
        self.test.add(step.white, usual=self.alarm is None)
        changed = self.test.exceeded
        if self.alarm is None and changed.max() > 1.0:
            self.alarm = sample.time
        if self.alarm is not None and sample.time - self.asked >= self.options.again - 1e-9:
            self.asked = sample.time
            notices += self._named(sample.time, changed)
        self.notices += len(notices)
        return notices

    def _warm_up(self, sample: Sample) -> None:
        self.first.append(sample)
        self.repetition.learn(sample)
        if sample.time - self.first[0].time < self.options.warm_up:
            return
        dt = float(np.median(np.diff([one.time for one in self.first])))
        self.tracker, white = tracker_of(self.boat, self.record, self.first, dt, self.options)
        self.test = ChangeTest(dt, self.options)
        for one in white:
            self.test.add(one)
        self.samples: deque[Sample] = deque(
            self.first[-len(self.tracker.history) :], self.tracker.history.maxlen
        )
        self.noisy = self.tracker.sigmas > 1.01 * noise_floor(self.boat)
        self.first = self.first[-1:]

    def _restart(self, sample: Sample) -> None:
        assert self.tracker is not None
        old = self.tracker
        self.record = parameters(self.boat)
        self.tracker = Tracker(self.boat, self.record, old.sigmas, old.noise, sample, old.dt, self.options)
        self.samples.clear()
        self.test.clear()
        self.alarm, self.again = None, False
        self.asked = -np.inf
        self.last_named = "", -np.inf
        self.settled = sample.time + self.options.settled

    def _frozen(self, sample: Sample) -> list[Notice]:
        """Sensors that repeat a reading which noise or the boat's motion would have changed."""
        assert self.tracker is not None
        since = self.repetition.since
        if not self.repetition.take(sample):
            return []
        apart = np.abs(self.tracker.navigator.x[:6] - np.nan_to_num(sample.senses))
        moved = self.noisy | (apart > self.options.beyond_noise * self.tracker.sigmas)
        began, back = self.repetition.add(sample, moved)
        notices = [
            Notice(sample.time, float(since[SENSORS[name]].max()), f"{name} frozen", {}) for name in began
        ]
        return notices + [Notice(sample.time, sample.time, f"{name} back", {}) for name in back]

    def _named(self, now: float, changed: Array) -> list[Notice]:
        """The cause of a change, once it leads its rivals and leaves white innovations, or the time for that
        is over.
        """
        assert self.tracker is not None and self.alarm is not None
        of, history = self.options, self.tracker.history
        found = isolate(self.boat, self.record, history, self.instances, self.tracker.dt, of)
        usual = float(self.test.square[0].mean())
        first = simplest(found, of.rival * usual)
        behind = {
            other.instance.label: (first.criterion - other.criterion) / usual
            for other in found
            if other is not first and not nested(first, other)
        }
        tenable = first.left <= usual * (first.rows + of.tenable * math.sqrt(2.0 * first.rows))
        clear = min(behind.values(), default=of.clear) >= of.clear
        waited = now - self.alarm + 1e-9
        if waited < of.patience and not (waited > of.soonest and clear and tenable):
            return []
        self.alarm = None
        record, shift = self._with(first)
        lead = lead_over_sea(
            self.boat, self.tracker, list(self.samples), self.repetition.channels, first.place, record, shift
        )
        if lead - 2.0 * free(first.instance) < of.sea * usual:
            self.test.clear()
            return []
        channels = tuple(CHANNELS[place] for place in np.flatnonzero(changed > 1.0))
        if not self._adopt(first, record, shift):
            return [Notice(now, first.time, "unexplained", {}, channels=channels)]
        label = first.instance.label
        refined = label == self.last_named[0] and now - self.last_named[1] < of.refined
        self.last_named = label, now
        if refined:
            return []
        rivals = tuple(name for name, gap in behind.items() if gap < of.rival)
        values = {name: float(value) for name, value in first.instance.values(first.x).items()}
        return [Notice(now, first.time, label, values, rivals, channels)]

    def _with(self, onset: Onset) -> tuple[NDArray[Any], Array]:
        """The record (1,) with a cause, the current as before; and the change of current (2,) [m/s]."""
        record = Hypothesis((onset.instance,)).records(self.boat, onset.x[None], self.record)
        shift = np.array([float(record[name][0] - self.record[name][0]) for name in CURRENT])
        for name in CURRENT:
            record[name] = self.record[name]
        return record, shift

    def _adopt(self, onset: Onset, record: NDArray[Any], shift: Array) -> bool:
        """Go on with the cause in the model, from its onset; False, and the model as it was, where the
        innovations are as unusual with it.
        """
        assert self.tracker is not None
        before, history = self.record, list(self.tracker.history)
        samples = list(self.samples)[onset.place :]
        self.tracker.restart(history[onset.place], samples[0], record, shift)
        self.test.clear()
        for sample in samples[1:]:
            self.test.add(self.tracker.advance(sample, self.repetition.channels).white, usual=False)
        adequate = bool(self.test.exceeded.max() <= 1.0)
        self.record = record if adequate else before
        if not adequate:
            self.test.accept()
            self.tracker.set_record(before)
        self.samples = deque(samples, self.samples.maxlen)
        self.test.clear()
        return adequate

"""Sensors that repeat their last reading."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swamp_rl.link.stream import Sample
from swamp_rl.monitor.options import DEFAULT, Options

Array = NDArray[np.float64]

SENSORS = {"position": [0, 1], "heading": [2], "velocity": [3, 4], "yaw_rate": [5]}
"What one instrument measures: it freezes, and comes back, as one."


@dataclass
class Repetition:
    """For how long each channel has had the same value; usual: (6,) the longest of a working sensor [s]."""

    options: Options = DEFAULT
    since: Array = field(default_factory=lambda: np.full(6, np.nan))
    last: Array = field(default_factory=lambda: np.full(6, np.nan))
    usual: Array = field(default_factory=lambda: np.zeros(6))
    frozen: set[str] = field(default_factory=set)

    def learn(self, sample: Sample) -> None:
        """Take a sample of working sensors."""
        self.take(sample)
        self.usual = np.fmax(self.usual, np.nan_to_num(sample.time - self.since))

    def add(self, sample: Sample, moved: NDArray[np.bool_]) -> tuple[list[str], list[str]]:
        """Sensors that the sample taken last shows to have frozen, and those that are back. moved: (6,)
        whether a working one would have changed since.
        """
        of = self.options
        stuck = (sample.time - self.since >= np.maximum(of.repeats, of.repeats_usual * self.usual)) & moved
        began, back = [], []
        for name, channels in SENSORS.items():
            if name in self.frozen and (sample.time - self.since[channels] == 0.0).all():
                self.frozen.discard(name)
                back.append(name)
            elif name not in self.frozen and stuck[channels].all():
                self.frozen.add(name)
                began.append(name)
        return began, back

    @property
    def channels(self) -> list[int]:
        """Those of frozen sensors."""
        return [channel for name in self.frozen for channel in SENSORS[name]]

    def take(self, sample: Sample) -> bool:
        """Take the next sample; whether a channel repeats its reading, or did."""
        changed = np.isfinite(sample.senses) & (sample.senses != self.last)
        self.since = np.where(changed, sample.time, self.since)
        self.last = np.where(changed, sample.senses, self.last)
        return bool(self.frozen) or not changed.all()

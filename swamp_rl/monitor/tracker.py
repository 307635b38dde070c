"""The Kalman filter of a live stream, with the last seconds of its innovations and gains."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.data.measurement_noise import noise_levels
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.model.scales import state_scale
from swamp_rl.link.stream import Sample
from swamp_rl.navigation.filter import START, WITH_MODEL, Navigator
from swamp_rl.navigation.predict import STATES, BoatModel
from swamp_rl.navigation.sensors import Fix
from swamp_rl.simulator.sensors import true_motion
from swamp_rl.simulator.state import ACTUATORS, HEADING, TIME

Array = NDArray[np.float64]

KEPT = 6.0  # s of history
SETTLED = 5.0  # s after which the actuators no longer depend on where they stood at first
WALKS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)  # of `WITH_MODEL`, tried for the process noise
OUTLIER = 5.0  # standard deviations of an innovation that is left out,
AGAIN = 3  # unless it comes that many times in a row
CURRENT = ("current_north", "current_east")  # fields of the record that are states of the filter, 6 and 7


@dataclass(frozen=True)
class Step:
    """One step of the filter. time [s]; commands (2K,) from this time on; state (S,) and x, P after the
    reading; jacobian (8, 8) to this time; places (m,), gain (8, m), whitener (m, m) with unit covariance of
    whitener @ innovation; white: (6,) normalised innovations, NaN where nothing new was measured.
    """

    time: float
    commands: Array
    state: Array
    x: Array
    P: Array
    jacobian: Array
    places: list[int]
    gain: Array
    whitener: Array
    innovation: Array
    white: Array


class Tracker:
    """Filter of one boat's samples. record: (1,) parameters, effects included; sigmas: (6,) standard
    deviations of the measurement noise; walk: (8,) process noise.
    """

    def __init__(
        self, boat: Boat, record: NDArray[Any], sigmas: Array, walk: Array, first: Sample, dt: float
    ) -> None:
        self.model = BoatModel(boat)
        self.sigmas, self.walk, self.dt = sigmas, walk, dt
        self.set_record(record)
        x = np.zeros(STATES)
        x[:6] = np.nan_to_num(first.senses)
        self.navigator = Navigator(self.model, x, walk, np.diag((START * scale_of(boat)) ** 2))
        self.model.actuators[ACTUATORS:] = first.commands
        self.history: deque[Step] = deque(maxlen=max(4, round(KEPT / dt)))
        self.last = first
        self.refused = np.zeros(6, dtype=int)

    def set_record(self, record: NDArray[Any]) -> None:
        """Take another parameter record (1,)."""
        self.record = record
        self.model.params = np.repeat(record, STATES + 1)

    def advance(self, sample: Sample, blind: Sequence[int] = ()) -> Step:
        """Predict to a sample's time and take in what it newly measures, but for the channels `blind`."""
        self.model.actuators[TIME] = self.last.time
        jacobian = self.navigator.predict(self.last.commands, sample.time - self.last.time)
        measured = corrected(sample, self.record)
        fresh = np.isfinite(measured) & (sample.senses != self.last.senses) & np.isfinite(self.sigmas)
        fresh[list(blind)] = False
        apart = differences(measured - self.navigator.x[:6])
        deviation = np.sqrt(np.diag(self.navigator.P)[:6] + self.sigmas**2)
        out = fresh & (np.abs(apart) > OUTLIER * deviation)
        self.refused = np.where(out, self.refused + 1, 0)
        taken = fresh & (~out | (self.refused >= AGAIN))
        step = self._update([int(place) for place in np.flatnonzero(taken)], measured, jacobian, sample)
        step.white[fresh & ~taken] = np.sign(apart)[fresh & ~taken] * OUTLIER
        self.last = sample
        self.history.append(step)
        return step

    def restart(self, step: Step, sample: Sample, record: NDArray[Any], current: Array) -> None:
        """Go back to a step of the history and the sample it was of, with another record (1,); current: (2,)
        how much more of it [m/s] there is from then on, as uncertain as that.
        """
        self.set_record(record)
        self.navigator.x, self.navigator.P = step.x.copy(), step.P.copy()
        self.navigator.x[6:] += current
        self.navigator.P[[6, 7], [6, 7]] += current**2
        self.model.actuators = step.state.copy()
        self.last = sample
        self.refused[:] = 0
        self.history.clear()
        self.history.append(step)

    def _update(self, places: list[int], measured: Array, jacobian: Array, sample: Sample) -> Step:
        white, empty = np.full(6, np.nan), np.zeros((0, 0))
        gain, whitener, innovation = np.zeros((STATES, 0)), empty, np.zeros(0)
        if places:
            values = measured[places]
            taken = self.navigator.update(Fix(tuple(places), values, self.sigmas[places]))
            whitener = np.linalg.inv(np.linalg.cholesky(taken.covariance))
            gain, innovation = taken.gain, taken.value
            white[places] = innovation / np.sqrt(np.diag(taken.covariance))
        state = self.model.actuators.copy()
        state[:6] = self.navigator.x[:6]
        state[TIME] = sample.time
        x, P = self.navigator.x.copy(), self.navigator.P.copy()
        return Step(
            sample.time, sample.commands, state, x, P, jacobian, places, gain, whitener, innovation, white
        )


def differences(values: Array) -> Array:
    """Differences (..., 6) of motion with the heading's wrapped to [-pi, pi]."""
    values = values.copy()
    values[..., HEADING] = np.mod(values[..., HEADING] + np.pi, 2 * np.pi) - np.pi
    return values


def corrected(sample: Sample, record: NDArray[Any]) -> Array:
    """(6,) motion of midship from what the sensors of the record report."""
    known = np.nan_to_num(sample.senses)
    true = true_motion(known[None], record, sample.time)[0]
    return np.where(np.isfinite(sample.senses), true, np.nan)


def scale_of(boat: Boat) -> Array:
    """(8,) of the boat's motion over SWAMP's, about which the filter's noise was chosen."""
    own = state_scale(boat)
    swamp = np.array([1.24, 1.24, 1.0, 1.16, 1.16, 1.16 / 1.24])
    return np.append(own / swamp, np.full(2, own[3] / swamp[3]))


def noise_of(boat: Boat, samples: Sequence[Sample], dt: float) -> Array:
    """(6,) standard deviation of each channel's measurement noise, NaN for one that is not measured."""
    measured = np.array([sample.senses for sample in samples])
    measured[:, HEADING] = np.unwrap(measured[:, HEADING])
    commands = np.array([sample.commands for sample in samples])
    runs = RunSet(boat, dt, ("live",), commands[None], measured[None], np.array([len(samples)]))
    return noise_levels(runs)


def tracker_of(
    boat: Boat, record: NDArray[Any], samples: Sequence[Sample], dt: float
) -> tuple[Tracker, list[Array]]:
    """The filter after the first samples, and their normalised innovations (6,). Its process noise is that
    multiple of `WITH_MODEL` under which the innovations are most likely (Mehra 1970).
    """
    sigmas = noise_of(boat, samples, dt)
    tried: list[tuple[float, int, Tracker, list[Array]]] = []
    for walk in WALKS:
        tracker = Tracker(boat, record, sigmas, walk * WITH_MODEL * scale_of(boat), samples[0], dt)
        loss, white = 0.0, []
        for sample in samples[1:]:
            step = tracker.advance(sample)
            if sample.time - samples[0].time < SETTLED:
                continue
            loss += float(np.sum((step.whitener @ step.innovation) ** 2))
            loss -= 2.0 * float(np.log(np.diag(step.whitener)).sum())
            white.append(step.white)
        tried.append((loss, len(tried), tracker, white))
    return min(tried, key=lambda one: one[:2])[2:]

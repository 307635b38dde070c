"""The Kalman filter of a live stream, with the last seconds of its innovations and gains."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import within_half_turn
from swamp_rl.boat import Boat
from swamp_rl.criticism.data.measurement_noise import noise_levels
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.model.scales import state_scale
from swamp_rl.link.stream import Sample
from swamp_rl.monitor.disturbance import FORCED, ForcedModel, ProcessNoise
from swamp_rl.monitor.options import DEFAULT, Options
from swamp_rl.navigation.filter import Navigator
from swamp_rl.navigation.predict import STATES, BoatModel
from swamp_rl.navigation.sensors import Fix
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.sensors import true_motion
from swamp_rl.simulator.state import ACTUATORS, HEADING, TIME

Array = NDArray[np.float64]

CURRENT = ("current_north", "current_east")  # fields of the record that are states of the filter, 6 and 7
BEYOND_OFFSETS = (
    "antenna_x",
    "antenna_y",
    "position_delay",
    "clock_offset",
    "clock_drift",
    "heading_drift",
)  # fields by which what is read is not the motion plus a constant


@dataclass(frozen=True)
class Step:
    """One step of the filter. time [s]; commands (2K,) from this time on; state (S,) and x, P after the
    reading; jacobian (8, 8) to this time; taken: how many of the six channels were measured; gain (8, 6),
    whitener (6, 6) with unit covariance of whitener @ innovation, innovation (6,), zeros where nothing was
    taken; white: (6,) normalised innovations, NaN where nothing new was measured.
    """

    time: float
    commands: Array
    state: Array
    x: Array
    P: Array
    jacobian: Array
    taken: int
    gain: Array
    whitener: Array
    innovation: Array
    white: Array


class Tracker:
    """Filter of one boat's samples. record: (1,) parameters, effects included; sigmas: (6,) standard
    deviations of the measurement noise; walk: (8,) process noise.
    """

    def __init__(
        self,
        boat: Boat,
        record: NDArray[Any],
        sigmas: Array,
        noise: ProcessNoise,
        first: Sample,
        dt: float,
        options: Options = DEFAULT,
    ) -> None:
        self.model = BoatModel(boat)
        self.sigmas, self.noise, self.dt, self.options = sigmas, noise, dt, options
        self.set_record(record)
        x = np.zeros(FORCED)
        x[:6] = np.nan_to_num(first.senses)
        start = np.append(np.array(options.start) * scale_of(boat), noise.strength)
        forced = ForcedModel(self.model, noise.time_constant)
        self.navigator = Navigator(forced, x, noise.walks, np.diag(start**2))
        self.model.actuators[ACTUATORS:] = first.commands
        self.history: deque[Step] = deque(maxlen=max(4, round(options.kept / dt)))
        self.last = first
        self.refused = np.zeros(6, dtype=int)

    def set_record(self, record: NDArray[Any]) -> None:
        """Take another parameter record (1,)."""
        self.record = record
        self.offsets = only_offsets(record)
        self.model.params = np.repeat(record, STATES + 1)

    def advance(self, sample: Sample, blind: Sequence[int] = ()) -> Step:
        """Predict to a sample's time and take in what it newly measures, but for the channels `blind`."""
        self.model.actuators[TIME] = self.last.time
        jacobian = self.navigator.predict(self.last.commands, sample.time - self.last.time)
        measured = corrected(sample, self.record, self.offsets)
        fresh = np.isfinite(measured) & (sample.senses != self.last.senses) & np.isfinite(self.sigmas)
        fresh[list(blind)] = False
        apart = differences(measured - self.navigator.x[:6])
        deviation = np.sqrt(self.navigator.P.diagonal()[:6] + self.sigmas**2)
        out = fresh & (np.abs(apart) > self.options.outlier * deviation)
        self.refused = np.where(out, self.refused + 1, 0)
        taken = fresh & (~out | (self.refused >= self.options.outliers))
        step = self._update([int(place) for place in np.flatnonzero(taken)], measured, jacobian, sample)
        step.white[fresh & ~taken] = np.sign(apart)[fresh & ~taken] * self.options.outlier
        self.last = sample
        self.history.append(step)
        return step

    def restart(self, step: Step, sample: Sample, record: NDArray[Any], current: Array) -> None:
        """Go back to a step of the history and the sample it was of, with another record (1,); current: (2,)
        how much more of it [m/s] there is from then on, in any direction as uncertain as that.
        """
        self.set_record(record)
        self.navigator.x, self.navigator.P = step.x.copy(), step.P.copy()
        self.navigator.x[6:STATES] += current
        self.navigator.P[[6, 7], [6, 7]] += float(current @ current)
        self.model.actuators = step.state.copy()
        self.last = sample
        self.refused[:] = 0
        self.history.clear()
        self.history.append(step)

    def _update(self, places: list[int], measured: Array, jacobian: Array, sample: Sample) -> Step:
        white, innovation = np.full(6, np.nan), np.zeros(6)
        gain, whitener = np.zeros((FORCED, 6)), np.zeros((6, 6))
        if places:
            taken = self.navigator.update(Fix(tuple(places), measured[places], self.sigmas[places]))
            gain[:, places], innovation[places] = taken.gain, taken.value
            whitener[np.ix_(places, places)] = taken.whitener
            white[places] = taken.value / np.sqrt(taken.covariance.diagonal())
        state = self.model.actuators.copy()
        state[:6] = self.navigator.x[:6]
        state[TIME] = sample.time
        x, P = self.navigator.x.copy(), self.navigator.P.copy()
        return Step(
            sample.time,
            sample.commands,
            state,
            x,
            P,
            jacobian,
            len(places),
            gain,
            whitener,
            innovation,
            white,
        )


def differences(values: Array) -> Array:
    """Differences (..., 6) of motion with the heading's wrapped to [-pi, pi]."""
    values = values.copy()
    values[..., HEADING] = within_half_turn(values[..., HEADING])
    return values


def corrected(sample: Sample, record: NDArray[Any], offsets: Array | None = None) -> Array:
    """(6,) motion of midship from what the sensors of the record report; offsets: by `only_offsets`."""
    if offsets is not None:
        return sample.senses - offsets
    known = np.nan_to_num(sample.senses)
    true = true_motion(known[None], record, sample.time)[0]
    return np.where(np.isfinite(sample.senses), true, np.nan)


def only_offsets(record: NDArray[Any]) -> Array | None:
    """(6,) by how much the sensors of the record read off; None where they do more than that."""
    if any(record[field][0] != 0.0 for field in BEYOND_OFFSETS):
        return None
    return np.array([0.0, 0.0, record["heading_bias"][0], 0.0, 0.0, record["gyro_bias"][0]])


def scale_of(boat: Boat) -> Array:
    """(8,) scales of the filter's states: those of the motion, and the top speed for the current."""
    own = state_scale(boat)
    return np.append(own, np.full(2, reference_of(boat).speed))


def noise_of(boat: Boat, samples: Sequence[Sample], dt: float) -> Array:
    """(6,) standard deviation of each channel's measurement noise, NaN for one that is not measured."""
    measured = np.array([sample.senses for sample in samples])
    measured[:, HEADING] = np.unwrap(measured[:, HEADING])
    commands = np.array([sample.commands for sample in samples])
    runs = RunSet(boat, dt, ("live",), commands[None], measured[None], np.array([len(samples)]))
    return noise_levels(runs)


def loss_of(step: Step) -> float:
    """Minus two log-likelihood of a step's innovation, without its constant."""
    scales = step.whitener.diagonal()
    chi2 = float(np.sum((step.whitener @ step.innovation) ** 2))
    return chi2 - 2.0 * float(np.log(scales[scales > 0.0]).sum())


def tracker_of(
    boat: Boat, record: NDArray[Any], samples: Sequence[Sample], dt: float, options: Options = DEFAULT
) -> tuple[Tracker, list[Array]]:
    """The filter after the first samples, and their normalised innovations (6,). Its process noise is that
    under which the innovations are most likely (Mehra 1970): of the walks and strengths of the options, by
    steps to the best neighbour.
    """
    sigmas = noise_of(boat, samples, dt)
    walks = [one for one in options.walks if one >= options.least_walk]
    grid = [[noise_level(boat, walk, strength, options) for strength in options.strengths] for walk in walks]
    tried: dict[tuple[int, int], tuple[float, Tracker, list[Array]]] = {}

    def loss(place: tuple[int, int]) -> float:
        if place not in tried:
            noise = grid[place[0]][place[1]]
            tried[place] = filtered_over(boat, record, samples, sigmas, noise, dt, options)
        return tried[place][0]

    best, left = (-1, -1), (len(walks) // 2, len(options.strengths) // 2)
    while left != best:
        best = left
        rows = range(max(0, best[0] - 1), min(len(walks), best[0] + 2))
        columns = range(max(0, best[1] - 1), min(len(options.strengths), best[1] + 2))
        near = [(row, best[1]) for row in rows] + [(best[0], column) for column in columns]
        left = min(near, key=lambda place: (loss(place), place))
    return tried[best][1:]


def filtered_over(
    boat: Boat,
    record: NDArray[Any],
    samples: Sequence[Sample],
    sigmas: Array,
    noise: ProcessNoise,
    dt: float,
    options: Options,
) -> tuple[float, Tracker, list[Array]]:
    """Minus two log-likelihood of the innovations after `settled`, the filter at the end, and the normalised
    innovations (6,).
    """
    tracker = Tracker(boat, record, sigmas, noise, samples[0], dt, options)
    loss, white = 0.0, []
    for sample in samples[1:]:
        step = tracker.advance(sample)
        if sample.time - samples[0].time < options.settled:
            continue
        loss += loss_of(step)
        white.append(step.white)
    return loss, tracker, white


def noise_level(boat: Boat, walk: float, strength: float, options: Options) -> ProcessNoise:
    """Multiples of the process noise of the options for this boat."""
    reference, scales = reference_of(boat), scale_of(boat)
    time = boat.length / reference.speed
    walks = np.array(options.walk) * scales / np.sqrt(time)
    accelerations = np.array(options.strength) * scales[3:6] / time
    return ProcessNoise(walk * walks, strength * accelerations, options.gust_time)

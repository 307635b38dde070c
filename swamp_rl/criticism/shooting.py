"""Multiple shooting: windows of runs, each from an initial state of its own, predicted by rollouts."""

import math
from copy import copy
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.guess import guessed_states
from swamp_rl.criticism.kernel import roll, roll_actuators
from swamp_rl.criticism.slow import filter_of
from swamp_rl.criticism.windows import Windows
from swamp_rl.simulator import initial_state, parameters, tank
from swamp_rl.simulator.sensors import observe
from swamp_rl.simulator.state import ACTUATORS

Array = NDArray[np.float64]

SUBSTEP, SUBSTEP_OF_RUNS = 0.1, 0.05  # s, the longest Runge-Kutta step; whole runs magnify its error
PAD = 1.0  # s simulated before a window's first sample, so that delays see what went before
SHORTEST = 1.5  # s of a window that a doubtful command leaves, below which it is not compared
SETTLING = 3.0  # s at a run's start that are not compared: how the actuators stood there is not recorded
# sd of a guessed state, at least, and in standard deviations of the noise (m, m, rad, m/s, m/s, rad/s)
BELIEVED, BELIEVED_NOISE = np.array([0.5, 0.5, 0.15, 0.5, 0.5, 0.3]), 3.0
COURSES = 12  # of actuators over whole runs that are kept
NO_PUSH = np.zeros((0, 1, 3))
# of finite differences; small, for a boat that keeps no course by itself magnifies them a thousandfold
STATE_STEP = np.array([1e-5, 1e-5, 1e-6, 1e-6, 1e-6, 1e-6])


def cut(trials: Trials, weight: Array, seconds: float, before: float = PAD) -> Windows:
    """Windows of about `seconds` without overlap; inf: one window a run; simulated from `before` [s] earlier.

    A run is cut in a power of two, so that longer windows start where some shorter ones do, and wherever a
    command is doubtful.
    """
    pad = math.ceil(before / trials.dt)
    settling = max(pad, math.ceil(SETTLING / trials.dt))
    shortest = math.ceil(SHORTEST / trials.dt)
    rows: list[tuple[int, int, int]] = []
    for run, length in enumerate(trials.lengths):
        available = int(length) - settling
        pieces = (
            2 ** max(0, round(math.log2(available * trials.dt / seconds))) if math.isfinite(seconds) else 1
        )
        edges = np.linspace(settling, length, pieces + 1).round().astype(int)
        lost = [(gap.row, gap.row + gap.rows) for gap in trials.gaps if gap.run == run]
        for a, b in pairwise(edges):
            inside = [(g, h) for g, h in lost if g < b and h > a]
            starts = [a, *(h for _, h in inside)]
            ends = [*(g for g, _ in inside), b]
            rows += [
                (run, s - pad, e - 1 - (s - pad))
                for s, e in zip(starts, ends, strict=True)
                if e - s >= min(shortest, b - a)
            ]
    run_of, first, steps = (np.array(column) for column in zip(*rows, strict=True))
    measured, weights = window_data(trials, weight, run_of, first, steps, pad)
    return Windows(run_of, first, steps, measured, weights, pad, int(steps.max()) + 1)


def window_data(
    trials: Trials,
    weight: Array,
    run: NDArray[np.int64],
    first: NDArray[np.int64],
    steps: NDArray[np.int64],
    pad: int,
) -> tuple[Array, Array]:
    """Measured and weight (W, rows, 6) of windows; the first `pad` rows are only simulated."""
    measured = np.zeros((len(run), int(steps.max()) + 1, 6))
    weights = np.zeros_like(measured)
    for w, (its_run, start, count) in enumerate(zip(run, first, steps, strict=True)):
        part = slice(start + pad, start + count + 1)
        measured[w, pad : count + 1] = trials.measured[its_run, part]
        weights[w, pad : count + 1] = weight[its_run, part]
    return np.nan_to_num(measured), weights


def wrap(angle: Array) -> Array:
    """Angles [rad] to within half a turn of zero."""
    return angle - 2 * np.pi * np.round(angle / (2 * np.pi))


class Shooting:
    """The comparison of trials with rollouts, cut in windows of one length.

    Holds what every fit shares: windows, commands, the tank, and the actuators' states under the boat file.
    """

    def __init__(
        self,
        trials: Trials,
        weight: Array,
        seconds: float,
        windows: Windows | None = None,
        before: float = PAD,
    ) -> None:
        self.trials = trials
        self.boat = trials.boat
        self.seconds = seconds
        self.weight = weight
        self.tank = tank(trials.boat)
        self.record = parameters(trials.boat)
        self.dt = trials.dt
        self.windows = self._held(cut(trials, weight, seconds, before)) if windows is None else windows
        self.substeps = max(
            1, math.ceil(trials.dt / (SUBSTEP if math.isfinite(seconds) else SUBSTEP_OF_RUNS) - 1e-9)
        )
        self.samples = int((self.windows.weight[:, self.windows.pad :] > 0).sum())
        slow = trials.slow
        self.filter = None if slow is None else filter_of(self.windows, slow, trials.dt)
        self.last = int(self.windows.first.max()) + 1
        self.lasting = 1.0  # samples that an error lasts, where weights are the model's own errors
        self.rolled = [0]  # steps of a boat, over all parts of this comparison
        self.courses: dict[tuple[str, bytes], Array] = {}

    def _held(self, windows: Windows) -> Windows:
        """The windows, their first row holding what the states are guessed to be, with little weight: so that
        a wrong model cannot bend a window by a start that nobody would believe.
        """
        if windows.pad > 0:
            noise = 1.0 / np.maximum(self.weight.max(axis=(0, 1)), 1e-6)
            windows.measured[:, 0] = self.guess(windows)
            windows.weight[:, 0] = 1.0 / np.maximum(
                BELIEVED, np.where(noise < 1e6, BELIEVED_NOISE * noise, 0.0)
            )
        return windows

    @cached_property
    def boat_thrust(self) -> Array:
        """(K,) most thrust [N] of each thruster, at rest."""
        record = self.record[0]
        jets = record["thrust_linear"] + record["thrust_quadratic"]
        return np.maximum(jets, 1.0)

    @cached_property
    def plain_actuators(self) -> Array:
        """(W, S - 6) time and actuators at the windows' starts, as the boat file has it."""
        return self.actuators(Hypothesis(), np.zeros((1, 0)))[0]

    def part(self, chosen: NDArray[np.bool_]) -> "Shooting":
        """The comparison on some of its windows (W,) alone."""
        win = self.windows
        windows = Windows(
            win.run[chosen],
            win.first[chosen],
            win.steps[chosen],
            win.measured[chosen],
            win.weight[chosen],
            win.pad,
            win.measured.shape[1],
        )
        made = copy(self)
        made.windows = windows
        made.filter = self.filter.part(chosen) if self.filter is not None else None
        made.samples = int((windows.weight[:, windows.pad :] > 0).sum())
        made.plain_actuators = self.plain_actuators[chosen]
        return made

    def under(self, trials: Trials) -> "Shooting":
        """The same windows with other commands."""
        made = copy(self)
        made.trials, made.courses = trials, {}
        made.plain_actuators = made.actuators(Hypothesis(), np.zeros((1, 0)))[0]
        return made

    def actuators(self, hypothesis: Hypothesis, x: Array) -> Array:
        """(V, W, S - 6) time and actuators at the windows' starts for each row of x (V, p)."""
        places = self.windows.run, self.windows.first
        return np.stack([self._course(hypothesis, row)[places] for row in x])

    def _course(self, hypothesis: Hypothesis, x: Array) -> Array:
        """(R, rows, S - 6) time and actuators up to the last window's start under x (p,)."""
        key = hypothesis.label, x.tobytes()
        if key not in self.courses:
            runs = len(self.trials.lengths)
            records = np.repeat(hypothesis.records(self.boat, x[None], self.record), runs)
            start = initial_state(records, np.zeros((runs, 3)))
            start[:, ACTUATORS:] = self._first_actuators(start.shape[1] - ACTUATORS)
            states = np.empty((runs, self.last, start.shape[1] - 6))
            roll_actuators(records, start, self.trials.commands, np.arange(runs), self.dt, states)
            if len(self.courses) >= COURSES:
                del self.courses[next(iter(self.courses))]
            self.courses[key] = states
        return self.courses[key]

    def _first_actuators(self, width: int) -> Array:
        """(R, width) actuators where the first command wants them."""
        first = np.zeros((len(self.trials.lengths), width))
        commands = self.trials.commands[:, 0]
        first[:, : commands.shape[1]] = commands
        return first

    def predict(
        self, hypothesis: Hypothesis, x: Array, states: Array, push: Array = NO_PUSH, block: int = 1
    ) -> Array:
        """(V, W, T + 1, 6) what the sensors would say, for x (V, p) and rigid states (V, W, 6) at the
        starts; push: (V W or 0, B, 3) and block as in `roll`.
        """
        win, variants = self.windows, len(x)
        records = hypothesis.records(self.boat, x, self.record)
        if hypothesis.moves_actuators:
            rows, place = np.unique(x, axis=0, return_inverse=True)
            actuators = self.actuators(hypothesis, rows)[place.reshape(-1)]
        else:
            actuators = np.broadcast_to(self.plain_actuators, (variants, *self.plain_actuators.shape))
        start = np.concatenate([states, actuators], axis=2).reshape(variants * win.count, -1)
        track = np.empty((len(start), win.rows, 6))
        batch = np.repeat(records, win.count)
        run, first, steps = (np.tile(a, variants) for a in (win.run, win.first, win.steps))
        seeds = np.zeros(len(start), np.uint64)
        self.rolled[0] += int(steps.sum()) * self.substeps
        roll(
            batch,
            self.tank,
            start,
            self.trials.commands,
            run,
            first,
            steps,
            seeds,
            self.dt,
            self.substeps,
            push,
            block,
            track,
        )
        track = observe(track, batch, self.dt)
        return track.reshape(variants, win.count, *track.shape[1:])

    def residuals(self, prediction: Array) -> Array:
        """(..., W, M) measured less predicted in standard deviations, 0 where nothing was measured."""
        with np.errstate(invalid="ignore"):
            return self.weighed(self.difference(prediction))

    def difference(self, prediction: Array) -> Array:
        """(..., W, T, 6) measured less predicted, headings to within half a turn."""
        difference = self.windows.measured - prediction
        difference[..., 2] = wrap(difference[..., 2])
        return difference

    def weighed(self, difference: Array) -> Array:
        """(..., W, M) of differences (..., W, T, 6) between tracks, in standard deviations, whitened where
        errors wander.
        """
        weighed = difference * self.windows.weight
        if self.filter is not None:
            weighed = self.filter.whitened(weighed)
        return weighed.reshape(*weighed.shape[:-2], -1)

    def state_jacobian(
        self,
        hypothesis: Hypothesis,
        x: Array,
        states: Array,
        base: Array,
        push: Array = NO_PUSH,
        block: int = 1,
    ) -> Array:
        """(W, M, 6) of the weighted prediction by the initial states; a shift of position just shifts
        the track. push: (W or 0, B, 3).
        """
        moved = np.repeat(states[None], 4, axis=0)
        for i, column in enumerate((2, 3, 4, 5)):
            moved[i, :, column] += STATE_STEP[column]
        four = np.repeat(x[None], 4, axis=0)
        prediction = self.predict(hypothesis, four, moved, np.tile(push, (4, 1, 1)), block)
        change = np.zeros((6, *base.shape))
        change[0, ..., 0] = 1.0
        change[1, ..., 1] = 1.0
        for i, column in enumerate((2, 3, 4, 5)):
            change[column] = (prediction[i] - base) / STATE_STEP[column]
        return np.ascontiguousarray(np.moveaxis(self.weighed(change), 0, -1))

    def parameter_jacobian(self, hypothesis: Hypothesis, x: Array, states: Array, base: Array) -> Array:
        """(W, M, p) of the weighted prediction by x, one-sided differences that stay within the bounds."""
        size = hypothesis.size
        if size == 0:
            return np.zeros((self.windows.count, base[0].size, 0))
        _, high = hypothesis.bounds()
        step = np.array([s.difference for s in hypothesis.specs])
        step = np.where(x + step > high, -step, step)
        prediction = self.predict(hypothesis, x + np.diag(step), np.repeat(states[None], size, axis=0))
        change = self.weighed((prediction - base) / step[:, None, None, None])
        return np.moveaxis(change, 0, -1)

    def guess(self, windows: Windows | None = None) -> Array:
        """(W, 6) states at the starts, smoothed from what was measured about them."""
        return guessed_states(self.trials, self.weight, windows or self.windows)

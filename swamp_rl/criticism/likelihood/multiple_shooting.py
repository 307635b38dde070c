"""Multiple shooting: windows of runs, each simulated from its own initial state."""

import math
from collections.abc import Callable
from copy import copy
from functools import cached_property
from threading import Lock
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import within_half_turn
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.data.windows import Windows, cut
from swamp_rl.criticism.likelihood.gauss_markov import kalman_filter
from swamp_rl.criticism.likelihood.initial_states import smoothed_states
from swamp_rl.criticism.model.actuator_history import actuator_states
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.rollout import roll
from swamp_rl.criticism.model.scales import state_scale
from swamp_rl.criticism.options import options
from swamp_rl.simulator import parameters, tank
from swamp_rl.simulator.sensors import is_altered, observe, rows_ahead, sensors_of
from swamp_rl.simulator.state import TIME
from swamp_rl.simulator.substeps import substeps_of

Array = NDArray[np.float64]
K = TypeVar("K")

NO_ACCELERATION = np.zeros((0, 1, 3))


def put_last(kept: dict[K, Array], new: dict[K, Array], most: int) -> None:
    """Keep arrays as the last ones to go, and of all of them at most so many."""
    for key, one in new.items():
        kept.pop(key, None)
        kept[key] = one
    for key in list(kept)[: max(len(kept) - most, 0)]:
        del kept[key]


class Shooting:
    """Runs cut in windows of one length, and their simulation.

    Holds what every fit shares: windows, commands, towing tank, and the actuators' states under the boat
    file.
    """

    def __init__(
        self,
        run_set: RunSet,
        weight: Array,
        seconds: float,
        windows: Windows | None = None,
        before: float | None = None,
    ) -> None:
        self.run_set = run_set
        self.boat = run_set.boat
        self.seconds = seconds
        self.weight = weight
        self.tank = tank(run_set.boat)
        self.record = parameters(run_set.boat)
        self.scale = state_scale(run_set.boat)
        self.dt = run_set.dt
        self.windows = windows or self._with_start_prior(cut(run_set, weight, seconds, before))
        finer = 1.0 if math.isfinite(seconds) else options().substep_of_runs
        self.substeps = substeps_of(run_set.dt / finer, run_set.boat)
        self.jacobian_substeps = substeps_of(run_set.dt, run_set.boat)  # the simulator's
        process = run_set.gauss_markov
        self.filter = None if process is None else kalman_filter(self.windows, process, run_set.dt)
        self.last = int(self.windows.first.max()) + 1
        # integrated autocorrelation time, where weights are the model error's
        self.correlation_samples = 1.0
        # (p,) variances of a fit's parameters that no estimate from these runs is below, where known
        self.least_variances: Callable[[Any], Array] | None = None
        # of all tracks asked for, kept ones as well: what is kept does not change how long a search goes on
        self.boat_steps = [0]  # shared by all parts of this problem
        # the last ones, by windows and steps, records and starts; None: not kept
        self.tracks: dict[tuple[bytes, ...], Array] | None = {}
        self.histories: dict[tuple[str, bytes], Array] = {}
        self.cache_lock = Lock()  # held while `tracks` and `histories` change
        self.last_records: list[Any] = []  # hypothesis, numbers and what `_records` made of them
        self.last_slopes: list[Any] = []  # the same of `state_jacobian`, by window and initial state
        self.scores: list[Any] = []  # fits, and what `score_tests` computed beside them

    def _with_start_prior(self, windows: Windows) -> Windows:
        """The windows with a Gaussian prior about the smoothed initial states as their first row."""
        if windows.pad > 0:
            best = self.weight.max(axis=(0, 1))
            noise = np.where(best > 0.0, 1.0 / np.maximum(best, 1e-300), 0.0)  # 0 where nothing was measured
            windows.measured[:, 0] = self.initial_states(windows)
            least = np.array(options().start_sd) * self.scale
            windows.weight[:, 0] = 1.0 / np.maximum(least, options().start_sd_in_noise * noise)
        return windows

    @property
    def samples(self) -> int:
        """Number of samples that are compared."""
        return self.windows.samples

    @cached_property
    def plain_actuators(self) -> Array:
        """(W, S - 6) time and actuators at the windows' starts under the boat file."""
        return self.actuators(Hypothesis(), np.zeros((1, 0)))[0]

    def part(self, chosen: NDArray[np.bool_]) -> "Shooting":
        """The problem on some of its windows (W,); it keeps no tracks, for a fit asks for each once."""
        made = copy(self)
        made.tracks, made.scores = None, []
        made.windows = self.windows.part(chosen)
        made.filter = self.filter.part(chosen) if self.filter is not None else None
        made.plain_actuators = self.plain_actuators[chosen]
        return made

    def apart(self) -> "Shooting":
        """The same problem for another thread, whose boat steps count apart; kept tracks are common."""
        made = copy(self)
        made.last_records, made.last_slopes, made.scores, made.boat_steps = [], [], [], [0]
        return made

    def in_blocks(self, rows: int, count: int, ahead: int) -> "Shooting":
        """Each window, with `ahead` rows after its end, in so many blocks of rows, simulated and not
        compared; what is beyond stands still.
        """
        win, behind = self.windows, rows * np.arange(count)
        run, most = np.repeat(win.run, count), self.run_set.commands.shape[1] - 1
        first = np.minimum(win.first[:, None] + behind, most).reshape(-1)
        steps = np.clip(win.steps[:, None] + ahead - behind, 0, rows).reshape(-1)
        unmeasured = np.zeros((len(run), rows + 1, 6))
        windows = Windows(run, first, steps, unmeasured, unmeasured, 0, rows + 1)
        return self._simulated_anew(windows=windows, filter=None, tracks=None)

    def integrated_in(self, substeps: int) -> "Shooting":
        """The same windows, integrated in so many steps from row to row."""
        made = copy(self)
        made.substeps, made.jacobian_substeps, made.last_slopes, made.scores = substeps, substeps, [], []
        return made

    def with_commands(self, run_set: RunSet) -> "Shooting":
        """The same windows with the commands of other runs."""
        return self._simulated_anew(run_set=run_set)

    def of_record(self, record: NDArray[Any]) -> "Shooting":
        """The same windows with the parameter record (1,) of another boat file."""
        return self._simulated_anew(record=record)

    def _simulated_anew(self, **changed: Any) -> "Shooting":
        made = copy(self)
        kept: dict[str, Any] = {"tracks": {}, "histories": {}, "scores": []}
        vars(made).update(kept | {"last_records": [], "last_slopes": []} | changed)
        made.last = int(made.windows.first.max()) + 1
        made.plain_actuators = made.actuators(Hypothesis(), np.zeros((1, 0)))[0]
        return made

    def actuators(self, hypothesis: Hypothesis, x: Array) -> Array:
        """(V, W, S - 6) time and actuators at the windows' starts for each row of x (V, p)."""
        places = self.windows.run, self.windows.first
        return np.stack([self._actuator_history(hypothesis, row)[places] for row in x])

    def _actuator_history(self, hypothesis: Hypothesis, x: Array) -> Array:
        """(R, rows, S - 6) time and actuators up to the last window's start under x (p,)."""
        key = hypothesis.label, x.tobytes()
        found = self.histories.get(key)
        if found is None:
            records = hypothesis.records(self.boat, x[None], self.record, self.run_set.origins)
            commands, parts = self.run_set.commands_of_parts, self.run_set.parts
            found = actuator_states(records, commands, self.last, self.dt, parts=parts)
            with self.cache_lock:
                put_last(self.histories, {key: found}, options().most_histories)
        return found

    def _records(self, hypothesis: Hypothesis, x: Array) -> tuple[NDArray[Any], bool]:
        """(V R,) parameter records of every run under each row of x (V, p), and whether their sensors alter
        the motion. Those of the last numbers are kept: a fit of the initial states does not move them, nor
        does its Jacobian.
        """
        key = x.tobytes()
        if not (self.last_records and self.last_records[0] is hypothesis and self.last_records[1] == key):
            made = hypothesis.records(self.boat, x, self.record, self.run_set.origins).reshape(len(x), -1)
            every = np.broadcast_to(made, (len(x), len(self.run_set.lengths)))
            # copied, for numba would compile the simulation of a view that is read-only once more
            self.last_records[:] = [hypothesis, key, every.flatten(), is_altered(made)]
        return self.last_records[2], self.last_records[3]

    def predict(
        self,
        hypothesis: Hypothesis,
        x: Array,
        states: Array,
        acceleration: Array = NO_ACCELERATION,
        block: int = 1,
    ) -> Array:
        """(V, W, T + 1, 6) predicted measurements for x (V, p) and rigid states (V, W, 6) at the starts;
        acceleration: (V W or 0, B, 3) and block as in `roll`. Without one the last tracks of all windows are
        kept: an effect at its neutral values leaves what was predicted before.
        """
        win = self.windows
        records, altered, start, ahead = self._starts(hypothesis, x, states)

        def simulated(boats: NDArray[Any], begun: Array) -> Array:
            motion = self._moved(boats, begun, ahead, acceleration, block)
            return self._observed(boats, motion) if altered else motion

        if len(acceleration) or self.tracks is None:
            return simulated(records, start)
        where = np.concatenate([win.run, win.first, win.steps, [self.substeps, ahead]]).tobytes()
        boats = [one.tobytes() for one in records]
        keys: list[tuple[bytes, ...]] = [
            (where, boats[v % len(boats)], one.tobytes()) for v, one in enumerate(start)
        ]
        with self.cache_lock:
            found = {key: self.tracks[key] for key in keys if key in self.tracks}
        new = np.array([key not in found for key in keys])
        if new.any():
            boats_of_new = records[new] if len(records) > 1 else records
            made = simulated(boats_of_new, start[new])
            found |= zip((keys[v] for v in np.flatnonzero(new)), made, strict=True)
        with self.cache_lock:
            put_last(self.tracks, found, options().most_tracks)
        return np.stack([found[key] for key in keys])

    def motion(
        self, hypothesis: Hypothesis, x: Array, states: Array, acceleration: Array, block: int
    ) -> Array:
        """As `predict`, (V, W, rows, 6) before the sensors, with the rows that these look ahead."""
        records, _, start, ahead = self._starts(hypothesis, x, states)
        return self._moved(records, start, ahead, acceleration, block)

    def alters(self, hypothesis: Hypothesis, x: Array) -> bool:
        """Whether the sensors under x (p,) alter the motion."""
        return self._records(hypothesis, x[None])[1]

    def observed(self, hypothesis: Hypothesis, x: Array, motion: Array) -> Array:
        """(V, W, T + 1, 6) measured of motions (V, W, rows, 6), which are overwritten, under x (p,)."""
        return self._observed(self._records(hypothesis, x[None])[0][None], motion)

    def _starts(
        self, hypothesis: Hypothesis, x: Array, states: Array
    ) -> tuple[NDArray[Any], bool, Array, int]:
        """Records (V or 1, R), whether their sensors alter the motion, states (V, W, S) at the starts, and
        rows that sensors look ahead; counts the steps of their simulation.
        """
        win, variants, runs = self.windows, len(x), len(self.run_set.lengths)
        own = x[:1] if (x == x[:1]).all() else x
        records, altered = self._records(hypothesis, own)
        ahead = rows_ahead(records, float(self.run_set.lengths.max()) * self.dt, self.dt) if altered else 0
        start = np.empty((variants, win.count, 6 + self.plain_actuators.shape[1]))
        start[..., :6] = states
        if hypothesis.moves_actuators:
            moving = hypothesis.of_actuators(own)
            rows = {row.tobytes(): row for row in moving}
            made = dict(zip(rows, self.actuators(hypothesis, np.stack(list(rows.values()))), strict=True))
            start[..., 6:] = np.stack([made[row.tobytes()] for row in moving])
        else:
            start[..., 6:] = self.plain_actuators
        self.boat_steps[0] += int((win.steps + ahead).sum()) * variants * self.substeps
        return records.reshape(len(own), runs), altered, start, ahead

    def _moved(
        self, records: NDArray[Any], start: Array, ahead: int, acceleration: Array, block: int
    ) -> Array:
        """(V, W, rows, 6) motion of boats with records (V or 1, R) from states (V, W, S), with `ahead` rows
        beyond a window's last.
        """
        win, runs = self.windows, records.shape[1]
        which = (runs * np.arange(len(records))[:, None] + win.run).reshape(-1)
        begun = start.reshape(-1, start.shape[2])
        track = np.empty((len(begun), win.rows + ahead, 6))
        commands, parts = self.run_set.commands_of_parts, self.run_set.parts
        inputs = commands, self.run_set.weather, win.run, win.first, win.steps + ahead
        given = records.reshape(-1), which, self.tank, begun, *inputs, np.zeros(len(which), np.uint64)
        roll(*given, self.dt, self.substeps, parts, acceleration, block, track)
        return track.reshape(len(start), win.count, -1, 6)

    def _observed(self, records: NDArray[Any], motion: Array) -> Array:
        """(V, W, T + 1, 6) measured of motions (V, W, rows, 6), which are overwritten, of boats with records
        (V or 1, R).
        """
        win, runs = self.windows, records.shape[1]
        track = motion.reshape(-1, *motion.shape[2:])
        each = (runs * (np.arange(len(motion)) % len(records))[:, None] + win.run).reshape(-1)
        began = np.tile(self.plain_actuators[:, TIME - 6], len(motion))
        of_earth = np.array(self.run_set.of_earth or (False,) * runs)[each % runs]
        boats = max(1, options().observed_rows // track.shape[1])
        sensors = sensors_of(records.reshape(-1))
        for part in (slice(one, one + boats) for one in range(0, len(track), boats)):
            track[part] = observe(track[part], sensors[each[part]], self.dt, began[part], of_earth[part])
        return track[:, : win.rows].reshape(len(motion), win.count, win.rows, 6)

    def track(self, hypothesis: Hypothesis, x: Array, states: Array) -> Array:
        """(W, T + 1, 6) predicted measurements for x (p,) and rigid states (W, 6) at the starts."""
        return self.predict(hypothesis, x[None], states[None])[0]

    def residuals(self, prediction: Array) -> Array:
        """(..., W, M) measured less predicted in standard deviations, 0 where nothing was measured."""
        with np.errstate(invalid="ignore"):
            return self.standardised(self.difference(prediction))

    def difference(self, prediction: Array) -> Array:
        """(..., W, T, 6) measured less predicted, headings in [-pi, pi]."""
        difference = self.windows.measured - prediction
        difference[..., 2] = within_half_turn(difference[..., 2])
        return difference

    def standardised(self, difference: Array) -> Array:
        """(..., W, M) differences (..., W, T, 6) of tracks in standard deviations, whitened."""
        standardised = difference * self.windows.weight
        if self.filter is not None:
            standardised = self.filter.whitened(standardised)
        return standardised.reshape(*standardised.shape[:-2], -1)

    def initial_states(self, windows: Windows | None = None) -> Array:
        """(W, 6) states at the starts, smoothed from the measurements about them."""
        return smoothed_states(self.run_set, self.weight, windows or self.windows)

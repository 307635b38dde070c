"""Measured runs as arrays on one uniform time grid, with gaps marked."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, partial
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.data.checks import (
    dataset_names,
    refuse_disorder,
    refuse_jump,
    refuse_mixed,
    refuse_other_boat,
    refuse_too_coarse,
    refuse_too_short,
    refuse_unexciting,
)
from swamp_rl.criticism.model.actuator_history import first_compared, first_known_again
from swamp_rl.criticism.options import options
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, inspect_dataset, refuse_faults
from swamp_rl.simulator.replay import fixed_thrusters, sample_step, velocities_of_earth
from swamp_rl.simulator.substeps import substeps_of
from swamp_rl.simulator.weather import DEPTH, FIELDS, FROM, SPEED, measured_weather

Array = NDArray[np.float64]
Wind = Literal["measured", "ignored", "unknown"]

CHANNELS = ("north", "east", "heading", "surge", "sway", "yaw_rate")
POSITIONS = slice(0, 2)
UNITS = ("m", "m", "rad", "m/s", "m/s", "rad/s")


@dataclass(frozen=True)
class Gap:
    """`rows` lost rows from `row` on, in which the command is unknown: it is another after them, or may have
    changed and returned.
    """

    run: int
    row: int
    rows: int


def _of_runs(gaps: tuple[Gap, ...], runs: list[int]) -> tuple[Gap, ...]:
    """The gaps in those runs, by the places of these in the list."""
    return tuple(replace(gap, run=runs.index(gap.run)) for gap in gaps if gap.run in runs)


@dataclass(frozen=True)
class Instants:
    """When commands changed between two rows: change (R, T, 2K) until the next row as logged, and the share
    (R, T) of it that a row takes on; cost in chi2 of fitted ones, see `cost_of_shares`.
    """

    change: Array
    shares: Array
    cost: float = 0.0


@dataclass(frozen=True)
class RunSet:
    """R runs of up to T samples of one boat.

    dt: sample step [s]; commands: (R, T, 2K), interpolated linearly over missing rows; measured: (R, T,
    6) in the order of CHANNELS (SI, rad, heading unwrapped), NaN where there is none; lengths: (R,)
    samples of each run; gaps: where the commands are unknown; filled: those in which the best-fitting
    ones were chosen; gauss_markov: (6, 3) standard deviation [the channel's unit] and time constant [s]
    of the Gauss-Markov part of the noise, and the standard deviation of the white part beside it in that
    of `noise_levels`, None where all noise is white; too_short: names of runs that are left
    out; weather: (R or 0, T, 3), rows of `measured_weather`; ignored: the same with the measured wind,
    where that was left out; origin: the run that each is a part of, itself where empty; days: the group
    that a dataset gives each run, or none; within: (R, T, parts, 2K) commands in the parts of each row
    less those of the row, None where these are held; instants: those by which the logged commands were
    moved, None where they were not; of_earth: of each run, whether its surge and sway were turned by its
    measured heading, none where empty.
    """

    boat: Boat
    dt: float
    names: tuple[str, ...]
    commands: Array
    measured: Array
    lengths: NDArray[np.int64]
    gaps: tuple[Gap, ...] = ()
    filled: tuple[Gap, ...] = ()
    gauss_markov: Array | None = None
    too_short: tuple[str, ...] = ()
    weather: Array = field(default_factory=lambda: np.zeros((0, 0, 3)))
    ignored: Array = field(default_factory=lambda: np.zeros((0, 0, 3)))
    origin: tuple[int, ...] = ()
    days: tuple[str, ...] = ()
    within: Array | None = None
    instants: Instants | None = None
    of_earth: tuple[bool, ...] = ()

    @property
    def present(self) -> tuple[str, ...]:
        """Channels that at least one run holds."""
        here = np.isfinite(self.measured).any(axis=(0, 1))
        return tuple(CHANNELS[channel] for channel in np.flatnonzero(here))

    @cached_property
    def first_compared(self) -> NDArray[np.int64]:
        """(R,) first row that is compared with a simulation; before it the actuators' states are unknown."""
        return first_compared(self.boat, self.commands, self.lengths, self.dt)

    @cached_property
    def compared_again(self) -> list[int]:
        """First row after each gap that is compared with a simulation; before it the actuators' states are
        unknown, as the commands in the gap are.
        """
        lost = [(gap.run, gap.row, gap.rows) for gap in self.gaps]
        return first_known_again(self.boat, self.commands, lost, self.dt) if lost else []

    def with_commands_of(self, other: "RunSet") -> "RunSet":
        """These runs, their commands reconstructed as those of `other` are."""
        return replace(self, commands=other.commands, within=other.within, instants=other.instants)

    @property
    def fitted_instants(self) -> Instants | None:
        """Those that were fitted one by one, None where there are none."""
        return self.instants if self.instants_cost else None

    @property
    def instants_cost(self) -> float:
        """In chi2, of the fitted instants of command changes."""
        return self.instants.cost if self.instants else 0.0

    @cached_property
    def parts(self) -> int:
        """Equal parts of a row in which commands may differ: the steps in which it is integrated, so that a
        delay moves commands by steps and mixes no two of them over a whole row.
        """
        return substeps_of(self.dt, self.boat)

    @cached_property
    def commands_of_parts(self) -> Array:
        """(R, T parts, 2K) commands in each part of each row."""
        if self.within is None:
            return np.repeat(self.commands, self.parts, axis=1)
        runs, rows, parts, channels = self.within.shape
        return (self.commands[:, :, None] + self.within).reshape(runs, rows * parts, channels)

    def subset(self, runs: list[int]) -> "RunSet":
        """The set of those runs alone."""
        known = self.instants
        return replace(
            self,
            names=tuple(self.names[run] for run in runs),
            commands=self.commands[runs],
            measured=self.measured[runs],
            lengths=self.lengths[runs],
            gaps=_of_runs(self.gaps, runs),
            filled=_of_runs(self.filled, runs),
            weather=self.weather[runs] if len(self.weather) else self.weather,
            ignored=self.ignored[runs] if len(self.ignored) else self.ignored,
            origin=tuple(int(self.origins[run]) for run in runs),
            too_short=(),
            days=(),
            within=self.within[runs] if self.within is not None else None,
            of_earth=tuple(self.of_earth[run] for run in runs) if self.of_earth else (),
            instants=Instants(known.change[runs], known.shares[runs], known.cost) if known else None,
        )

    def copies(self, runs: list[int], commands: Array) -> "RunSet":
        """Copies of those runs, some perhaps several times, with commands (n, T, 2K) of their own."""
        return replace(self.subset(runs), commands=commands, gaps=(), filled=(), instants=None)

    @property
    def origins(self) -> NDArray[np.int64]:
        """(R,) the run that each is a part of."""
        return np.array(self.origin) if self.origin else np.arange(len(self.lengths))

    @property
    def groups(self) -> dict[str, tuple[int, ...]]:
        """Group of each run, by `day` where a dataset tells it, and by `run` where not each is a day."""
        order = sorted(set(self.days))
        days = {"day": tuple(map(order.index, self.days))} if len(order) > 1 else {}
        runs = {"run": tuple(range(len(self.lengths)))}
        return days if len(order) == len(self.lengths) > 1 else days | runs

    def group_names(self, by: str) -> list[str]:
        """Names of the groups, in their order; `by`: `day` or `run`."""
        return sorted(set(self.days)) if by == "day" else list(self.names)

    @property
    def in_ignored_wind(self) -> "RunSet | None":
        """The runs with their measured wind, where it was left out and every run has it."""
        winds = self.ignored[..., [SPEED, FROM]]
        return replace(self, weather=self.ignored) if winds.size and np.isfinite(winds).all() else None

    @property
    def wind(self) -> Wind:
        """Whether every run has its measured wind, and the diagnosis takes it."""
        if FIELDS[SPEED] in self.measured_fields:
            return "measured"
        return "ignored" if self.in_ignored_wind else "unknown"

    @property
    def measured_fields(self) -> frozenset[str]:
        """Fields of the boat's record that every run measures, so that no effect on them is a candidate."""
        if not len(self.weather):
            return frozenset()
        known: NDArray[np.bool_] = np.asarray(np.isfinite(self.weather).all(axis=(0, 1)))
        return frozenset(name for name, here in zip(FIELDS, known, strict=True) if here)


def read_run_set(
    folders: Path | str | Sequence[Path],
    boat: Boat,
    named: str | Path | None = None,
    ignore: Sequence[str] = (),
) -> RunSet:
    """One folder of measured runs, or several, on a uniform grid. Runs of several have the name of their
    dataset before their own, and the dataset is their group where `dataset.yaml` names none.

    named: the boat's name or file, for a folder without `dataset.yaml`; ignore: as `measured_weather` takes
    it. Missing rows are marked as gaps, not filled in. UserError for any other fault of a folder, and where
    the data are too few.
    """
    every = [Path(folders)] if isinstance(folders, Path | str) else list(folders)
    if len(every) == 1:
        return run_set_of(_sound_runs(every[0], named), boat, str(every[0]), ignore)
    refuse_mixed(every)
    named_folders = zip(dataset_names(every), every, strict=True)
    runs = [_of_dataset(run, name) for name, folder in named_folders for run in _sound_runs(folder, named)]
    return run_set_of(runs, boat, ", ".join(map(str, every)), ignore)


def _sound_runs(folder: Path, named: str | Path | None) -> list[Run]:
    """The runs of a dataset; UserError for its first fault but lost rows."""
    found = inspect_dataset(folder, named)
    refuse_faults(folder, [fault for fault in found.faults if fault.column != "time"])
    return found.runs


def _of_dataset(run: Run, dataset: str) -> Run:
    """A run under a name that no other dataset has, in the group of its dataset or a part of it."""
    group = dataset if run.meta.group is None else f"{dataset} {run.meta.group}"
    return replace(run, name=f"{dataset}_{run.name}", meta=run.meta.model_copy(update={"group": group}))


def run_set_of(every: list[Run], boat: Boat, folder: str, ignore: Sequence[str] = ()) -> RunSet:
    """Runs on a uniform grid; `folder` begins every message. UserError."""
    for run in every:
        refuse_disorder(run, folder)
    refuse_too_short(every, folder)
    runs = [run for run in every if run.duration >= options().shortest_run]
    for run in runs:
        refuse_other_boat(run, boat, folder)
    dt = float(np.median([sample_step(run) for run in runs]))
    refuse_too_coarse(dt, folder)
    for run in runs:
        refuse_jump(run, dt, folder)
    placed = [_on_grid(run, boat, dt, folder) for run in runs]
    weather = _weather_on_grid(runs, boat, dt, ignore)
    others = [name for name in ignore if name != "wind"]
    ignored = _weather_on_grid(runs, boat, dt, others) if "wind" in ignore else np.zeros((0, 0, 3))
    longest = max(len(commands) for commands, _, _ in placed)
    commands = np.zeros((len(runs), longest, placed[0][0].shape[1]))
    measured = np.full((len(runs), longest, len(CHANNELS)), np.nan)
    for index, (command, track, _) in enumerate(placed):
        commands[index, : len(command)] = command
        commands[index, len(command) :] = command[-1]
        measured[index, : len(track)] = track
    lengths = np.array([len(track) for _, track, _ in placed])
    gaps = _gaps([(filled, lost) for filled, _, lost in placed])
    names = tuple(run.name for run in runs)
    short = tuple(run.name for run in every if run.duration < options().shortest_run)
    grouped = any(run.meta.group for run in runs)
    days = tuple(run.meta.group or run.name for run in runs) if grouped else ()
    tracks = [track[:, :3] for _, track, _ in placed]
    refuse_unexciting([command for command, _, _ in placed], tracks, dt, boat, folder)
    sailed = names, commands, measured, lengths, gaps
    of_earth = tuple(velocities_of_earth(run) for run in runs)
    return RunSet(
        boat,
        dt,
        *sailed,
        too_short=short,
        weather=weather,
        ignored=ignored,
        days=days,
        of_earth=of_earth,
    )


def _on_grid(run: Run, boat: Boat, dt: float, folder: str) -> tuple[Array, Array, list[tuple[int, int]]]:
    place = (run.time - run.time[0]) / dt
    index = np.rint(place).astype(int)
    off = np.abs(place - index)
    crowded = np.diff(index, prepend=-1) <= 0
    if off.max() > options().grid_tolerance or crowded.any():
        row = int((crowded if crowded.any() else off).argmax()) + 1
        raise UserError(
            f"{folder}: run {run.name}, row {row}: time {run.time[row - 1]:.3f} s does not fit the sample "
            f"step of {dt:.4f} s; resample the run to a fixed rate (missing rows are fine)"
        )
    commands = run.commands(boat.thruster_names, fixed_thrusters(boat))
    track = np.full((index[-1] + 1, len(CHANNELS)), np.nan)
    for column, name in enumerate(CHANNELS):
        if name in run.columns:
            values = run.columns[name]
            track[index, column] = np.unwrap(values) if name == "heading" else values
    filled, lost = _filled(index, commands)
    return filled, track, lost


def _filled(index: NDArray[np.int64], commands: Array) -> tuple[Array, list[tuple[int, int]]]:
    """Commands (T, 2K) of every row, interpolated over missing rows, and (row, rows) of those. An azimuth
    that changes by more than a quarter turn is held, not interpolated.
    """
    rows = np.arange(index[-1] + 1)
    last = np.searchsorted(index, rows, side="right") - 1
    next_ = np.minimum(last + 1, len(index) - 1)
    share = (rows - index[last]) / np.maximum(index[next_] - index[last], 1)
    change = commands[next_] - commands[last]
    jumps = np.abs(change) > np.where(np.arange(change.shape[1]) < change.shape[1] // 2, np.pi / 2, np.inf)
    filled = commands[last] + np.where(jumps, 0.0, change * share[:, None])
    lost = np.flatnonzero(np.diff(index) > 1)
    return filled, [(int(index[i]) + 1, int(index[i + 1] - index[i]) - 1) for i in lost]


def _gaps(runs: list[tuple[Array, list[tuple[int, int]]]]) -> tuple[Gap, ...]:
    """Of the commands (T, 2K) and the lost rows of each run."""
    share_returned = cache(partial(_share_returned, [commands for commands, _ in runs]))

    def is_unknown(commands: Array, row: int, rows: int) -> bool:
        if _differ(commands[row - 1], commands[row + rows]):
            return True
        return rows > options().longest_gap and share_returned(rows) > options().returned_command

    return tuple(
        Gap(run, row, rows)
        for run, (commands, every) in enumerate(runs)
        for row, rows in every
        if is_unknown(commands, row, rows)
    )


def _share_returned(every: list[Array], rows: int) -> float:
    """Of the stretches of so many rows with the same command before and after them, the share in which the
    command changed; every: (T, 2K) of each run.
    """
    alike = returned = 0
    for commands in every:
        changes = np.concatenate([[0], np.cumsum(_differ(commands[:-1], commands[1:]))])
        same = ~_differ(commands[: -rows - 1], commands[rows + 1 :])
        alike += int(same.sum())
        returned += int((same & (changes[rows + 1 :] > changes[: -rows - 1])).sum())
    return returned / alike if alike else 0.0


def _differ(before: Array, after: Array) -> NDArray[np.bool_]:
    """Whether commands (..., 2K) differ by more than rounding."""
    return np.asarray((np.abs(after - before) > 1e-9).any(axis=-1))


def _weather_on_grid(runs: list[Run], boat: Boat, dt: float, ignore: Sequence[str]) -> Array:
    """(R or 0, T, 3) measured weather of every run, linear between the neighbours of a missing row."""
    every = [measured_weather(run, boat, ignore) for run in runs]
    if not any(len(weather) for weather in every):
        return np.zeros((0, 0, 3))
    places = [np.rint((run.time - run.time[0]) / dt) for run in runs]
    found = np.full((len(runs), int(max(place[-1] for place in places)) + 1, 3), np.nan)
    rows = np.arange(found.shape[1])
    for own, weather, place in zip(found, every, places, strict=True):
        if not len(weather):
            continue
        speed, angle = weather[:, SPEED], weather[:, FROM]
        north = np.interp(rows, place, speed * np.cos(angle))
        east = np.interp(rows, place, speed * np.sin(angle))
        own[:, SPEED], own[:, FROM] = np.hypot(north, east), np.arctan2(east, north)
        own[:, DEPTH] = np.interp(rows, place, weather[:, DEPTH])
    return found

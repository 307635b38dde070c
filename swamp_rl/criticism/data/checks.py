"""Checks of the data before a fit: those that no fit is possible to are refused."""

import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.clipped import clipped
from swamp_rl.criticism.options import options
from swamp_rl.errors import UserError
from swamp_rl.names import told_apart
from swamp_rl.runs import Run
from swamp_rl.runs.columns import command_columns, span_of
from swamp_rl.runs.dataset import META, boat_of, read_meta
from swamp_rl.runs.resample import MOST_BETWEEN

Array = NDArray[np.float64]


def refuse_disorder(run: Run, folder: str) -> None:
    """UserError for a run whose times are missing, not finite or not increasing."""
    if "time" not in run.columns:
        raise UserError(f"{folder}: run {run.name}: column time is missing; add it")
    bad = np.flatnonzero(~np.isfinite(run.time))
    if len(bad):
        raise UserError(f"{folder}: run {run.name}, row {bad[0] + 1}: time is not a number; correct it")
    back = np.flatnonzero(np.diff(run.time) <= 0.0)
    if len(back):
        row = int(back[0]) + 1
        raise UserError(
            f"{folder}: run {run.name}, row {row + 1}: time {run.time[row]:g} s does not come after "
            f"{run.time[row - 1]:g} s; put the rows in order of time, or cut the run in two there"
        )


def refuse_too_short(runs: list[Run], folder: str) -> None:
    """UserError where the usable runs are too short together."""
    total = sum(run.duration for run in runs if run.duration >= options().shortest_run)
    if total >= options().least_data:
        return
    longest, least = max((run.duration for run in runs), default=0.0), options()
    raise UserError(
        f"{folder}: too short: {total:.3g} s in runs of at least {least.shortest_run:.0f} s (the longest "
        f"lasts {longest:.3g} s); a fit needs {least.least_data:.0f} s or more, better five runs of a "
        "minute with turns both ways and several speeds; record more"
    )


def refuse_too_coarse(dt: float, folder: str) -> None:
    """UserError where the sample step dt [s] exceeds the shortest horizon."""
    if dt > options().step_slack * options().horizons[0]:
        raise UserError(
            f"{folder}: a sample every {dt:.3g} s; a fit needs one every {options().horizons[0]:g} s "
            "or more often (10 a second serve well); record at a higher rate"
        )


def refuse_jump(run: Run, dt: float, folder: str) -> None:
    """UserError for a run that lasts more than MOST_BETWEEN samples of dt [s] for each of its rows."""
    if run.duration / dt > MOST_BETWEEN * len(run.time):
        steps = np.diff(run.time)
        row = int(steps.argmax()) + 2
        raise UserError(
            f"{folder}: run {run.name}, row {row}: comes {steps.max():.3g} s after the row before, in a run "
            f"of {len(run.time)} rows {dt:.3g} s apart; correct the time, or cut the run in two there"
        )


def refuse_other_boat(run: Run, boat: Boat, folder: str) -> None:
    """UserError where a run's commands are not those of the boat file's thrusters."""
    commanded = command_columns(boat)
    missing = [column for column in commanded if column not in run.columns]
    if missing:
        other = [repr(name) for name in run.columns if span_of(name, None) is None]
        known = (
            f"if one of {', '.join(other)} is it, import with --column {missing[0]}=THEIRS; " if other else ""
        )
        raise UserError(
            f"{folder}: run {run.name}: column {missing[0]}, by which boat {boat.name} is commanded, is "
            f"missing; {known}{_advice(boat, folder)}, or record the column"
        )
    driven = [
        name
        for name, values in run.columns.items()
        if name.startswith(("throttle_", "propeller_"))
        and (np.abs(values) > options().running_throttle).any()
    ]
    unknown = [name for name in driven if name not in commanded]
    if unknown:
        raise UserError(
            f"{folder}: run {run.name}: column {unknown[0]} drives a thruster that boat {boat.name} does not "
            f"have (it has {', '.join(boat.thruster_names)}); {_advice(boat, folder)}, or add the "
            "thruster to its file"
        )


def _advice(boat: Boat, folder: str) -> str:
    """Which boat to give for runs that another one sailed, by name where their dataset names it."""
    with suppress(UserError, OSError):
        meta = read_meta(Path(folder))
        if boat_of(Path(folder), meta).name != boat.name:
            return (
                f"dataset.yaml names the vehicle {clipped(meta.vehicle)}: give that by --boat or leave it out"
            )
    return "give the boat of these runs by --boat"


def refuse_other_vehicle(dataset: Path, holdout: Path) -> None:
    """UserError where two datasets are the same, or of different boats."""
    if os.path.realpath(dataset) == os.path.realpath(holdout):
        raise UserError(
            f"{holdout}: is the dataset itself, nothing would be held out; leave --holdout out, runs of the "
            "dataset are then held out"
        )
    _refuse_another_boat(dataset, holdout, "hold out runs of the same boat")


def refuse_mixed(folders: Sequence[Path]) -> None:
    """UserError where a dataset is given twice, two are called alike, or they are of different boats."""
    names = dataset_names(folders)
    for number, folder in enumerate(folders):
        for earlier, name in zip(folders[:number], names, strict=False):
            if os.path.realpath(folder) == os.path.realpath(earlier):
                raise UserError(f"{folder}: is given twice; give every dataset once")
            if names[number] == name:
                raise UserError(f"{folder}: would be called {name} like {earlier}; rename one")
        _refuse_another_boat(folders[0], folder, "give the runs of one boat at a time")


def dataset_names(folders: Sequence[Path]) -> list[str]:
    """The name of each dataset's folder, with those of the folders around it where several are called so."""
    real = [Path(os.path.realpath(folder)) for folder in folders]
    parts = told_apart(real)
    return ["_".join(parts[folder]) for folder in real]


def _refuse_another_boat(dataset: Path, other: Path, advice: str) -> None:
    """UserError where two datasets name different boats."""
    if not all((folder / META).exists() for folder in (dataset, other)):
        return  # without metadata the boat is unknown
    ours, theirs = (boat_of(folder, read_meta(folder)).name for folder in (dataset, other))
    if ours != theirs:
        raise UserError(
            f"{other}: recorded with boat {theirs}, but {dataset} with {ours} (vehicle in dataset.yaml); "
            f"{advice}"
        )


def refuse_sources_inside(out: Path, sources: list[Path]) -> None:
    """UserError where the output folder contains an input."""
    for source in sources:
        if Path(os.path.realpath(source)).is_relative_to(os.path.realpath(out)):
            raise UserError(f"{out}: holds {source}, which the diagnosis is made from; name another --out")


def refuse_unexciting(commands: list[Array], tracks: list[Array], dt: float, boat: Boat, folder: str) -> None:
    """UserError naming the missing motion, if nothing was commanded, no position was measured or the boat
    never moved. Of each run the commands (T, 2K) and the measured track (T, 3), samples dt [s] apart.
    """
    thrusters = commands[0].shape[1] // 2
    if not any((np.abs(command[:, thrusters:]) > options().running_throttle).any() for command in commands):
        raise UserError(
            f"{folder}: no thruster ever runs; a drifting boat gives no information on thrust and steering: "
            "record runs under thrust, at two speeds and with turns to both sides"
        )
    reaches = [reach_of(track, dt) for track in tracks]
    travelled, turned = (max(reach[i] for reach in reaches) for i in (0, 1))
    if travelled < options().still_lengths * boat.length and turned < options().still_turn:
        raise UserError(
            f"{folder}: the boat moves {travelled:.2f} m and turns {np.degrees(turned):.0f} degrees at most; "
            "record runs ahead at two speeds and turns to both sides"
        )


def reach_of(track: Array, dt: float) -> tuple[float, float]:
    """Range of position [m] and heading [rad] of a track (T, 3), by means over `track_mean`."""
    rows = max(1, round(options().track_mean / dt))
    parts = [track[first : first + rows] for first in range(0, len(track), rows)]
    finite = [part[np.isfinite(part).all(axis=1)] for part in parts]
    means = [part.mean(axis=0) for part in finite if 2 * len(part) >= max(map(len, finite))]
    if not np.concatenate(finite).size:
        return 0.0, 0.0
    north, east, heading = np.ptp(np.array(means), axis=0)
    return float(np.hypot(north, east)), float(heading)

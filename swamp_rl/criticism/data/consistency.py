"""Consistency of the measured columns: swapped, mirrored, scaled or delayed ones are refused by name."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import turned
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.options import options
from swamp_rl.errors import UserError

Array = NDArray[np.float64]

NORTH, EAST, HEADING, SURGE, SWAY, YAW_RATE = range(6)


def refuse_inconsistent(run_set: RunSet, folder: str) -> None:
    """UserError naming the columns that contradict each other where another interpretation of them does
    not.

    Positions are compared with heading and velocities over ground, or with the heading alone, the heading
    with the yaw rate. Biases, delays and lever arms of a usual size are candidates of the diagnosis and pass.
    """
    measured = [run_set.measured[run, :length] for run, length in enumerate(run_set.lengths)]
    refuse_dead(measured, run_set.dt, run_set.boat.length, folder)
    if found := _over_ground(measured, run_set.dt, run_set.boat.length):
        with_velocities = {"surge", "sway"} <= set(run_set.present)
        (_positions_and_velocities if with_velocities else _courses_and_headings)(*found, folder)
    if "yaw_rate" in run_set.present:
        _heading_and_yaw_rate(measured, run_set.dt, folder)


def refuse_dead(measured: list[Array], dt: float, length: float, folder: str) -> None:
    """UserError for a sensor that is constant in every row while other sensors measure a motion."""

    def finite_rows(columns: list[int]) -> list[Array]:
        """Of each run, the rows (n, k) in which all of these columns are finite."""
        return [run[:, columns][np.isfinite(run[:, columns]).all(axis=1)] for run in measured]

    def dead(columns: list[int]) -> bool:
        rows = [run for run in finite_rows(columns) if len(run)]
        return bool(rows) and all((run == rows[0][0]).all() for run in rows)

    def furthest(columns: list[int]) -> float:
        return max(
            (float(np.ptp(run, axis=0).max()) for run in finite_rows(columns) if len(run)), default=0.0
        )

    turned = furthest([HEADING])
    swung = max(
        (float(np.ptp(np.cumsum(run) * dt)) for run in finite_rows([YAW_RATE]) if len(run)), default=0.0
    )
    went = furthest([NORTH, EAST])
    if dead([NORTH, EAST]):
        raise UserError(f"{folder}: north and east are the same in every row; record where the boat is")
    if dead([HEADING]) and swung > options().still_turn:
        raise UserError(f"{folder}: heading is the same in every row though yaw_rate is not 0; record it")
    for columns, stands, name in (
        ([YAW_RATE], turned > options().still_turn, "yaw_rate is"),
        ([SURGE, SWAY], went > options().moved_lengths * length, "surge and sway are"),
    ):
        if stands and dead(columns) and not any(run.any() for run in finite_rows(columns)):
            raise UserError(
                f"{folder}: {name} 0 in every row though the boat moves; leave out columns that were not "
                "measured"
            )


def _slope(values: Array, reach: int, dt: float) -> Array:
    """Rate of change (T - 2 reach, ...) by central differences over `reach` rows."""
    return np.asarray((values[2 * reach :] - values[: -2 * reach]) / (2 * reach * dt))


def explained(truth: Array, prediction: Array) -> float:
    """Share of the power of `truth` (n, k) that `prediction` (n, k) explains."""
    good = np.isfinite(truth).all(axis=-1) & np.isfinite(prediction).all(axis=-1)
    power = float((truth[good] ** 2).sum())
    return 1.0 - float(((truth[good] - prediction[good]) ** 2).sum()) / max(power, 1e-12)


def _over_ground(measured: list[Array], dt: float, length: float) -> tuple[Array, Array] | None:
    """Velocities over ground (n, 2) by the positions, and the rows (n, 6) that they are of, where runs are
    long enough."""
    scatter = np.nanmedian(np.abs(np.concatenate([np.diff(run[:, :2], 2, axis=0) for run in measured])))
    rough = scatter > options().rough_positions * length
    reach = max(1, round((options().slope_span_rough if rough else options().slope_span) / dt))
    long = [run for run in measured if len(run) > 4 * reach]
    if not long:
        return None
    moved = np.concatenate([_slope(run[:, :2], reach, dt) for run in long])
    return moved, np.concatenate([run[reach:-reach] for run in long])


def _positions_and_velocities(moved: Array, inner: Array, folder: str) -> None:
    psi, u, v = inner[:, HEADING], inner[:, SURGE], inner[:, SWAY]

    def over_ground(angle: Array, ahead: Array, starboard: Array) -> Array:
        return np.stack(turned(ahead, starboard, angle), axis=1)

    if explained(moved, over_ground(psi, u, v)) > options().reading_poor:
        return
    readings = {
        "north and east look swapped": over_ground(psi, u, v)[:, ::-1],
        "surge and sway look swapped": over_ground(psi, v, u),
        "heading looks anticlockwise": over_ground(-psi, u, v),
        "heading looks measured from east, anticlockwise": over_ground(math.pi / 2 - psi, u, v),
        "heading looks half a turn off": over_ground(psi + math.pi, u, v),
        "heading looks like degrees": over_ground(np.radians(psi), u, v),
        "sway looks positive to port": over_ground(psi, u, -v),
    }
    best = max(readings, key=lambda reading: explained(moved, readings[reading]))
    if explained(moved, readings[best]) > options().reading_good:
        raise UserError(
            f"{folder}: {best}: positions do not follow heading, surge and sway; correct the columns"
        )


def _courses_and_headings(moved: Array, inner: Array, folder: str) -> None:
    """Refuse headings whose mirror image the courses follow better than the headings, each turned by an
    angle: a compass may be off, and a boat may move sideways or drift.

    A share is what the velocities explain of themselves mirrored at the heading, 1 of motion along it; that
    of their squares as complex numbers, whose angle is twice that of the course.
    """
    seen = np.isfinite(moved).all(axis=1) & np.isfinite(inner[:, HEADING])
    velocity, psi = moved[seen] @ (1.0, 1.0j), inner[seen, HEADING]
    power = max(float(np.sum(np.abs(velocity) ** 2)), 1e-12)

    def along(heading: Array) -> complex:
        return complex(np.sum(velocity**2 * np.exp(-2.0j * heading)) / power)

    share, mirrored = (2.0 * abs(along(heading)) - 1.0 for heading in (psi, -psi))
    if share <= options().reading_poor < mirrored and mirrored - share > options().reading_good:
        reading = "heading looks anticlockwise"
        if along(-psi).real < 0.0:
            reading = "north and east look swapped, or the heading measured from east, anticlockwise"
        raise UserError(f"{folder}: {reading}: positions do not follow the heading; correct the columns")


def _heading_and_yaw_rate(measured: list[Array], dt: float, folder: str) -> None:
    reach = max(1, round(options().slope_span / dt))
    lag = round(options().longest_lag / dt)
    long = [run for run in measured if len(run) > 4 * (reach + lag)]
    if not long:
        return
    turned = [_slope(run[:, [HEADING]], reach, dt) for run in long]
    measured_rate = [run[reach:-reach, [YAW_RATE]] for run in long]
    every = np.concatenate(turned), np.concatenate(measured_rate)
    as_it_is = explained(*every)
    if as_it_is < options().reading_poor:
        readings = {"looks like degrees a second": math.pi / 180, "looks positive to port": -1.0}
        for reading, factor in readings.items():
            if explained(every[0], factor * every[1]) > options().reading_good:
                raise UserError(f"{folder}: yaw_rate {reading} against the heading; correct the column")
    shifts = [shift for shift in range(-lag, lag + 1) if abs(shift) * dt >= options().out_of_step]
    shares = [explained(*_shifted(turned, measured_rate, shift)) for shift in shifts]
    best = int(np.argmax(shares))
    left = options().lag_improvement * (1.0 - as_it_is)
    if shares[best] > options().reading_good and 1.0 - shares[best] < left:
        raise UserError(
            f"{folder}: yaw_rate is {abs(shifts[best]) * dt:.1f} s {'late' if shifts[best] > 0 else 'early'} "
            f"against heading; bring the columns ({', '.join(CHANNELS)}) to one clock"
        )


def _shifted(turned: list[Array], measured_rate: list[Array], shift: int) -> tuple[Array, Array]:
    """Both series, the second `shift` rows later."""
    first = [one[max(0, -shift) : len(one) - max(0, shift)] for one in turned]
    second = [one[max(0, shift) : len(one) - max(0, -shift)] for one in measured_rate]
    return np.concatenate(first), np.concatenate(second)

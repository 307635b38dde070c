"""Turning circles of the model ship on the pond: as measured, and as predicted from their first state."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.turning import Turn, turn_of
from benchmarks.esso_osaka.windows import predicted
from swamp_rl.boat import Boat
from swamp_rl.runs import Run

Array = NDArray[np.float64]
Steady = tuple[float, float, float]  # speed [m/s], drift angle [deg], yaw rate [deg/s]

RUDDER_OVER = np.radians(15.0)  # what counts as the turn, apart from steering before and after


def turn_rows(run: Run) -> tuple[int, int]:
    """First and last row of the longest stretch with the rudder over."""
    over = np.abs(run.columns["rudder_main"]) > RUDDER_OVER
    edges = np.flatnonzero(np.diff(np.concatenate([[0], over.astype(int), [0]])))
    first, last = edges[::2], edges[1::2] - 1
    longest = int(np.argmax(last - first))
    return int(first[longest]), int(last[longest])


def measured_turn(run: Run) -> Array:
    """(T, 3) poses of the run's turn, the heading without jumps."""
    first, last = turn_rows(run)
    pose = run.pose
    pose[:, 2] = np.unwrap(pose[:, 2])
    return pose[first : last + 1]


def predicted_turn(boat: Boat, run: Run, wind: bool = True) -> Array:
    """The track of the run's turn as predicted from its first state, with the measured wind or without."""
    first, last = turn_rows(run)
    return predicted(boat, run, np.array([first]), last - first, wind)[0]


def circle(boat: Boat, run: Run) -> tuple[Turn, Turn, Turn]:
    """The run's turn as measured, as predicted with the measured wind, and as predicted without wind."""
    windy, calm = (predicted_turn(boat, run, wind) for wind in (True, False))
    return turn_of(measured_turn(run)), turn_of(windy), turn_of(calm)


def steady(pose: Array, dt: float) -> Steady:
    """Mean speed [m/s], drift angle [deg] and yaw rate [deg/s] of poses (T, 3) by their differences.

    Over whole turns, so that a steady wind does not show.
    """
    turned = np.abs(pose[:, 2] - pose[0, 2])
    turns = turned[-1] // (2.0 * np.pi)
    if turns > 0:
        pose = pose[: int(np.argmax(turned >= 2.0 * np.pi * turns))]
    rate = np.diff(pose, axis=0) / dt
    cos, sin = np.cos(pose[:-1, 2]), np.sin(pose[:-1, 2])
    surge = float(np.mean(rate[:, 0] * cos + rate[:, 1] * sin))
    sway = float(np.mean(rate[:, 1] * cos - rate[:, 0] * sin))
    drift, yaw_rate = np.degrees(np.arctan2(abs(sway), surge)), np.degrees(np.mean(rate[:, 2]))
    return float(np.hypot(surge, sway)), float(drift), abs(float(yaw_rate))


def circle_table(boat: Boat, runs: Sequence[Run]) -> str:
    """Advance and tactical diameter, measured and predicted."""
    rows = []
    for run in runs:
        first, _ = turn_rows(run)
        rudder = np.degrees(run.columns["rudder_main"][first + 20])
        turns = circle(boat, run)
        cells = [f"{turn.advance:.1f} / {turn.tactical_diameter:.1f}" for turn in turns]
        rows.append([run.name, f"{rudder:+.0f}", f"{run.columns['propeller_main'][first]:.0f}", *cells])
    return table(["run", "rudder, deg", "rps", "measured, m", "with its wind, m", "no wind, m"], rows)


def after_a_minute(turn: Array) -> Steady:
    """The steady figures of a turn's track after its first minute."""
    return steady(turn[600:], 0.1)


def steady_figures(boat: Boat, other: Boat, runs: Sequence[Run]) -> list[tuple[Steady, Steady, Steady]]:
    """Each turn after its first minute: as measured, of the boat and of the other one."""
    return [
        (
            after_a_minute(measured_turn(run)),
            after_a_minute(predicted_turn(boat, run)),
            after_a_minute(predicted_turn(other, run)),
        )
        for run in runs
    ]


def steady_table(boat: Boat, other: Boat, runs: Sequence[Run]) -> str:
    """Mean speed, drift angle and yaw rate in the turn after its first minute."""
    rows = [
        [run.name, *(f"{u:.2f}, {drift:.0f}, {yaw:.2f}" for u, drift, yaw in figures)]
        for run, figures in zip(runs, steady_figures(boat, other, runs), strict=True)
    ]
    heading = ["run", "measured: m/s, drift deg, deg/s", "boat file", "boat file with C_rY = 1"]
    return table(heading, rows)

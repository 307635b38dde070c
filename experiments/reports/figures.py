"""The pictures of a report, drawn without a screen: east to the right, north up, axes equal."""

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from swamp_rl.course import Course
from swamp_rl.demo.colours import driver_colours, fractions
from swamp_rl.figure_style import sheet
from swamp_rl.runs import Run

GATE_COLOURS = {"green": "#2ca02c", "red": "#d62728"}
OTHER_GATE = "#ff7f0e"
SEEN, ARROW = 0.0875, 0.275
"""Smallest radius of a drawn buoy and half the length of a gate's arrow, in widths of the gate."""
DRIVEN, FAILED = "#1f77b4", "#b0413e"

Panel = tuple[str, Sequence[Run]]
"""A title and the runs drawn beneath it."""


def draw_course(axes: Any, course: Course) -> None:
    """Gates, buoys to scale but never too small to see, and the start; axes [m] to the course's bounds."""
    from matplotlib.patches import Circle

    for gate in course.gates:
        colour = GATE_COLOURS.get(gate.name, OTHER_GATE)
        port, starboard = gate.buoys
        axes.plot(
            [port.east, starboard.east], [port.north, starboard.north], ":", color=colour, lw=1.2, zorder=3
        )
        for buoy in gate.buoys:
            radius = max(course.buoy_radius, SEEN * gate.width)
            axes.add_patch(Circle((buoy.east, buoy.north), radius, color=colour, zorder=4))
        arrow = ARROW * gate.width
        ahead = (arrow * math.sin(gate.heading), arrow * math.cos(gate.heading))
        axes.annotate(
            "",
            xy=(gate.centre.east + ahead[0], gate.centre.north + ahead[1]),
            xytext=(gate.centre.east - ahead[0], gate.centre.north - ahead[1]),
            arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.2},
            zorder=4,
        )
    axes.plot(course.start.pose.east, course.start.pose.north, "k+", ms=8, mew=1.5, zorder=5)
    bounds = course.bounds
    axes.set(xlim=(bounds.west, bounds.east), ylim=(bounds.south, bounds.north), aspect="equal")


def tracks(
    path: Path,
    course: Course,
    rows: Sequence[Sequence[Panel]],
    title: str,
    drivers: Sequence[str] | None = None,
) -> None:
    """PNG of a grid of charts: successful runs in the colour of the row's driver, failed ones dashed red."""
    shades = driver_colours(drivers or ())
    with sheet(path, 3.0 * len(rows[0]), 3.2 * len(rows) + 0.9) as figure:
        grid = figure.subplots(len(rows), len(rows[0]), squeeze=False, sharex=True, sharey=True)
        for i, row in enumerate(rows):
            for j, (label, runs) in enumerate(row):
                axes = grid[i][j]
                _draw_tracks(axes, runs, fractions(shades[drivers[i]]) if drivers else DRIVEN)
                draw_course(axes, course)
                axes.set_title(label)
                if i == len(rows) - 1:
                    axes.set_xlabel("east [m]")
                if j == 0:
                    axes.set_ylabel("north [m]")
        _track_legend(figure, "#555555" if drivers else DRIVEN)
        figure.suptitle(title, fontsize=11, fontweight="bold")


def commands(path: Path, runs: Mapping[str, Run], title: str) -> None:
    """PNG of the commands over time: one row for each pilot, throttle to the left, angle to the right."""
    arrived = [run for run in runs.values() if run.meta.outcome == "success"]
    shades = driver_colours(runs)
    end = max(run.duration for run in arrived or runs.values())
    with sheet(path, 9.0, 1.45 * len(runs) + 1.0) as figure:
        grid = figure.subplots(len(runs), 2, squeeze=False, sharex=True)
        for i, (name, run) in enumerate(runs.items()):
            colour = fractions(shades[name])
            for axes, column, ends in zip(
                grid[i], ("joy_thrust", "joy_angle"), ((0, 1), (-1, 1)), strict=True
            ):
                axes.plot(run.time - run.time[0], run.columns[column], color=colour, lw=1.3)
                axes.set(ylim=(ends[0] - 0.08, ends[1] + 0.08), yticks=[ends[0], sum(ends) / 2, ends[1]])
                axes.set_xlim(0.0, end)
            grid[i][0].set_ylabel(name, fontweight="bold")
        grid[0][0].set_title("throttle lever [1]")
        grid[0][1].set_title("angle lever [1], −1 is full to port")
        for axes in grid[-1]:
            axes.set_xlabel("time [s]")
        figure.suptitle(title, fontsize=11, fontweight="bold")


def success_rates(
    path: Path,
    rates: Mapping[str, Mapping[str, Mapping[str, Any]]],
    targets: Mapping[str, Mapping[str, float]],
    title: str,
) -> None:
    """PNG of success rates with their intervals: `rates[pilot][level]` is a `summary` of episodes.

    targets: the rates that were to be reached, likewise, where there are any.
    """
    levels, shades = list(next(iter(rates.values()))), driver_colours(rates)
    with sheet(path, 8.0, 3.4) as figure:
        axes = figure.subplots()
        for i, (pilot, by_level) in enumerate(rates.items()):
            shift = (i - (len(rates) - 1) / 2) * 0.12
            at = [j + shift for j in range(len(levels))]
            value = [100 * by_level[level]["success_rate"] for level in levels]
            ends = [[100 * end for end in by_level[level]["wilson_95"]] for level in levels]
            error = [
                [v - low for v, (low, _) in zip(value, ends, strict=True)],
                [high - v for v, (_, high) in zip(value, ends, strict=True)],
            ]
            if targets:
                asked, label = targets.get(pilot, {}), "_" if i else "target"
                marks = [100 * asked.get(level, math.nan) for level in levels]
                axes.plot(at, marks, "_", color="#222222", ms=13, mew=1.2, label=label, zorder=1)
            shade = fractions(shades[pilot])
            axes.errorbar(at, value, yerr=error, fmt="o", ms=5, capsize=3, lw=1.4, label=pilot, color=shade)
        axes.set(xticks=range(len(levels)), ylabel="success [%]", ylim=(-4, 104))
        axes.set_xticklabels(levels)
        axes.grid(axis="x", visible=False)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        figure.suptitle(title, fontsize=11, fontweight="bold")


def _draw_tracks(axes: Any, runs: Iterable[Run], colour: Any) -> None:
    runs = list(runs)
    alpha = 0.75 if len(runs) <= 12 else 0.4
    for run in runs:
        good = run.meta.outcome == "success"
        axes.plot(
            run.columns["east"],
            run.columns["north"],
            color=colour if good else FAILED,
            ls="-" if good else (0, (4, 2)),
            lw=0.9,
            alpha=alpha,
            zorder=2,
        )


def _track_legend(figure: Any, colour: str) -> None:
    from matplotlib.lines import Line2D

    figure.legend(
        handles=[
            Line2D([], [], color=colour, label="successful"),
            Line2D([], [], color=FAILED, ls="--", label="failed"),
            Line2D([], [], color="k", marker="+", ls="", ms=8, label="start"),
        ],
        loc="outside lower center",
        ncols=3,
    )

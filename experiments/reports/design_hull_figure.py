"""The picture of a designed hull: its lines, hydrostatic curves and righting levers."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.transforms import offset_copy

from swamp_rl.design.hull_lines import HullDesign, half_breadth
from swamp_rl.design.hydrostatics import Hydrostatics
from swamp_rl.design.stability import CRITERIA, Stability
from swamp_rl.figure_style import sheet

DARK, WATER, WARM, GREY = "#40514e", "#11698e", "#c1502e", "#8a9694"
SHADES = (WATER, WARM, DARK, "#7a5195", "#bc8f00")
STATIONS, WATERLINES = 8, 5
SLENDER = 12.0  # length over breadth of a demihull, beyond which more than two ticks abeam overlap
BELOW_LABEL = -34.0  # points from the axis, beneath its ticks and label, however flat the hull


def draw_hull(
    path: Path, hull: HullDesign, over_draught: Sequence[Hydrostatics], conditions: Sequence[Stability]
) -> None:
    """Write the PNG."""
    with sheet(path, 11.5, 7.5) as canvas:
        grid = canvas.add_gridspec(2, 6)
        body_plan(canvas.add_subplot(grid[0, :2]), hull, conditions)
        waterlines(canvas.add_subplot(grid[0, 2:]), hull)
        displacement(canvas.add_subplot(grid[1, :2]), over_draught, conditions)
        metacentres(canvas.add_subplot(grid[1, 2:4]), over_draught, conditions)
        levers(canvas.add_subplot(grid[1, 4:]), conditions)
        title = f"{hull.name}: {hull.length:g} m x {hull.overall_breadth:g} m, {hull.demihulls} hulls"
        canvas.suptitle(title, fontweight="bold")


def body_plan(axes: Any, hull: HullDesign, conditions: Sequence[Stability]) -> None:
    """Sections of a demihull from midship to the end; it is alike fore and aft."""
    height = np.linspace(0.0, hull.depth, 200)
    at = stations(hull)
    for x in at:
        wide = 1e3 * half_breadth(hull, x, height)
        for side in (-1.0, 1.0):
            axes.plot(side * wide, 1e3 * height, color=DARK, lw=1.0)
            axes.plot([0.0, side * wide[0]], [0.0, 0.0], color=DARK, lw=1.0)
    for one, colour in zip(conditions, shades(conditions), strict=True):
        axes.axhline(
            1e3 * one.upright.draught, color=colour, lw=1.0, ls="--", label=one.name.replace("_", " ")
        )
    axes.axhline(1e3 * hull.freeboard_line, color=GREY, lw=0.8, ls=":", label="freeboard line")
    axes.set(title="Sections of a demihull", xlabel="half breadth [mm]", ylabel="height [mm]")
    axes.set_aspect("equal")
    axes.set_ylim(top=1.38e3 * hull.depth)
    axes.legend(loc="upper center", fontsize=7)


def stations(hull: HullDesign) -> np.ndarray:
    """Midship, and stations [m] of an end."""
    a, end = hull.middle_half_length, 0.5 * hull.length
    return np.concatenate([[0.0], np.linspace(a, end, STATIONS, endpoint=False)[1:]])


def waterlines(axes: Any, hull: HullDesign) -> None:
    """Waterlines of a demihull at heights from the bottom to the freeboard line."""
    x = np.linspace(-0.5 * hull.length, 0.5 * hull.length, 401)
    heights = np.linspace(0.0, hull.freeboard_line, WATERLINES)
    for share, height in zip(np.linspace(0.25, 1.0, WATERLINES), heights, strict=True):
        wide = 1e3 * half_breadth(hull, x, height)
        axes.plot(1e3 * x, wide, color=DARK, alpha=share, lw=1.2, label=f"{1e3 * height:.0f}")
        axes.plot(1e3 * x, -wide, color=DARK, alpha=share, lw=1.2)
    for x_station in stations(hull):
        for side in {x_station, -x_station}:
            axes.axvline(1e3 * side, color=GREY, lw=0.6, ls=":")
    axes.set(title="Waterlines of a demihull", xlabel="forward of midship [mm]", ylabel="half breadth [mm]")
    axes.set_aspect("equal")
    if hull.length > SLENDER * hull.breadth:
        axes.set_yticks([-500.0 * hull.breadth, 500.0 * hull.breadth])
    below = offset_copy(axes.transAxes, axes.figure, y=BELOW_LABEL, units="points")
    axes.legend(
        title="height [mm]", loc="upper center", bbox_to_anchor=(0.5, 0.0), bbox_transform=below,
        ncols=WATERLINES, fontsize=8, title_fontsize=8,
    )  # fmt: skip


def displacement(axes: Any, over: Sequence[Hydrostatics], conditions: Sequence[Stability]) -> None:
    """Mass and areas over the draught; each area has the axis above."""
    draught = [1e3 * one.draught for one in over]
    axes.plot([one.mass for one in over], draught, color=DARK)
    area = axes.twiny()
    area.spines["top"].set_visible(True)
    area.grid(False)
    area.plot([one.wetted_area for one in over], draught, color=WARM, label="wetted")
    area.plot([one.waterplane_area for one in over], draught, color=WARM, ls="--", label="waterplane")
    for one, colour in zip(conditions, shades(conditions), strict=True):
        axes.plot(one.upright.mass, 1e3 * one.upright.draught, "o", color=colour, ms=5)
    axes.set(ylabel="draught [mm]", ylim=(0.0, draught[-1]))
    axes.set_xlabel("mass [kg]", color=DARK)
    area.set_xlabel("area [m²]", color=WARM)
    axes.set_xlim(left=0.0)
    area.set_xlim(left=0.0)
    area.legend(loc="lower right", fontsize=8)


def metacentres(axes: Any, over: Sequence[Hydrostatics], conditions: Sequence[Stability]) -> None:
    """Centre of buoyancy and metacentres over the draught, with the centres of gravity of the conditions."""
    draught = [1e3 * one.draught for one in over]
    for key, label, colour, style in (
        ("buoyancy_height", "KB", WATER, "-"),
        ("metacentre_transverse", "KM_T", DARK, "-"),
        ("metacentre_longitudinal", "KM_L", DARK, "--"),
    ):
        axes.plot([getattr(one, key) for one in over], draught, color=colour, ls=style, label=label)
    for one, colour in zip(conditions, shades(conditions), strict=True):
        label = f"VCG, {one.name.replace('_', ' ')}"
        axes.plot(one.centre_of_gravity, 1e3 * one.upright.draught, "D", color=colour, ms=4, label=label)
    most = 1.4 * max(one.upright.metacentre_transverse for one in conditions)
    axes.set(xlabel="above the bottom [m]", ylabel="draught [mm]", xlim=(0.0, most), ylim=(0.0, draught[-1]))
    axes.set_title("Metacentres")
    axes.legend(loc="upper right", fontsize=8)


def levers(axes: Any, conditions: Sequence[Stability]) -> None:
    """GZ over the heel, each greatest one marked, and the least that the criteria ask for."""
    for one, colour in zip(conditions, shades(conditions), strict=True):
        heel = np.degrees(one.heel)
        label = f"{one.name.replace('_', ' ')}, {one.upright.mass:.0f} kg"
        axes.plot(heel, one.lever, color=colour, label=label)
        axes.plot(math.degrees(one.angle_of_greatest), one.greatest_lever, "o", color=colour, ms=4)
    axes.axhline(CRITERIA["greatest_lever"], color=GREY, lw=0.8, ls="--", label="least greatest GZ")
    axes.axhline(0.0, color="#888888", lw=0.8)
    axes.set(title="Righting lever", xlabel="heel [deg]", ylabel="GZ [m]", xlim=(0.0, heel[-1]))
    axes.legend(loc="best", fontsize=8)


def shades(conditions: Sequence[Stability]) -> list[str]:
    """A colour for each condition."""
    return [SHADES[i % len(SHADES)] for i in range(len(conditions))]

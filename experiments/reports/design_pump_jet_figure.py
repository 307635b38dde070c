"""The picture of a designed pump-jet: velocity triangles, impeller sections, thrust and power."""

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.design.pump_jet import PumpJet, running_at
from swamp_rl.design.velocity_triangles import MeanLine, Triangle, mean_line
from swamp_rl.figure_style import sheet

BLADE, WATER, RELATIVE, FAINT = "#40514e", "#11698e", "#c1502e", "#b8c4c2"
Vector = NDArray[np.float64]


def draw_pump_jet(path: Path, jet: PumpJet) -> None:
    """Write the PNG."""
    with sheet(path, 11.5, 7.0) as canvas:
        grid = canvas.add_gridspec(2, 3, width_ratios=(1.15, 1.2, 1.0))
        widest = max(triangle.blade for triangle in (*jet.inlet, *jet.outlet))
        for row, (name, three) in enumerate((("Inlet", jet.inlet), ("Outlet", jet.outlet))):
            triangles(canvas.add_subplot(grid[row, 0]), name, three, widest)
        lines = mean_lines(jet)
        plan(canvas.add_subplot(grid[0, 1]), jet, lines)
        meridian(canvas.add_subplot(grid[1, 1]), lines)
        vane_angles(canvas.add_subplot(grid[0, 2]), lines)
        curves(canvas.add_subplot(grid[1, 2]), jet)
        label = f"{jet.design.thrust:g} N at {60 * jet.design.revolutions:.4g} rpm"
        canvas.suptitle(f"{jet.design.name}: {label}, {jet.design.blades} vanes", fontweight="bold")


def triangles(axes: Any, name: str, three: tuple[Triangle, ...], widest: float) -> None:
    """u, c and w of the mean streamline as arrows, those of tip and root faint behind."""
    for triangle in three:
        mean = triangle.streamline == "mean"
        if not mean:
            corner = (triangle.whirl, triangle.meridian)
            xs, ys = (0.0, corner[0], triangle.blade, 0.0), (0.0, corner[1], 0.0, 0.0)
            axes.plot(xs, ys, color=FAINT, lw=1.0, ls="--" if triangle.streamline == "tip" else ":")
            axes.annotate(
                triangle.streamline, (triangle.blade, 0.0), (0, -11), textcoords="offset points", ha="center",
                fontsize=7, color="#7d8a88",
            )  # fmt: skip
            continue
        corner = (triangle.whirl, triangle.meridian)
        degrees = math.degrees(triangle.angle)
        arrow(axes, (0.0, 0.0), (triangle.blade, 0.0), BLADE, f"u = {triangle.blade:.2f}")
        arrow(axes, (0.0, 0.0), corner, WATER, f"c = {triangle.absolute:.2f}")
        arrow(axes, (triangle.blade, 0.0), corner, RELATIVE, f"w = {triangle.relative:.2f}, β {degrees:.1f}°")
        arc(axes, triangle)
    axes.set(
        title=f"{name}, mean streamline [m/s]; tip dashed, root dotted",
        xlim=(-0.06 * widest, 1.08 * widest),
        xlabel="tangential [m/s]",
        ylabel="meridian [m/s]",
    )
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper right", fontsize=8, handlelength=1.2)


def arrow(axes: Any, start: tuple[float, float], end: tuple[float, float], colour: str, label: str) -> None:
    """An arrow, and its entry in the legend."""
    axes.annotate(
        "",
        end,
        start,
        arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.8, "shrinkA": 0, "shrinkB": 0},
    )
    axes.plot([], [], color=colour, lw=1.8, label=label)


def arc(axes: Any, triangle: Triangle) -> None:
    """The angle β between w and the vane's speed."""
    radius = 0.4 * triangle.relative
    turned = np.linspace(math.pi - triangle.angle, math.pi, 30)
    axes.plot(triangle.blade + radius * np.cos(turned), radius * np.sin(turned), color=RELATIVE, lw=1.0)
    half = math.pi - 0.5 * triangle.angle
    at = triangle.blade + 1.25 * radius * math.cos(half), 1.25 * radius * math.sin(half)
    axes.annotate("β", at, color=RELATIVE, ha="right", va="center")


def mean_lines(jet: PumpJet) -> dict[str, MeanLine]:
    """The vane's mean line of each streamline.

    The outlet edge is a straight line of the outlet's height, from the tip to the root at the impeller's
    height.
    """
    shape = jet.geometry
    slant = 0.5 * (shape.outlet[2] - shape.outlet[0])
    rise = math.sqrt(max(shape.outlet_height**2 - slant**2, 0.0))
    ends = shape.impeller_height - rise, shape.impeller_height - 0.5 * rise, shape.impeller_height
    pairs = zip(jet.inlet, jet.outlet, ends, strict=True)
    return {one.streamline: mean_line(one, other, (0.0, end)) for one, other, end in pairs}


def plan(axes: Any, jet: PumpJet, lines: dict[str, MeanLine]) -> None:
    """Vanes from above, the impeller turning anticlockwise: surface from tip to root, mean section dark."""
    for blade in range(jet.design.blades):
        turned = 2.0 * math.pi * blade / jet.design.blades
        tip, root = (places(lines[name], turned) for name in ("tip", "root"))
        surface = np.concatenate([tip, root[::-1]])
        axes.fill(*(1e3 * surface.T), color="#cfdbd8", ec="none", alpha=0.45)
    for blade in range(jet.design.blades):
        turned = 2.0 * math.pi * blade / jet.design.blades
        axes.fill(*(1e3 * outlined(places(lines["mean"], turned), jet.design.blade_thickness).T), color=BLADE)
    for diameter in (jet.geometry.inlet[1], jet.geometry.outlet[1]):
        around = np.linspace(0.0, 2.0 * math.pi, 200)
        axes.plot(500 * diameter * np.cos(around), 500 * diameter * np.sin(around), color=WATER, lw=0.7)
    axes.set(title="Impeller from above, mean section dark", xlabel="mm")
    axes.set_aspect("equal")


def places(line: MeanLine, turned: float) -> Vector:
    """Points [m] of a mean line from above, swept back against the turning; (points, 2)."""
    at = turned - line.angle
    return np.column_stack([line.radius * np.cos(at), line.radius * np.sin(at)])


def outlined(line: Vector, thickness: float) -> Vector:
    """The outline [m] of a vane of constant thickness about a line; (points, 2)."""
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    aside = 0.5 * thickness * np.column_stack([-along[:, 1], along[:, 0]])
    return np.concatenate([line + aside, (line - aside)[::-1]])


def meridian(axes: Any, lines: dict[str, MeanLine]) -> None:
    """The section through the axis: streamlines from the inlet's edge to the outlet's."""
    styles = {"tip": "--", "mean": "-", "root": ":"}
    for side in (-1.0, 1.0):
        ends = [(side * 1e3 * line.radius, 1e3 * line.height) for line in lines.values()]
        outline = np.concatenate([np.column_stack(ends[0]), np.column_stack(ends[2])[::-1]])
        axes.fill(*outline.T, color="#dfe7e5", ec="none")
        for name, (r, z) in zip(lines, ends, strict=True):
            label = name if side > 0 else None
            axes.plot(r, z, color=BLADE, lw=1.2, ls=styles[name], label=label)
        for edge in (0, -1):
            axes.plot([r[edge] for r, _ in ends], [z[edge] for _, z in ends], color=WATER, lw=1.2)
    axes.axvline(0.0, color="#888888", lw=0.8, ls="-.")
    axes.set(title="Section through the axis", xlabel="radius [mm]", ylabel="height [mm]")
    axes.set_aspect("equal")
    axes.margins(y=0.25)
    axes.legend(loc="upper center", ncols=3, fontsize=8)


def vane_angles(axes: Any, lines: dict[str, MeanLine]) -> None:
    """β along each streamline."""
    styles = {"tip": "--", "mean": "-", "root": ":"}
    for name, line in lines.items():
        label = f"{name}, wrap {math.degrees(line.wrap):.0f}°"
        share = line.length / line.length[-1]
        axes.plot(100.0 * share, np.degrees(line.vane), color=BLADE, ls=styles[name], label=label)
    axes.set(title="Vane angle β", xlabel="along the meridian [%]", ylabel="β [deg]")
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="best", fontsize=8)


def curves(axes: Any, jet: PumpJet) -> None:
    """Thrust at rest and electric power over the throttle."""
    at = np.linspace(0.0, 1.0, 101)
    run = [running_at(jet, float(throttle)) for throttle in at]
    power = axes.twinx()
    power.spines["right"].set_visible(True)
    power.grid(False)
    axes.plot(100.0 * at, [one.thrust for one in run], color=WATER)
    power.plot(100.0 * at, [one.electric_power for one in run], color=RELATIVE)
    axes.set(title="At rest", xlabel="throttle [%]", xlim=(0.0, 100.0))
    axes.set_ylabel("thrust [N]", color=WATER)
    power.set_ylabel("electric power [W]", color=RELATIVE)
    for one in (axes, power):
        one.set_ylim(bottom=0.0)

"""The pictures of captive trials: pull against throttle at rest, towing force and 1 - t under way."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from swamp_rl.experiments.reports.trial_figures import colours

from swamp_rl.figure_style import sheet
from swamp_rl.manoeuvres.captive import Point

MARKS = "osD^v<>ph*"


def draw_bollard(path: Path, boat: str, points: Sequence[Point]) -> None:
    """Write a PNG of the pull against the throttle, a curve for each set; dashed the own thrust of it."""
    with sheet(path, 6.4, 4.4) as canvas:
        axes = canvas.subplots()
        sets = list(dict.fromkeys(point.thrusters for point in points))
        shades = colours([float(i) for i in range(len(sets))])
        for i, names in enumerate(sets):
            some = sorted((p for p in points if p.thrusters == names), key=lambda p: p.throttle)
            at = [100.0 * point.throttle for point in some]
            mark, colour = MARKS[i % len(MARKS)], shades[float(i)]
            label = f"{len(names)}: {', '.join(names)}"
            axes.plot(at, [p.thrust for p in some], f"{mark}-", color=colour, ms=4, lw=1.3, label=label)
            axes.plot(at, [p.bollard_thrust for p in some], "--", color="#bbbbbb", lw=1.0)
        axes.plot([], [], "--", color="#bbbbbb", lw=1.0, label="own thrust, without deduction")
        axes.set(xlabel="throttle [%]", ylabel="pull [N]")
        _from_zero(axes)
        axes.legend(loc="upper left")
        canvas.suptitle(f"Bollard pull of {boat}", fontweight="bold")


def draw_towed(path: Path, boat: str, points: Sequence[Point]) -> None:
    """Write a PNG of the towing force and of 1 - t against the throttle, a curve for each set and speed."""
    with sheet(path, 9.0, 4.4) as canvas:
        force, factor = canvas.subplots(1, 2)
        shades = colours([point.speed for point in points])
        sets = list(dict.fromkeys(point.thrusters for point in points))
        for i, names in enumerate(sets):
            for speed, colour in shades.items():
                some = [p for p in points if (p.thrusters, p.speed) == (names, speed)]
                some.sort(key=lambda p: p.throttle)
                at = [100.0 * point.throttle for point in some]
                style: dict[str, Any] = {"color": colour, "ms": 4, "lw": 1.2}
                line, label = f"{MARKS[i % len(MARKS)]}-", f"{', '.join(names)} at {speed:g} m/s"
                force.plot(at, [p.towing_force for p in some], line, label=label, **style)
                factor.plot(at, [p.thrust_factor for p in some], line, **style)
        force.axhline(0.0, color="#888888", lw=0.8)
        force.set(xlabel="throttle [%]", ylabel="towing force F_D [N]", title="below 0: self-propelled")
        factor.set(xlabel="throttle [%]", ylabel="1 - t [1]", title="(R - F_D) / T_bollard, eq. 7.1")
        _from_zero(factor)
        handles, labels = force.get_legend_handles_labels()
        canvas.legend(handles, labels, loc="outside lower center", ncols=3)
        canvas.suptitle(f"Towed trial of {boat}", fontweight="bold")


def _from_zero(axes: Any) -> None:
    """Let the vertical axis begin at 0, where nothing lies below it."""
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0.0) if low < -0.05 * high else 0.0, high)

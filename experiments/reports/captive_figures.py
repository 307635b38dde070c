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
    """Write a PNG of the towing force and of 1 - t against the throttle, a curve for each set and speed; of
    one throttle against the speed, a curve for each set.
    """
    over_speed = len({point.throttle for point in points}) == 1 < len({point.speed for point in points})
    with sheet(path, 9.0, 4.4) as canvas:
        force, factor = canvas.subplots(1, 2)
        shades = colours([_other(point, over_speed) for point in points])
        sets = list(dict.fromkeys(point.thrusters for point in points))
        for i, names in enumerate(sets):
            for held, colour in shades.items():
                some = [p for p in points if (p.thrusters, _other(p, over_speed)) == (names, held)]
                some.sort(key=lambda p: _along(p, over_speed))
                at = [_along(point, over_speed) for point in some]
                style: dict[str, Any] = {"color": colour, "ms": 4, "lw": 1.2}
                line = f"{MARKS[i % len(MARKS)]}-"
                label = f"{', '.join(names)} at " + (f"{held:g} %" if over_speed else f"{held:g} m/s")
                force.plot(at, [p.towing_force for p in some], line, label=label, **style)
                factor.plot(at, [p.thrust_factor for p in some], line, **style)
        force.axhline(0.0, color="#888888", lw=0.8)
        xlabel = "speed [m/s]" if over_speed else "throttle [%]"
        force.set(xlabel=xlabel, ylabel="towing force F_D [N]", title="below 0: self-propelled")
        factor.set(xlabel=xlabel, ylabel="1 - t [1]", title="(R - F_D) / T_bollard, eq. 7.1")
        _from_zero(factor)
        handles, labels = force.get_legend_handles_labels()
        canvas.legend(handles, labels, loc="outside lower center", ncols=3)
        canvas.suptitle(f"Towed trial of {boat}", fontweight="bold")


def _along(point: Point, over_speed: bool) -> float:
    """What the curves run along: speed [m/s] or throttle [%]."""
    return point.speed if over_speed else 100.0 * point.throttle


def _other(point: Point, over_speed: bool) -> float:
    """What a curve is drawn at: throttle [%] or speed [m/s]."""
    return _along(point, not over_speed)


def _from_zero(axes: Any) -> None:
    """Let the vertical axis begin at 0, where nothing lies below it."""
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0.0) if low < -0.05 * high else 0.0, high)

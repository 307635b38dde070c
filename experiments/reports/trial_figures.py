"""The pictures of analysed trials, one file for each manoeuvre."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure as Canvas

from swamp_rl.angles import turned
from swamp_rl.figure_style import save, styled
from swamp_rl.files import write_beside
from swamp_rl.manoeuvres.analysis.figure import Result

Draw = Callable[[Canvas, Sequence[Result], float], None]
FLAT = 0.04  # width over length of tracks that are drawn wider than they are
RUNAWAY = 360.0  # deg of heading beyond which a zig-zag is cut off


def draw_trials(folder: Path, results: Sequence[Result], length: float) -> list[str]:
    """Write a PNG for each kind of manoeuvre among the results; the names of the files."""
    names = []
    for kind, drawings in DRAWINGS.items():
        some = [result for result in results if result.kind == kind and result.figures]
        if not some:
            continue
        for name, size, draw in drawings:
            with styled(), write_beside(folder / name) as part:
                canvas = Canvas(figsize=size_of(name, some, size), layout="constrained")
                draw(canvas, some, length)
                save(canvas, part)
            names.append(name)
    return names


def size_of(name: str, results: Sequence[Result], size: tuple[float, float]) -> tuple[float, float]:
    """Inches of a picture: that of the zig-zags grows with its panels."""
    if name != "zig_zags.png":
        return size
    count = len(settings(results))
    return 1.0 + 2.6 * min(max(count, 2), 4), 1.2 + 2.5 * -(-count // 4)


def angle_of(result: Result) -> float:
    """The steering angle [deg] of a result; where it is not known the one math.nan, which a mapping finds."""
    angle = math.degrees(float(result.setting.get("angle", math.nan)))
    return angle if math.isfinite(angle) else math.nan


def throttle_of(result: Result) -> float:
    """The throttle [percent] of a result; math.nan as for `angle_of`."""
    throttle = 100.0 * float(result.setting.get("throttle", math.nan))
    return throttle if math.isfinite(throttle) else math.nan


def colours(values: Sequence[float]) -> dict[float, Any]:
    """A colour for each different value, dark to light in their order."""
    different = sorted(set(values))
    steps = np.linspace(0.0, 0.85, len(different)) if len(different) > 1 else [0.3]
    return {value: colormaps["viridis"](step) for value, step in zip(different, steps, strict=True)}


def percent(throttle: float) -> str:
    """A throttle for a legend."""
    return "throttle unknown" if math.isnan(throttle) else f"{throttle:.3g} %"


def _legend(canvas: Canvas, axes: Any, columns: int) -> None:
    """A legend beneath all panels, one entry for what is drawn twice, as to either side."""
    handles, labels = axes.get_legend_handles_labels()
    shown = dict(zip(labels[::-1], handles[::-1], strict=True))
    canvas.legend(list(shown.values())[::-1], list(shown)[::-1], loc="outside lower center", ncols=columns)


def _turned_upright(place: Any, heading: float) -> tuple[Any, Any]:
    """Ahead and starboard of a track's start, by the heading it began on."""
    north, east = (place - place[0]).T
    return turned(north, east, -heading)


def circles(canvas: Canvas, results: Sequence[Result], length: float) -> None:
    """Tracks as they are and with the drift removed, in lengths (figure 3 of 002)."""
    axes = canvas.subplots(1, 2, sharex=True, sharey=True)
    shades = colours([abs(angle_of(result)) for result in results])
    dashes = dict(
        zip(sorted({throttle_of(r) for r in results})[::-1], ("-", "--", ":", "-.") * 9, strict=False)
    )
    for panel, kind, title in zip(
        axes, ("raw", "corrected"), ("as recorded", "drift of the centre removed"), strict=True
    ):
        for result in results:
            if kind not in result.traces:
                continue
            ahead, aside = _turned_upright(result.traces[kind], float(result.traces["heading"]))
            angle, throttle = abs(angle_of(result)), throttle_of(result)
            pattern = result.setting.get("pattern", "opposed")
            label = f"{angle:.0f}°, {percent(throttle)}" + (f", {pattern}" if pattern != "opposed" else "")
            panel.plot(
                aside / length,
                ahead / length,
                dashes[throttle] if pattern == "opposed" else "-.",
                color=shades[angle],
                lw=1.1,
                label=label,
            )
        panel.set(title=title, xlabel="to starboard [L]", aspect="equal")
        panel.plot(0.0, 0.0, "k+", ms=7)
    axes[0].set_ylabel("ahead [L]")
    _legend(canvas, axes[0], 5)
    canvas.suptitle("Turning circles, from the execute", fontweight="bold")


def diameters(canvas: Canvas, results: Sequence[Result], length: float) -> None:
    """Tactical and steady diameter against the angle, mean and standard deviation over turns (figure 4)."""
    axes = canvas.subplots(1, 2, sharey=True)
    shades = colours([throttle_of(result) for result in results])
    for panel, name in zip(axes, ("tactical_diameter", "steady_diameter"), strict=True):
        for result in sorted(results, key=angle_of):
            figure, starboard = result.best[name], angle_of(result) > 0
            shift = 0.4 if starboard else -0.4
            panel.errorbar(
                abs(angle_of(result)) + shift,
                figure.mean / length,
                yerr=0.0 if math.isnan(figure.sd) else figure.sd / length,
                fmt="^" if starboard else "v",
                color=shades[throttle_of(result)],
                capsize=3,
                ms=5,
                lw=1.2,
            )
        panel.set(title=name.replace("_", " "), xlabel="steering angle [deg]")
        angles = sorted({round(abs(angle_of(result)), 1) for result in results})
        panel.set(xticks=angles, xlim=(angles[0] - 5.0, angles[-1] + 5.0))
    axes[0].set_ylabel("diameter [L]")
    axes[0].set_ylim(bottom=0.0)
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], color=shade, lw=3, label=percent(t)) for t, shade in shades.items()]
    handles += [
        Line2D([], [], color="k", marker=mark, ls="", label=side)
        for mark, side in (("^", "to starboard"), ("v", "to port"))
    ]
    canvas.legend(handles=handles, loc="outside lower center", ncols=6)
    canvas.suptitle("Mean and standard deviation over turns, drift removed", fontweight="bold")


def settings(results: Sequence[Result]) -> list[tuple[float, float]]:
    """The different angles and headings [deg] of zig-zags, in order."""
    found = {(round(abs(angle_of(r)), 1), round(heading_of(r), 1)) for r in results}
    return sorted(found)


def heading_of(result: Result) -> float:
    """Where a zig-zag reverses [deg]; its angle where that is not stated."""
    return abs(math.degrees(float(result.setting.get("heading", result.setting.get("angle", math.nan)))))


def zig_zags(canvas: Canvas, results: Sequence[Result], length: float) -> None:
    """Heading over time in lengths sailed at the approach speed, a panel for each setting (figure 5)."""
    asked = settings(results)
    columns = min(4, len(asked))
    grid = canvas.subplots(-(-len(asked) // columns), columns, squeeze=False).ravel()
    shades = colours([throttle_of(result) for result in results])
    for panel, (angle, heading) in zip(grid, asked, strict=False):
        some = [
            r for r in results if (round(abs(angle_of(r)), 1), round(heading_of(r), 1)) == (angle, heading)
        ]
        for result in sorted(some, key=throttle_of):
            throttle, trace = throttle_of(result), result.traces
            sailed = trace["time"] * result.figures["approach_speed"].value / length
            dash = "-" if angle_of(result) > 0 else "--"
            panel.plot(
                sailed, trace["heading"], dash, color=shades[throttle], lw=1.1, label=percent(throttle)
            )
        if np.isfinite(trace["angle"]).any():
            panel.plot(sailed, trace["angle"], color="#999999", lw=0.8, zorder=1, label="steering, fastest")
        panel.set_title(f"{angle:g}°/{heading:g}°")
        low, high = panel.get_ylim()
        panel.set_ylim(max(low, -RUNAWAY), min(high, RUNAWAY))
    for panel in grid[len(asked) :]:
        panel.set_axis_off()
    for panel in grid[max(len(asked) - columns, 0) : len(asked)]:
        panel.set_xlabel("time · approach speed / L")
    for panel in grid[: len(asked) : columns]:
        panel.set_ylabel("heading, steering [deg]")
    _legend(canvas, grid[0], 6)
    canvas.suptitle("Zig-zags, from the first execute", fontweight="bold")


def zig_zag_tracks(canvas: Canvas, results: Sequence[Result], length: float) -> None:
    """Tracks over ground of the zig-zags at the highest throttle, in lengths, side by side."""
    axes = canvas.subplots()
    most = max(throttle_of(result) for result in results)
    some = sorted(
        (r for r in results if throttle_of(r) is most or throttle_of(r) == most),
        key=lambda r: (abs(angle_of(r)), angle_of(r)),
    )
    shades = colours([abs(angle_of(result)) for result in some])
    apart = farthest = 0.0
    for result in some:
        ahead, aside = _turned_upright(result.traces["place"], float(result.traces["course"]))
        apart -= float(aside.min()) / length
        label = f"{angle_of(result):g}°/{heading_of(result):g}°"
        axes.plot(
            ahead / length, aside / length + apart, color=shades[abs(angle_of(result))], lw=1.2, label=label
        )
        apart += float(aside.max()) / length + 2.0
        farthest = max(farthest, float(np.ptp(ahead)) / length)
    shape = (apart - 2.0) / max(farthest, 1e-9)
    flat = shape < FLAT
    canvas.set_size_inches(9.0, 4.0 if flat else min(1.8 + 8.4 * shape, 9.0))
    across = "to starboard, enlarged [L]" if flat else "to starboard, offset [L]"
    axes.set(xlabel="ahead [L]", ylabel=across, aspect="auto" if flat else "equal")
    axes.invert_yaxis()  # as seen from above, bow to the right
    canvas.legend(loc="outside lower center", ncols=8)
    canvas.suptitle(f"Tracks of the zig-zags at {percent(most)}", fontweight="bold")


def overshoots(canvas: Canvas, results: Sequence[Result], length: float) -> None:
    """First overshoot, and mean of all with its interval, against the setting."""
    axes = canvas.subplots(1, 2, sharey=True)
    shades = colours([throttle_of(result) for result in results])
    asked = settings(results)
    for panel, name, title in zip(
        axes, ("first_overshoot", "overshoot"), ("first overshoot", "mean of all, 95 % interval"), strict=True
    ):
        for i, (throttle, shade) in enumerate(shades.items()):
            shift = (i - 0.5 * (len(shades) - 1)) * 0.1
            some = [r for r in results if throttle_of(r) == throttle]
            at = [asked.index((round(abs(angle_of(r)), 1), round(heading_of(r), 1))) + shift for r in some]
            figures = [r.figures[name] for r in some]
            ends = [(f.value - f.low, f.high - f.value) for f in figures]
            error = np.nan_to_num(np.array(ends).T) if figures else None
            panel.errorbar(
                at,
                [f.value for f in figures],
                yerr=error,
                fmt="o",
                ms=4,
                capsize=2,
                lw=1.1,
                color=shade,
                label=percent(throttle),
            )
        panel.set(title=title, xticks=range(len(asked)), xlim=(-0.6, len(asked) - 0.4))
        panel.set_xticklabels([f"{a:g}/{h:g}" for a, h in asked])
        panel.set_xlabel("steering angle / heading [deg]")
    axes[0].set_ylabel("overshoot [deg]")
    axes[0].set_ylim(bottom=0.0)
    handles, labels = axes[0].get_legend_handles_labels()
    canvas.legend(handles, labels, loc="outside lower center", ncols=6)
    canvas.suptitle("Overshoots of the zig-zags", fontweight="bold")


def spirals(canvas: Canvas, results: Sequence[Result], length: float) -> None:
    """Yaw rate against steering angle, the way there and back."""
    axes = canvas.subplots()
    for i, result in enumerate(results):
        angle, rate = result.traces["angle"], result.traces["rate"]
        half, colour = len(angle) // 2 + 1, f"C{i}"
        axes.plot(angle[:half], rate[:half], "v-", color=colour, ms=4, lw=1.1, label=f"{result.run}: there")
        axes.plot(angle[half - 1 :], rate[half - 1 :], "^--", color=colour, ms=4, lw=1.1, label="and back")
        if "curve_rate" in result.traces:
            curve = result.traces["curve_angle"], result.traces["curve_rate"]
            axes.plot(*curve, color=colour, lw=0.9, ls=":", label="curve through them")
    axes.axhline(0.0, color="#888888", lw=0.8)
    axes.axvline(0.0, color="#888888", lw=0.8)
    axes.set(xlabel="steering angle [deg], + turns to starboard", ylabel="yaw rate [deg/s]")
    canvas.legend(loc="outside lower center", ncols=3)
    canvas.suptitle("Spirals", fontweight="bold")


def pull_outs(canvas: Canvas, results: Sequence[Result], length: float) -> None:
    """Yaw rate over time since the steering went amidships."""
    axes = canvas.subplots()
    for i, result in enumerate(results):
        for side, dash in (("starboard", "-"), ("port", "--")):
            trace = result.traces.get(f"pull_out_{side}")
            if trace is not None:
                axes.plot(*trace, dash, color=f"C{i}", lw=1.2, label=f"{result.run}, from {side}")
    axes.axhline(0.0, color="#888888", lw=0.8)
    axes.set(xlabel="time since amidships [s]", ylabel="yaw rate [deg/s]")
    canvas.legend(loc="outside lower center", ncols=2)
    canvas.suptitle("Pull-outs", fontweight="bold")


def stops(canvas: Canvas, results: Sequence[Result], length: float) -> None:
    """Surge over time since the order."""
    axes = canvas.subplots()
    for result in results:
        reach = result.figures["track_reach"].value
        label = f"{result.run}: {reach:.2f} m"
        axes.plot(result.traces["time"], result.traces["surge"], lw=1.3, label=label)
    axes.set(xlabel="time since full astern [s]", ylabel="surge [m/s]")
    canvas.legend(loc="outside lower center", ncols=2, title="track reach")
    canvas.suptitle("Stopping", fontweight="bold")


def speeds(canvas: Canvas, results: Sequence[Result], length: float) -> None:
    """Speed against throttle, ahead and astern."""
    axes = canvas.subplots()
    for astern, mark, label in ((False, "^", "ahead"), (True, "v", "astern")):
        some = [r for r in results if bool(r.setting.get("astern", False)) == astern and r.figures]
        some.sort(key=throttle_of)
        if some:
            at = [throttle_of(r) for r in some]
            axes.plot(at, [abs(r.figures["speed"].value) for r in some], f"{mark}-", lw=1.2, label=label)
    axes.set(xlabel="throttle [%]", ylabel="speed over ground [m/s]", ylim=(0.0, None))
    axes.legend(loc="upper left")
    canvas.suptitle("Straight runs", fontweight="bold")


DRAWINGS: dict[str, list[tuple[str, tuple[float, float], Draw]]] = {
    "turning-circle": [("circles.png", (9.5, 4.0), circles), ("diameters.png", (9.0, 4.2), diameters)],
    "zig-zag": [
        ("zig_zags.png", (11.0, 6.0), zig_zags),
        ("overshoots.png", (10.0, 4.2), overshoots),
        ("zig_zag_tracks.png", (9.0, 6.0), zig_zag_tracks),
    ],
    "spiral": [("spiral.png", (7.0, 5.4), spirals)],
    "reverse-spiral": [("reverse_spiral.png", (7.0, 5.4), spirals)],
    "pull-out": [("pull_out.png", (7.0, 4.6), pull_outs)],
    "stopping": [("stopping.png", (7.0, 4.6), stops)],
    "straight": [("straight.png", (6.0, 4.4), speeds)],
}

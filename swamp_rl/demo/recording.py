"""A rerun recording of several runs on one course, all over one common time, so that they race each other.

The picture is the chart seen from above: x is east and y is minus north, as rerun's y points down the screen.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.course import Course
from swamp_rl.files import write_beside
from swamp_rl.runs import Run

TIMELINE = "time"
GATE_COLOURS = {"green": (44, 160, 44), "red": (214, 39, 40)}
OTHER_GATE = (255, 127, 14)
PILOT_COLOURS = ((150, 150, 150), (31, 119, 180), (255, 152, 0), (148, 103, 189), (23, 190, 207))
LEVERS = {"throttle": "joy_thrust", "angle": "joy_angle"}


def write_demo(
    path: Path | str, course: Course, runs: Mapping[str, Run], length: float, breadth: float
) -> None:
    """Write `runs`, by the name of who drove, into one .rrd file; no viewer is started.

    Each run's time starts at 0. length, breadth: of the boat drawn [m]. A run without joypad columns shows
    its track only. UserError where the file cannot be written.
    """
    import rerun as rr

    recording = rr.RecordingStream("swamp_rl", recording_id=f"{course.name}: {', '.join(runs)}")
    # By way of memory: rerun's own writer of files can wait for ever on a disk that is full.
    memory = recording.memory_recording()
    recording.send_blueprint(_layout(course, runs))
    _log_course(recording, course)
    for (name, run), colour in zip(runs.items(), _colours(len(runs)), strict=True):
        _log_track(recording, name, run, colour, (length, breadth))
        _log_levers(recording, name, run, colour)
    with write_beside(path) as part:
        part.write_bytes(memory.drain_as_bytes())


def _colours(n: int) -> list[tuple[int, int, int]]:
    return [PILOT_COLOURS[i % len(PILOT_COLOURS)] for i in range(n)]


def _on_screen(north: Any, east: Any) -> NDArray[np.float64]:
    return np.stack([np.asarray(east, dtype=float), -np.asarray(north, dtype=float)], axis=-1)


def _log_course(recording: Any, course: Course) -> None:
    import rerun as rr

    for gate in course.gates:
        colour = GATE_COLOURS.get(gate.name, OTHER_GATE)
        buoys = _on_screen(*zip(*((buoy.north, buoy.east) for buoy in gate.buoys), strict=True))
        ahead = _on_screen(math.cos(gate.heading), math.sin(gate.heading))
        centre = _on_screen(gate.centre.north, gate.centre.east)
        where = f"chart/gates/{gate.name}"
        recording.log(
            f"{where}/buoys",
            rr.Points2D(buoys, radii=max(course.buoy_radius, 0.25), colors=colour),
            static=True,
        )
        recording.log(
            f"{where}/direction",
            rr.Arrows2D(origins=centre - ahead, vectors=2.0 * ahead, radii=0.05, colors=colour),
            static=True,
        )
    start = course.start.pose
    recording.log(
        "chart/start",
        rr.Points2D(_on_screen([start.north], [start.east]), radii=0.2, labels="start", show_labels=True),
        static=True,
    )


def _log_track(
    recording: Any, name: str, run: Run, colour: tuple[int, int, int], size: tuple[float, float]
) -> None:
    import rerun as rr

    north, east, heading = run.pose.T
    points = _on_screen(north, east)
    faint = (*colour, 90)
    recording.log(
        f"chart/{name}/whole_track", rr.LineStrips2D([points], radii=0.03, colors=faint), static=True
    )
    time = _time_column(run)
    segments = np.stack([points[np.maximum(np.arange(len(points)) - 1, 0)], points], axis=1)
    recording.send_columns(
        f"chart/{name}/track",
        [time],
        rr.LineStrips2D.columns(
            strips=segments.astype(np.float32), radii=[0.08] * len(points), colors=[colour] * len(points)
        ),
    )
    outlines = _outlines(points, heading, *size)
    recording.send_columns(
        f"chart/{name}/boat",
        [time],
        rr.LineStrips2D.columns(
            strips=outlines,
            radii=[0.06] * len(points),
            colors=[colour] * len(points),
            labels=[name] * len(points),
        ),
    )


def _time_column(run: Run) -> Any:
    import rerun as rr

    # To the microsecond, so that equal instants of two runs are one instant on the timeline.
    return rr.TimeColumn(TIMELINE, duration=np.round(run.time - run.time[0], 6))


def _outlines(points: NDArray[Any], heading: NDArray[Any], length: float, breadth: float) -> NDArray[Any]:
    """(T, 6, 2) the closed outline of a boat with a pointed bow at each of points (T, 2)."""
    ahead = length * np.array([-0.5, 0.25, 0.5, 0.25, -0.5, -0.5])
    starboard = breadth * np.array([-0.5, -0.5, 0.0, 0.5, 0.5, -0.5])
    cos, sin = np.cos(heading)[:, None], np.sin(heading)[:, None]
    return points[:, None, :] + _on_screen(ahead * cos - starboard * sin, ahead * sin + starboard * cos)


def _log_levers(recording: Any, name: str, run: Run, colour: tuple[int, int, int]) -> None:
    import rerun as rr

    time = _time_column(run)
    for lever, column in LEVERS.items():
        if column not in run.columns:
            continue
        recording.log(
            f"levers/{lever}/{name}", rr.SeriesLines(colors=colour, names=name, widths=1.5), static=True
        )
        recording.send_columns(
            f"levers/{lever}/{name}", [time], rr.Scalars.columns(scalars=run.columns[column])
        )


def _layout(course: Course, runs: Mapping[str, Run]) -> Any:
    import rerun.blueprint as rrb

    bounds = course.bounds
    everything = rrb.VisibleTimeRange(
        TIMELINE, start=rrb.TimeRangeBoundary.infinite(), end=rrb.TimeRangeBoundary.cursor_relative()
    )
    # Rerun takes a track's own range, so that boats show where they are and tracks where they have been.
    trails: dict[Any, Any] = {f"chart/{name}/track": [rrb.VisibleTimeRanges([everything])] for name in runs}
    chart = rrb.Spatial2DView(
        origin="chart",
        name=f"{course.name}: north is up",
        visual_bounds=rrb.VisualBounds2D(
            x_range=(bounds.west, bounds.east), y_range=(-bounds.north, -bounds.south)
        ),
        overrides=trails,
    )
    levers = [
        rrb.TimeSeriesView(origin=f"levers/{lever}", name=lever, axis_y=rrb.ScalarAxis(range=ends))
        for lever, ends in (("throttle", (-0.05, 1.05)), ("angle", (-1.05, 1.05)))
    ]
    return rrb.Blueprint(
        rrb.Horizontal(chart, rrb.Vertical(*levers), column_shares=(3, 2)),
        rrb.TimePanel(timeline=TIMELINE, state="collapsed"),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="collapsed"),
    )

"""A rerun recording of several runs, all over one common time: chart, space and time series.

On the chart x is east and y is minus north, as rerun's y points down the screen; in space z is up. All
boats of a fleet are one entity with an instance for each: a viewer takes few large pieces far faster than
many small ones.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.demo.card import CARD
from swamp_rl.demo.clock import Array, instants, poses_at, values_at
from swamp_rl.demo.labels import apart
from swamp_rl.demo.layout import RESULT, TIMELINE, Layout, Panel, blueprint, entity
from swamp_rl.demo.markdown import about, table
from swamp_rl.demo.scene import DemoScene, Fleet
from swamp_rl.demo.series import current, series_of, wind
from swamp_rl.demo.shapes import corners, mesh
from swamp_rl.demo.surroundings import in_space, log_surroundings, on_chart
from swamp_rl.files import write_beside

FLOWS = {"wind": (wind, 0.5, (205, 215, 225)), "current": (current, 8.0, (80, 180, 255))}
"""How each is measured, metres drawn for each m/s beside SWAMP, and its colour."""
CHART, LABEL, LETTER = 480.0, 26.0, 8.0
"""Pixels of the chart's height, of a label and of a letter, as the viewer draws them in a usual window."""


def write_recording(path: Path | str, scene: DemoScene, layout: Layout = "overlay") -> None:
    """Write the scene into one .rrd file; no viewer is started. UserError where it cannot be written."""
    data = recorded(scene, layout)
    with write_beside(path) as part:
        part.write_bytes(data)


def recorded(scene: DemoScene, layout: Layout = "overlay") -> bytes:
    """The scene as the bytes of an .rrd file.

    Of more than `FEW` runs the tracks are whole from the start: a viewer would be slow to let so many grow.
    """
    import rerun as rr

    recording = rr.RecordingStream("swamp_rl", recording_id=scene.title)
    # By way of memory: rerun's own writer of files can wait for ever on a disk that is full.
    memory = recording.memory_recording()
    try:
        times = instants(scene)
        panels: dict[str, Panel] = {}
        log_surroundings(recording, scene)
        if scene.few:
            _log_names(recording, scene, times)
        for fleet in scene.fleets:
            poses = np.stack([poses_at(item, times) for item in fleet.shown], axis=1)
            _log_on_chart(recording, scene, fleet, times, poses)
            if scene.few:
                _log_flows(recording, scene, fleet, times, poses)
            _log_in_space(recording, scene, fleet, times, poses)
            _log_series(recording, scene, fleet, times, panels)
        _log_result(recording, scene)
        recording.send_blueprint(blueprint(scene, layout, panels))
    except BaseException:
        memory.drain_as_bytes()  # what is dropped undrained, rerun tells of
        raise
    return memory.drain_as_bytes()


def _log_result(recording: Any, scene: DemoScene) -> None:
    """Who is shown in what weather; and from the end of the last run on, the end card."""
    import rerun as rr

    ended = f"{about(scene)}\n\n{table(scene)}"
    for time, text in ((0.0, about(scene)), (scene.end, ended), (scene.end + CARD, ended)):
        recording.set_time(TIMELINE, duration=time)
        recording.log(RESULT, rr.TextDocument(text, media_type="text/markdown"))
    recording.reset_time()


def _send(recording: Any, where: str, times: Array, columns: Any, instances: int) -> None:
    """Columns of N times as many values as there are instances."""
    import rerun as rr

    clock = rr.TimeColumn(TIMELINE, duration=times)
    recording.send_columns(where, [clock], columns.partition([instances] * len(times)))


def _log_on_chart(recording: Any, scene: DemoScene, fleet: Fleet, times: Array, poses: Array) -> None:
    """poses: (N, K, 3) of the K boats of the fleet."""
    import rerun as rr

    (n, k, _), size = poses.shape, scene.scale
    where = entity("chart", "runs", *fleet.path)
    tracks = [on_chart(*item.run.pose[:, :2].T) for item in fleet.shown]
    faint = rr.LineStrips2D(tracks, radii=0.03 * size, colors=(*fleet.colour, 90))
    recording.log(f"{where}/whole_track", faint, static=True)
    if scene.few:
        ways = _ways(on_chart(poses[..., 0], poses[..., 1]))
        track = rr.LineStrips2D.columns(
            strips=ways, radii=[0.08 * size] * n * k, colors=[fleet.colour] * n * k
        )
        _send(recording, f"{where}/track", times, track, k)
    outline = corners(poses.reshape(-1, 3), scene.length, scene.breadth)
    boats = rr.LineStrips2D.columns(
        strips=on_chart(outline[..., 0], outline[..., 1]).astype(np.float32),
        radii=[0.07 * size] * n * k,
        colors=[fleet.colour] * n * k,
    )
    _send(recording, f"{where}/boat", times, boats, k)


def _ways(points: Array) -> NDArray[np.float32]:
    """(N K, 2, d) the way of each of K boats to each of its points (N, K, d) from the one before."""
    before = points[np.maximum(np.arange(len(points)) - 1, 0)]
    return np.stack([before, points], axis=2).reshape(-1, 2, points.shape[-1]).astype(np.float32)


def _log_names(recording: Any, scene: DemoScene, times: Array) -> None:
    """Names beside the boats, moved apart where boats meet."""
    import rerun as rr

    south, north, _, _ = scene.edges()
    metres = (north - south) / CHART  # in a pixel
    shown = [item for fleet in scene.fleets for item in fleet.shown]
    sizes = metres * np.array([[LETTER * (len(scene.called(item)) + 2.0), LABEL] for item in shown])
    poses = np.stack([poses_at(item, times) for item in shown], axis=1)
    boats, beside = (
        on_chart(poses[..., 0], poses[..., 1]),
        np.array([0.7 * scene.length, -0.7 * LABEL * metres]),
    )
    middles = np.stack([apart(places, sizes, beside) + 0.5 * sizes for places in boats])
    low, high = -north + 0.6 * metres * LABEL, -south - 0.6 * metres * LABEL
    middles[..., 1] += np.maximum(low - middles[..., 1].min(axis=1), 0.0)[:, None]  # all within the chart
    middles[..., 1] -= np.maximum(middles[..., 1].max(axis=1) - high, 0.0)[:, None]
    done = 0
    for fleet in scene.fleets:
        k, n = len(fleet.shown), len(times)
        # A label takes the colour of its point, and is read best in white.
        names = rr.Points2D.columns(
            positions=middles[:, done : done + k].reshape(-1, 2),
            radii=[0.02 * scene.scale] * n * k,
            colors=[(255, 255, 255)] * n * k,
            labels=[scene.called(item) for item in fleet.shown] * n,
        )
        _send(recording, entity("chart", "runs", *fleet.path, "name"), times, names, k)
        done += k


def _log_flows(recording: Any, scene: DemoScene, fleet: Fleet, times: Array, poses: Array) -> None:
    """Wind and current as arrows at the boats that have them."""
    import rerun as rr

    for name, (measured, metres, shade) in FLOWS.items():
        flows = {j: measured(item.run) for j, item in enumerate(fleet.shown)}
        known = {j: flow for j, flow in flows.items() if flow is not None}
        if not known:
            continue
        blown = [np.nan_to_num(values_at(fleet.shown[j], flow, times)) for j, flow in known.items()]
        vectors = metres * scene.scale * np.stack(blown, axis=1)
        n, k = len(times), len(known)
        arrows = rr.Arrows2D.columns(
            origins=on_chart(poses[:, list(known), 0], poses[:, list(known), 1]).reshape(-1, 2),
            vectors=on_chart(vectors[..., 0], vectors[..., 1]).reshape(-1, 2),
            radii=[0.05 * scene.scale] * n * k,
            colors=[shade] * n * k,
        )
        _send(recording, entity("chart", "runs", *fleet.path, name), times, arrows, k)


def _log_in_space(recording: Any, scene: DemoScene, fleet: Fleet, times: Array, poses: Array) -> None:
    import rerun as rr

    (n, k, _), size = poses.shape, scene.scale
    where = entity("space", "runs", *fleet.path)
    if scene.few:
        ways = _ways(in_space(poses[..., 0], poses[..., 1], 0.03 * size))
        track = rr.LineStrips3D.columns(
            strips=ways, radii=[0.06 * size] * n * k, colors=[fleet.colour] * n * k
        )
        _send(recording, f"{where}/track", times, track, k)
    else:
        tracks = [in_space(*item.run.pose[:, :2].T) for item in fleet.shown]
        recording.log(
            f"{where}/whole_track",
            rr.LineStrips3D(tracks, radii=0.02 * size, colors=fleet.colour),
            static=True,
        )
    vertices, triangles = mesh(scene.length, scene.breadth)
    hull = rr.Mesh3D(vertex_positions=vertices, triangle_indices=triangles, albedo_factor=fleet.colour)
    recording.log(f"{where}/boat", hull, static=True)
    # The mesh's bow is along x, which is east: north is a quarter turn from it, and headings go clockwise.
    half = 0.5 * (0.5 * math.pi - poses[..., 2].reshape(-1))
    turned = np.column_stack([np.zeros((n * k, 2)), np.sin(half), np.cos(half)])
    moved = rr.InstancePoses3D.columns(
        translations=in_space(poses[..., 0], poses[..., 1], 0.0).reshape(-1, 3), quaternions=turned
    )
    _send(recording, f"{where}/boat", times, moved, k)


def _log_series(
    recording: Any, scene: DemoScene, fleet: Fleet, times: Array, panels: dict[str, Panel]
) -> None:
    """Each panel of the fleet as one entity, a line for each of its runs (and of their thrusters)."""
    import rerun as rr

    lines: dict[str, list[tuple[str, Array]]] = {}
    for item in fleet.shown:
        for panel, found in series_of(item.run, scene.course).items():
            for line, values in found.items():
                name = " ".join(filter(None, [scene.called(item), line]))
                lines.setdefault(panel, []).append((name, values_at(item, values, times)))
    for panel, drawn in lines.items():
        where, values = entity("series", panel, *fleet.path), np.stack([line for _, line in drawn], axis=1)
        panels.setdefault(panel, Panel()).add(where, values)
        style = rr.SeriesLines(
            colors=[fleet.colour] * len(drawn), names=[name for name, _ in drawn], widths=[1.5] * len(drawn)
        )
        recording.log(where, style, static=True)
        _send(recording, where, times, rr.Scalars.columns(scalars=values.reshape(-1)), len(drawn))

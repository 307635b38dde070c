"""What the boats move in, for a rerun recording: water, gates, buoys and the start."""

import math
from typing import Any

import numpy as np

from swamp_rl.course import Course
from swamp_rl.demo.layout import entity
from swamp_rl.demo.scene import DemoScene, gate_colour
from swamp_rl.demo.shapes import Array

WATER = (28, 70, 105)


def on_chart(north: Any, east: Any) -> Array:
    """(..., 2) x and y of places [m], as rerun's screen has them."""
    return np.stack([np.asarray(east, dtype=float), -np.asarray(north, dtype=float)], axis=-1)


def in_space(north: Any, east: Any, up: float = 0.0) -> Array:
    """(..., 3) x, y and z of places [m] at one height."""
    flat = np.stack([np.asarray(east, dtype=float), np.asarray(north, dtype=float)], axis=-1)
    return np.concatenate([flat, np.full((*flat.shape[:-1], 1), up)], axis=-1)


def log_surroundings(recording: Any, scene: DemoScene) -> None:
    """Whatever stays where it is."""
    import rerun as rr

    south, north, west, east = scene.edges()
    margin = 20.0 * max(east - west, north - south)
    corners = np.array([[south, west], [south, east], [north, east], [north, west]])
    sheet = corners + margin * np.array([[-1, -1], [-1, 1], [1, 1], [1, -1]])
    recording.log("space", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    water = rr.Mesh3D(
        vertex_positions=in_space(sheet[:, 0], sheet[:, 1], -0.02 * scene.scale),
        triangle_indices=[[0, 1, 2], [0, 2, 3]],
        vertex_normals=[[0.0, 0.0, 1.0]] * 4,
        albedo_factor=WATER,
    )
    recording.log("space/course/water", water, static=True)
    if scene.course is not None:
        _log_course(recording, scene.course, scene.scale)


def _log_course(recording: Any, course: Course, size: float) -> None:
    """size: of what has a size of its own, in that of SWAMP's course."""
    import rerun as rr

    for gate in course.gates:
        colour, radius = gate_colour(gate.name), max(course.buoy_radius, 0.25 * size)
        sides = np.array([(buoy.north, buoy.east) for buoy in gate.buoys]).T
        ahead = size * on_chart(math.cos(gate.heading), math.sin(gate.heading))
        centre = on_chart(gate.centre.north, gate.centre.east)
        flat = {
            "buoys": rr.Points2D(on_chart(*sides), radii=radius, colors=colour),
            "line": rr.LineStrips2D([on_chart(*sides)], radii=0.03 * size, colors=(*colour, 110)),
            "direction": rr.Arrows2D(
                origins=centre - ahead, vectors=2.0 * ahead, radii=0.05 * size, colors=colour
            ),
        }
        solid = {
            "buoys": rr.Ellipsoids3D(
                centers=in_space(sides[0], sides[1], 0.15 * size),
                half_sizes=[(radius, radius, 1.4 * radius)] * 2,
                colors=colour,
                fill_mode="solid",
            ),
            "line": rr.LineStrips3D(
                [in_space(sides[0], sides[1], 0.02 * size)], radii=0.04 * size, colors=colour
            ),
        }
        for root, drawn in (("chart", flat), ("space", solid)):
            for what, archetype in drawn.items():
                recording.log(entity(root, "course", "gates", gate.name, what), archetype, static=True)
    start = course.start.pose
    recording.log(
        "chart/course/start",
        rr.Points2D(
            on_chart([start.north], [start.east]), radii=0.15 * size, labels="start", show_labels=False
        ),
        static=True,
    )

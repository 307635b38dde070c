"""Courses: gates to pass in order, the buoys that mark them, the start and the bounds."""

from swamp_rl.course.fit import fitted
from swamp_rl.course.schema import (
    Bounds,
    Course,
    Depth,
    Gate,
    Point,
    Pose,
    Start,
    course_files,
    limited,
    load_course,
)
from swamp_rl.course.tables import buoy_table, gate_table

__all__ = [
    "Bounds",
    "Course",
    "Depth",
    "Gate",
    "Point",
    "Pose",
    "Start",
    "buoy_table",
    "course_files",
    "fitted",
    "gate_table",
    "limited",
    "load_course",
]

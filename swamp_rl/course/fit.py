"""A course laid out for the boat that sails it, by Froude's law."""

import math

from swamp_rl.course.schema import LONGEST, SHORTEST, Course, scaled_lengths
from swamp_rl.files import validated


def fitted(course: Course, length: float, speed: float | None = None) -> Course:
    """The course for a boat of length L [m], as it stands where it names no boat of its own.

    s = L / `boat_length`: all lengths times s, the time limit times √s; where the boat's top speed U [m/s]
    is given and below `boat_speed` √s, times `boat_speed` √s / U besides. A fitted course names no boat.
    """
    if course.boat_length is None:
        return course
    scale, slower = length / course.boat_length, 1.0
    own = {"boat_length": None, "boat_speed": None}
    if speed is not None and course.boat_speed is not None:
        slower = max(1.0, course.boat_speed * math.sqrt(scale) / max(speed, 1e-9))
    if scale == slower == 1.0:
        return course.model_copy(update=own)
    whole = scaled_lengths(course.model_dump(mode="json"), scale)
    whole["time_limit"] = min(max(slower * whole["time_limit"], SHORTEST), LONGEST)
    return validated(f"course {course.name} for a boat of {length:g} m", Course, {**whole, **own})

"""A course as the arrays that the compiled functions read."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.course.schema import Course

GATE_NORTH, GATE_EAST, GATE_COS, GATE_SIN, GATE_HALF_WIDTH = range(5)


def gate_table(course: Course) -> NDArray[np.float64]:
    """(G, 5): centre north and east [m], cosine and sine of the heading, half the width [m]."""
    rows = [
        (
            gate.centre.north,
            gate.centre.east,
            math.cos(gate.heading),
            math.sin(gate.heading),
            0.5 * gate.width,
        )
        for gate in course.gates
    ]
    return np.array(rows, dtype=np.float64)


def buoy_table(course: Course) -> NDArray[np.float64]:
    """(2 G, 2): north and east of each buoy [m]."""
    return np.array([(buoy.north, buoy.east) for buoy in course.buoys], dtype=np.float64)

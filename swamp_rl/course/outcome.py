"""How a recorded track ended on a course, by the rules that the environment applies to a boat at sea."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.course.geometry import crosses_gate, outside, touches_buoy
from swamp_rl.course.schema import Course
from swamp_rl.course.tables import buoy_table, gate_table

SUCCESS, BUOY, OUT_OF_BOUNDS, TIMEOUT, INCOMPLETE = (
    "success",
    "buoy",
    "out_of_bounds",
    "timeout",
    "incomplete",
)


def outcome_of(time: NDArray[np.float64], track: NDArray[np.float64], course: Course, breadth: float) -> str:
    """The first of what happened on a track: north and east [m], (T, 2), of midship at `time` [s], (T,).

    'buoy': the hull, a disc of `breadth` [m], touched one; 'success': the last gate was passed; then
    'out_of_bounds' and 'timeout', counted from the first row; 'incomplete' where the track ends before any.
    """
    gates, buoys, edges = gate_table(course), buoy_table(course), course.bounds
    reach = course.buoy_radius + 0.5 * breadth
    passed = 0
    for t in range(1, len(track)):
        (north0, east0), (north, east) = track[t - 1].tolist(), track[t].tolist()
        passed += bool(crosses_gate(north0, east0, north, east, *gates[passed]))
        if any(touches_buoy(north0, east0, north, east, buoy[0], buoy[1], reach) for buoy in buoys):
            return BUOY
        if passed == len(gates):
            return SUCCESS
        if outside(north, east, edges.south, edges.north, edges.west, edges.east):
            return OUT_OF_BOUNDS
        if time[t] - time[0] >= course.time_limit - 1e-9:
            return TIMEOUT
    return INCOMPLETE


def passes_in_a_step(
    time: NDArray[np.float64], track: NDArray[np.float64], course: Course, breadth: float
) -> bool:
    """Return whether a track, as of `outcome_of`, that repeated its last step once would end in success."""
    if len(track) < 2:
        return False
    times, places = (np.append(known, 2.0 * known[-1:] - known[-2:-1], axis=0) for known in (time, track))
    return outcome_of(times, places, course, breadth) == SUCCESS

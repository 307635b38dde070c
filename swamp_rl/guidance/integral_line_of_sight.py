"""Line of sight with an integral, which finds the drift angle that a current asks for."""

import math

from swamp_rl.guidance.line_of_sight import Waypoint, bearing, offset


def drift_corrected(
    place: Waypoint, start: Waypoint, end: Waypoint, lookahead: float, gain: float, memory: float, dt: float
) -> tuple[float, float]:
    """Heading [rad] that leads onto the line and, as learnt, along it; and the memory [m] dt later.

    lookahead [m]; gain [1] of the integral: a current across of c at speed U settles at
    memory * gain = lookahead tan(asin(c / U)) (Borhaug, Pavlov and Pettersen 2008, eq. 9).
    The memory grows slowly far from the line, so that it does not wind up on the way there.
    """
    across = offset(place, start, end).across
    aside = across + gain * memory
    heading = bearing(start, end) - math.atan2(aside, lookahead)
    return heading, memory + dt * lookahead * across / (aside**2 + lookahead**2)

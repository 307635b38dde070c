"""The approach over three waypoints at the set throttle: every trial starts alike (002, section 3)."""

import math
from dataclasses import dataclass

from swamp_rl.guidance.heading import Limits, slowest_speed, steering_angle
from swamp_rl.guidance.line_of_sight import Waypoint, leg_after, line_of_sight, offset
from swamp_rl.guidance.loop import Seen
from swamp_rl.manoeuvres.controller import (
    APPROACH,
    EXECUTE,
    Controller,
    Order,
    Phase,
    Trial,
    patience,
)
from swamp_rl.manoeuvres.settling import Settling, started, watched

ENTRY, RUN_UP = 10.0, 15.0  # lengths from the first waypoint to the second, and on to the third
LOOKAHEAD, RADIUS = 8.0, 1.5  # lengths
SLOW, STEADY, HOLD = 3.0, 0.005, 3.0  # lengths sailed that are averaged; tolerance; lengths it must last
TURNING, LEEWAY = 0.001, 0.003  # rad per length sailed, and share of the way across, that count as straight
EXTRA = 0.2  # of the patience: how long the boat may go on beyond the third waypoint until it is steady
START_TOLERANCE = 0.03  # of the start speed asked for


@dataclass(frozen=True)
class Area:
    """Where the trials take place: a centre [m] and the direction [rad] in which they begin."""

    north: float = 0.0
    east: float = 0.0
    direction: float = 0.0

    def place(self, ahead: float, starboard: float = 0.0) -> Waypoint:
        """A place so far [m] ahead and to starboard of the centre."""
        cos, sin = math.cos(self.direction), math.sin(self.direction)
        return Waypoint(self.north + ahead * cos - starboard * sin, self.east + ahead * sin + starboard * cos)


def waypoints(area: Area, length: float) -> list[Waypoint]:
    """Home, entrance, alignment and start, the last three in line; length of the boat [m]."""
    entrance, alignment = -(ENTRY + RUN_UP) * length, -RUN_UP * length
    home = area.place(entrance - 4.0 * length, -2.0 * length)
    return [home, area.place(entrance), area.place(alignment), area.place(0.0)]


def approached(trial: Trial, manoeuvre: Controller, area: Area, length: float, limits: Limits) -> Controller:
    """The manoeuvre, with the approach before it; length [m] of the boat, limits of its steering.

    The manoeuvre begins beyond the third waypoint as soon as speed and heading are steady; where that does
    not come about in time it begins all the same, and the phase's notes say what was missing.
    """
    route = waypoints(area, length)
    longest = patience(length)

    def control(sensed: Seen, phase: Phase) -> tuple[Order, Phase]:
        if phase.name != APPROACH:
            return manoeuvre(sensed, phase)
        place, speed = Waypoint(sensed.north, sensed.east), math.hypot(sensed.surge, sensed.sway)
        sailed = length / max(speed, slowest_speed(length))
        leg = leg_after(place, route, phase.number, RADIUS * length)
        memory = _watched(phase.memory, sensed, speed, offset(place, route[1], route[3]).across, sailed)
        arrived = min(memory[-1], sensed.time) if leg == 3 else math.inf
        phase = phase._replace(number=leg, memory=(*memory[:-1], arrived))
        changed = {"speed or yaw rate": memory[2], "distance to its line": memory[5]}
        unsteady = [what for what, since in changed.items() if sensed.time - since < HOLD * sailed]
        late = sensed.time - arrived > EXTRA * longest or sensed.time - phase.began > longest
        if (leg == 3 and not unsteady) or late:
            phase = _noted(phase, trial, speed, leg, unsteady)._replace(heading=sensed.heading)
            return manoeuvre(sensed, phase.then(EXECUTE, sensed.time))
        last = min(leg, 2)
        course = line_of_sight(place, route[last], route[last + 1], LOOKAHEAD * length)
        angle = steering_angle(course, sensed.heading, sensed.yaw_rate, speed, length, limits)
        return Order(angle, trial.throttle), phase

    return control


def _watched(
    memory: tuple[float, ...], sensed: Seen, speed: float, across: float, sailed: float
) -> tuple[float, ...]:
    """The speed and the way aside of the line as they settle, and when the third waypoint was passed.

    Both over ground, as they are measured: a current or a heading that is off does not keep them from it.
    sailed: s in which the boat sails its length.
    """
    time = sensed.time
    memory = memory or (*started(time, speed), *started(time, across), math.inf)
    pace = watched(Settling(*memory[:3]), time, speed, SLOW * sailed, STEADY * speed)
    if abs(sensed.yaw_rate) * sailed > TURNING:
        pace = pace._replace(since=time)
    aside = watched(Settling(*memory[3:6]), time, across, SLOW * sailed, LEEWAY * SLOW * sailed * speed)
    return (*pace, *aside, memory[6])


def _noted(phase: Phase, trial: Trial, speed: float, leg: int, unsteady: list[str]) -> Phase:
    if leg < 3:
        return phase.noted(
            f"the approach reached waypoint {leg} of 3 only, at {speed:.2f} m/s: executed from there"
        )
    asked = trial.start_speed
    if asked is not None and abs(speed - asked) > START_TOLERANCE * asked:
        phase = phase.noted(f"start speed {asked:.2f} m/s was not reached, it began at {speed:.2f} m/s")
    if unsteady:
        what = ", ".join(unsteady)
        phase = phase.noted(f"not steady yet when it began, at {speed:.2f} m/s: {what}")
    return phase

"""A mission: what its YAML may hold, strictly."""

import math
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from swamp_rl.boat.part import FROM_LIST, NAME, Part
from swamp_rl.boat.quantity import Unit
from swamp_rl.files import find_config, read_yaml, validated
from swamp_rl.guidance.line_of_sight import Waypoint
from swamp_rl.guidance.places import CLOSEST, LONGEST, Degrees, Place, Start


class Leg(Part):
    """One leg at a speed over ground: for a duration on a course, or over waypoints."""

    speed: Annotated[float, Field(gt=0.0, le=50.0), Unit("m/s")]
    "Over ground."
    duration_s: Annotated[float, Field(ge=1.0, le=LONGEST), Unit("s")] | None = None
    "Duration of the leg."
    course_deg: Annotated[Degrees, Unit("deg")] | None = None
    "Course of a leg with a duration; that of the leg before where it is left out."
    waypoints: Annotated[tuple[Place, ...], FROM_LIST, Field(min_length=1, max_length=1000)] | None = None
    "Places [north, east] in m, from where the boat is."

    depth: Annotated[float, Field(gt=0.0, le=12000.0), Unit("m")] | None = None
    "Depth of the water; that of the leg before where it is left out, and deep where none has one."

    @model_validator(mode="after")
    def _has_one_end(self) -> Self:
        if (self.duration_s is None) == (self.waypoints is None):
            raise ValueError("give either duration_s or waypoints")
        if self.waypoints is not None and self.course_deg is not None:
            raise ValueError("course_deg: waypoints have their own courses; drop it")
        return self


class Mission(Part):
    """A mission file, whole."""

    name: Annotated[str, NAME]
    "Name in reports."
    description: str = ""
    "For people."
    boat: str
    "A name in configs/boats, or a boat file."
    start: Start = Start()
    "Pose at rest at the start; its course is that of a first leg that has none."
    charge: Annotated[float, Field(gt=0.0, le=1.0), Unit("1")] = 1.0
    "State of charge of every pack at the start."
    reserve: Annotated[float, Field(ge=0.0, lt=1.0), Unit("1")] | None = None
    "State of charge that must be left; 1 − depth_of_discharge of the boat file where it is left out."
    seed: Annotated[int, Field(ge=0, lt=2**31)] = 0
    "Seed of the wind's gusts."
    legs: Annotated[tuple[Leg, ...], FROM_LIST, Field(min_length=1, max_length=1000)]
    "Legs, in their order."

    @model_validator(mode="after")
    def _has_an_end(self) -> Self:
        for number, leg in enumerate(self.legs):
            way = [self.home] if number == 0 else []
            way += [Waypoint(*place) for place in leg.waypoints or ()]
            if any(math.dist(a, b) < CLOSEST for a, b in pairwise(way)):
                raise ValueError(f"legs.{number}.waypoints: two lie within {CLOSEST:g} m; drop one of them")
        total = sum(self._expected())
        if total > LONGEST:
            raise ValueError(f"legs: {total:.6g} s in all, at most {LONGEST:g} s (a day); divide the mission")
        return self

    @property
    def home(self) -> Waypoint:
        """The place at the start."""
        return Waypoint(self.start.north, self.start.east)

    @property
    def course(self) -> float:
        """The heading at the start [rad]."""
        return math.radians(self.start.course_deg)

    def _expected(self) -> list[float]:
        """Time [s] of each leg at its speed, waypoints as straight lines from the last known place."""
        here, found = self.home, []
        for leg in self.legs:
            length = 0.0
            for place in leg.waypoints or ():
                length += math.dist(here, place)
                here = Waypoint(*place)
            found.append(leg.duration_s if leg.duration_s is not None else length / leg.speed)
        return found


def load_mission(name_or_path: str | Path) -> tuple[Mission, Path]:
    """The mission of a file in configs/missions by its bare name, or of any file by its path; and its path.

    UserError with file and key if it is missing, malformed or asks for what no mission has.
    """
    path = find_config("missions", name_or_path)
    data: Mapping[str, Any] = read_yaml(path)
    return validated(path, Mission, data), path

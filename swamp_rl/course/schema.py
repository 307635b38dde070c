"""What a course file holds, and the rules that make it a course that can be sailed."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from swamp_rl.boat.merge import merge
from swamp_rl.config_kind import refuse_other_kind
from swamp_rl.constants import DAY, FASTEST_BOAT, LONGEST_BOAT, SHORTEST_BOAT, SLOWEST_BOAT
from swamp_rl.errors import UserError
from swamp_rl.files import extended_config, find_config, read_yaml, validated

Metres = Annotated[float, Field(ge=-1e6, le=1e6)]
TURN = 2.0 * math.pi  # rad


def _no_degrees(angle: Any) -> Any:
    if isinstance(angle, int | float) and TURN < abs(angle) <= 360.0:
        raise ValueError(f"must be an angle in rad, up to one turn, not {angle:g}; {_in_radians(angle)}")
    return angle


def _in_radians(degrees: float) -> str:
    return f"{degrees:g} degrees are {math.radians(degrees):.4g} rad"


Radians = Annotated[float, BeforeValidator(_no_degrees), Field(ge=-TURN, le=TURN)]
Positive = Annotated[float, Field(gt=0.0, le=1e6)]
SHORTEST, LONGEST = 1.0, DAY  # s
Seconds = Annotated[float, Field(ge=SHORTEST, le=LONGEST)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Point(_Strict):
    """A place [m]."""

    north: Metres
    east: Metres


class Pose(Point):
    """A place [m] and a heading [rad]; as a spread, how far each is drawn to either side."""

    heading: Radians


class Gate(_Strict):
    """Two buoys, `width` [m] between their centres, to be passed between along `heading` [rad]."""

    name: Annotated[str, Field(min_length=1)]
    centre: Point
    heading: Radians
    width: Positive

    @property
    def buoys(self) -> tuple[Point, Point]:
        """The centres of the port and the starboard buoy, as seen by a boat that passes."""
        north = -0.5 * self.width * math.sin(self.heading)
        east = 0.5 * self.width * math.cos(self.heading)
        return (
            Point(north=self.centre.north - north, east=self.centre.east - east),
            Point(north=self.centre.north + north, east=self.centre.east + east),
        )


class Start(_Strict):
    """Where a run begins: at `pose`, each part drawn uniformly within `spread` to either side."""

    pose: Pose
    spread: Pose

    @model_validator(mode="after")
    def _spread_is_a_distance(self) -> "Start":
        if min(self.spread.north, self.spread.east, self.spread.heading) < 0.0:
            raise ValueError("spread must not be negative; it reaches to either side of the pose")
        wide = self.spread.heading
        if wide > 1.001 * math.pi:  # or half a turn, rounded
            told = _in_radians(wide)
            raise ValueError(f"spread.heading must be at most half a turn, not {wide:g} rad; {told}")
        return self


class Bounds(_Strict):
    """The edges of the water [m]; a boat whose midship is beyond one has left the course."""

    south: Metres
    north: Metres
    west: Metres
    east: Metres

    @model_validator(mode="after")
    def _hold_some_water(self) -> "Bounds":
        if not (self.south < self.north and self.west < self.east):
            raise ValueError("south must be less than north, and west less than east")
        return self

    def contain(self, point: Point, margin: float = 0.0) -> bool:
        """Whether the point is inside, by `margin` [m] at least."""
        return (
            self.south + margin <= point.north <= self.north - margin
            and self.west + margin <= point.east <= self.east - margin
        )


class Range(_Strict):
    """A number drawn uniformly for each episode; `uniform: [least, most]`."""

    uniform: Annotated[tuple[Positive, Positive], Field(strict=False)]

    @property
    def least(self) -> float:
        """The least number."""
        return self.uniform[0]

    @property
    def draws(self) -> int:
        """How many uniforms in [0, 1) an episode takes: none where the number is always the same."""
        return int(self.uniform[0] < self.uniform[1])

    @model_validator(mode="after")
    def _least_comes_first(self) -> "Range":
        if self.uniform[0] > self.uniform[1]:
            raise ValueError("uniform must be [least, most]")
        return self


def _range(given: Any) -> Any:
    """A number as the `Range` that holds it alone."""
    given = given.item() if isinstance(given, np.number) else given
    if isinstance(given, int | float) and not isinstance(given, bool):
        if not given > 0.0:
            raise ValueError(f"must be above 0 m, not {given:g}")
        return {"uniform": [given, given]}
    if not isinstance(given, Mapping | Range):
        raise ValueError("must be a number [m], or {uniform: [least, most]}")
    return given


Depth = Annotated[Range, BeforeValidator(_range, json_schema_input_type=float | Range)]


class Course(_Strict):
    """Gates to be passed in their order, each from behind; frozen, lengths in m, `time_limit` in s.

    boat_length [m]: of the boat that it is laid out for; for a boat of another length all its lengths are
    scaled (`swamp_rl.course.fit`). boat_speed [m/s]: top speed for which that boat needs no longer limit.
    Without boat_length the course is what it is, whatever boat sails it.
    depth [m]: of the water, everywhere on it: a number, or one drawn for each episode; deep without.
    """

    name: Annotated[str, Field(min_length=1)]
    notes: str = ""
    gates: Annotated[tuple[Gate, ...], Field(min_length=1, max_length=1000, strict=False)]
    start: Start
    bounds: Bounds
    buoy_radius: Positive
    time_limit: Seconds
    boat_length: Annotated[float, Field(ge=SHORTEST_BOAT, le=LONGEST_BOAT)] | None = None
    boat_speed: Annotated[float, Field(ge=SLOWEST_BOAT, le=FASTEST_BOAT)] | None = None
    depth: Depth | None = None

    @model_validator(mode="after")
    def _can_be_sailed(self) -> "Course":
        names = [gate.name for gate in self.gates]
        if len(set(names)) != len(names):
            raise ValueError("two gates have the same name; name each differently")
        for gate in self.gates:
            if gate.width <= 2.0 * self.buoy_radius:
                raise ValueError(f"gate {gate.name}: width must be more than twice buoy_radius")
            if not all(self.bounds.contain(buoy) for buoy in gate.buoys):
                raise ValueError(f"gate {gate.name}: a buoy is outside bounds; move it or widen bounds")
        reach = max(self.start.spread.north, self.start.spread.east)
        if not self.bounds.contain(self.start.pose, reach):
            raise ValueError("the start, with its spread, is not inside bounds; move it or widen bounds")
        return self

    @property
    def buoys(self) -> tuple[Point, ...]:
        """All buoys, gate by gate, port before starboard."""
        return tuple(buoy for gate in self.gates for buoy in gate.buoys)


def limited(
    course: Course,
    time_limit: float | None,
    bounds: Mapping[Any, float] | None,
    depth: float | Mapping[str, Any] | None = None,
) -> Course:
    """The course with another time limit [s], other edges [m] by their names in `Bounds`, another depth [m].

    UserError where the limits are no numbers that a course may have, or leave out a buoy or the start.
    """
    if bounds is not None and not isinstance(bounds, Mapping):
        raise UserError(f"bounds: must be edges by name, {', '.join(Bounds.model_fields)}, not {bounds!r}")
    given: dict[str, Any] = {} if time_limit is None else {"time_limit": time_limit}
    if bounds:
        given["bounds"] = {**course.bounds.model_dump(), **bounds}
    if depth is not None:
        given["depth"] = depth
    if not given:
        return course
    return validated(f"course {course.name} with other limits", Course, {**course.model_dump(), **given})


OWN_LAYOUT = {"gates", "start", "bounds", "buoy_radius"}
LENGTHS = ("north", "east", "south", "west", "width", "buoy_radius", "depth")


def load_course(name_or_path: str | Path) -> Course:
    """The course of a file in `configs/courses` by its bare name, or of any file by its path.

    A file that `extends` another holds only what differs, key by key as a boat file (`merge`), and may lay
    the other out for a boat of another size by `scale`: all its lengths times that, its time limit times the
    square root (Froude's law). Where it has a scale or lengths of its own, it is laid out as it stands: the
    other's `boat_length` does not hold.
    UserError with file and key if it is missing, malformed or cannot be sailed.
    """
    files = course_files(name_or_path)
    whole: dict[str, Any] = read_yaml(files[-1])
    for file in reversed(files[:-1]):
        own = read_yaml(file)
        named = set(own)
        scale = own.pop("scale", 1.0)
        if isinstance(scale, bool) or not isinstance(scale, int | float) or not 0.0 < scale < math.inf:
            raise UserError(f"{file}: scale: must be a number above 0, not {scale!r}")
        del own["extends"]
        if not (OWN_LAYOUT | {"scale"}).isdisjoint(named):
            whole = {key: value for key, value in whole.items() if key not in ("boat_length", "boat_speed")}
        whole = merge({**scaled_lengths(whole, scale), "name": file.stem}, own)
    return validated(files[0], Course, whole)


def course_files(name_or_path: str | Path) -> list[Path]:
    """The course's file and those that it extends; UserError where they go round in a circle."""
    files = [find_config("courses", name_or_path)]
    while "extends" in (data := read_yaml(files[-1])):
        refuse_other_kind(files[-1], data, "course")
        files.append(extended_config("courses", files[-1], data["extends"]))
        if files[-1].resolve() in [file.resolve() for file in files[:-1]]:
            raise UserError(f"{files[-1]}: extends forms a cycle; remove one of them")
    return files


def scaled_lengths(given: Any, scale: float, key: str = "") -> Any:
    """What a course file holds under `key`, with every length times `scale`."""
    if isinstance(given, dict):
        return {
            name: scaled_lengths(value, scale, key if key in LENGTHS else name)
            for name, value in given.items()
        }
    if isinstance(given, list):
        return [scaled_lengths(item, scale, key) for item in given]
    if isinstance(given, bool) or not isinstance(given, int | float):
        return given
    times = scale if key in LENGTHS else math.sqrt(scale) if key == "time_limit" else 1.0
    return given * times

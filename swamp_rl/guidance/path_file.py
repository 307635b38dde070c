"""A path: what its YAML may hold, strictly, and the curve that it stands for."""

import math
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from swamp_rl.boat.part import FROM_LIST, NAME, Part
from swamp_rl.boat.quantity import Unit
from swamp_rl.errors import UserError
from swamp_rl.files import find_config, read_yaml, validated
from swamp_rl.guidance.curve import Curve, joined
from swamp_rl.guidance.places import CLOSEST, FARTHEST, LONGEST, Place, Start

Array = NDArray[np.float64]
Piece3 = tuple[Array, Array, Array]

ARC_STEP = math.radians(1.0)
SPLINE_STEPS = 64  # between two places
MOST_PLACES = 500_000  # of a curve
Radius = Annotated[float, Field(ge=CLOSEST, le=FARTHEST), Unit("m")]


class Line(Part):
    """A straight line to a place."""

    kind: Literal["line"]
    "A straight line."
    to: Place
    "End of the line [north, east] in m."


class Arc(Part):
    """A circular arc that leaves on the course of the piece before it."""

    kind: Literal["arc"]
    "A circular arc."
    radius: Radius
    "Radius of the circle."
    turn_deg: Annotated[float, Field(ge=-36000.0, le=36000.0), Unit("deg")]
    "Change of course, positive to starboard; may be more than a turn."

    @model_validator(mode="after")
    def _turns(self) -> Self:
        if abs(self.turn_deg) < 1.0:
            raise ValueError("turn_deg: at least a degree either way; use a line instead")
        return self


class Spline(Part):
    """A natural cubic spline from the end of the piece before it through places."""

    kind: Literal["spline"]
    "A cubic spline."
    through: Annotated[tuple[Place, ...], FROM_LIST, Field(min_length=2, max_length=1000)]
    "Places [north, east] in m."


class LawnMower(Part):
    """Parallel lines joined by half circles, the first on the course of the piece before it."""

    kind: Literal["lawn_mower"]
    "Parallel lines joined by half circles."
    length: Radius
    "Length of a line."
    spacing: Radius
    "Distance between two lines."
    lines: Annotated[int, Field(ge=2, le=1000)]
    "Number of lines."
    side: Literal["starboard", "port"] = "starboard"
    "Side on which the next line lies."


class Eight(Part):
    """The eight-shaped double circle of thesis 8.1.4: full turns to starboard, then as many to port."""

    kind: Literal["eight"]
    "Two circles that touch."
    radius: Radius
    "Radius of each circle."
    turns: Annotated[int, Field(ge=1, le=100)] = 1
    "Turns of each circle."


Piece = Annotated[Line | Arc | Spline | LawnMower | Eight, Field(discriminator="kind")]


class PathFile(Part):
    """A path file, whole."""

    name: Annotated[str, NAME]
    "Name in reports."
    description: str = ""
    "For people."
    speed: Annotated[float, Field(gt=0.0, le=50.0), Unit("m/s")]
    "Over ground; less where the boat could not turn as fast as the curve does."
    start: Start = Start()
    "Start of the path, and the course of a first piece that is an arc or lines."
    pieces: Annotated[tuple[Piece, ...], FROM_LIST, Field(min_length=1, max_length=1000)]
    "Pieces, in their order."

    @model_validator(mode="after")
    def _has_an_end(self) -> Self:
        length = self.curve().length
        if length > LONGEST * self.speed:
            raise ValueError(
                f"pieces: {length:.6g} m take more than a day at {self.speed:g} m/s; divide the path"
            )
        return self

    def curve(self) -> Curve:
        """The curve of all its pieces; ValueError for two places that lie too close, and for MOST_PLACES."""
        here = np.array([self.start.north, self.start.east])
        course, parts, count = math.radians(self.start.course_deg), [], 0
        for number, piece in enumerate(self.pieces):
            for part in _parts(piece, here, course, number):
                here, course = part[0][-1], float(part[1][-1])
                parts.append(part)
                count += len(part[0])
            if count > MOST_PLACES:
                raise ValueError(
                    f"pieces.{number}: the curve has more than {MOST_PLACES} places; divide the path"
                )
        return joined(parts)


def _parts(piece: Any, here: Array, course: float, number: int) -> list[Piece3]:
    """Places (n, 2), course (n,) and curvature (n,) of each part of a piece."""
    if isinstance(piece, Line):
        return [_line(here, np.array(piece.to), number)]
    if isinstance(piece, Arc):
        return [arc(here, course, piece.radius, math.radians(piece.turn_deg))]
    if isinstance(piece, Spline):
        return [spline(np.vstack([here, np.array(piece.through)]), f"pieces.{number}.through")]
    if isinstance(piece, Eight):
        turn = 2.0 * math.pi * piece.turns
        return [arc(here, course, piece.radius, sign * turn) for sign in (1.0, -1.0)]
    found: list[Piece3] = []
    for line in range(piece.lines):
        if line:
            side = 1.0 if (line % 2 == 1) == (piece.side == "starboard") else -1.0
            found.append(arc(here, course, 0.5 * piece.spacing, side * math.pi))
            here, course = found[-1][0][-1], float(found[-1][1][-1])
        end = here + piece.length * np.array([math.cos(course), math.sin(course)])
        found.append(_line(here, end, number))
        here = end
    return found


def _line(here: Array, end: Array, number: int) -> Piece3:
    if math.dist(here, end) < CLOSEST:
        raise ValueError(f"pieces.{number}: begins within {CLOSEST:g} m of its end; drop it")
    course = math.atan2(end[1] - here[1], end[0] - here[0])
    return np.array([here, end]), np.full(2, course), np.zeros(2)


def arc(here: Array, course: float, radius: float, turn: float) -> Piece3:
    """A circular arc from `here` (2,) [m] on `course` [rad] through `turn` [rad], positive to starboard."""
    angle = np.linspace(0.0, turn, max(2, math.ceil(abs(turn) / ARC_STEP) + 1))
    side = math.copysign(1.0, turn)
    centre = here + radius * side * np.array([-math.sin(course), math.cos(course)])
    heading = course + angle
    places = centre - radius * side * np.stack([-np.sin(heading), np.cos(heading)], axis=1)
    return places, heading, np.full(len(angle), side / radius)


def spline(places: Array, where: str) -> Piece3:
    """A natural cubic spline through places (n, 2) [m], by the chord's length.

    ValueError, beginning with `where`, for two of them that lie too close.
    """
    from scipy.interpolate import CubicSpline

    chord = np.hypot(*np.diff(places, axis=0).T)
    if chord.min() < CLOSEST:
        raise ValueError(f"{where}: two places lie within {CLOSEST:g} m; drop one of them")
    knots = np.concatenate([[0.0], np.cumsum(chord)])
    curve = CubicSpline(knots, places, bc_type="natural")
    at = np.unique(np.concatenate([np.linspace(a, b, SPLINE_STEPS + 1) for a, b in pairwise(knots)]))
    way, bend = curve(at, 1), curve(at, 2)
    curvature = (way[:, 0] * bend[:, 1] - way[:, 1] * bend[:, 0]) / np.hypot(*way.T) ** 3
    return curve(at), np.unwrap(np.arctan2(way[:, 1], way[:, 0])), curvature


def load_path(name_or_path: str | Path) -> tuple[PathFile, Path]:
    """The path of a file in configs/paths by its bare name, or of any file by its path; and that file.

    UserError with file and key if it is missing, malformed or no path.
    """
    path = find_config("paths", name_or_path)
    data: Mapping[str, Any] = read_yaml(path)
    return validated(path, PathFile, data), path


def speeds_of(path: PathFile, top_speed: float, where: object) -> float:
    """The path's speed [m/s]; UserError where the boat's top speed in still water is below it."""
    if path.speed > top_speed:
        raise UserError(
            f"{where}: speed: {path.speed:g} m/s is above {top_speed:.3g} m/s, the boat's top speed; "
            "go slower"
        )
    return path.speed

"""What files of paths and missions say of places: coordinates, directions, and their limits."""

from typing import Annotated

from pydantic import Field

from swamp_rl.boat.part import FROM_LIST, Part
from swamp_rl.boat.quantity import Unit
from swamp_rl.constants import DAY

FARTHEST = 1e6  # m
CLOSEST = 0.1  # m between two places that follow one another
LONGEST = DAY  # s
Coordinate = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST)]
Degrees = Annotated[float, Field(ge=-360.0, le=360.0)]
Place = Annotated[tuple[Coordinate, Coordinate], FROM_LIST]


class Start(Part):
    """Where a path or a mission begins."""

    north: Annotated[Coordinate, Unit("m")] = 0.0
    "Place."
    east: Annotated[Coordinate, Unit("m")] = 0.0
    "Place."
    course_deg: Annotated[Degrees, Unit("deg")] = 0.0
    "Heading."

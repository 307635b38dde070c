"""What files of paths and missions say of places: coordinates, directions, and their limits."""

from typing import Annotated

from pydantic import Field

from swamp_rl.boat.part import FROM_LIST

FARTHEST = 1e6  # m
CLOSEST = 0.1  # m between two places that follow one another
LONGEST = 86_400.0  # s, a day
Coordinate = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST)]
Degrees = Annotated[float, Field(ge=-360.0, le=360.0)]
Place = Annotated[tuple[Coordinate, Coordinate], FROM_LIST]

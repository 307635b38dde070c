"""Whether the runs and the pilots of one boat serve another: by thrusters and size."""

from collections.abc import Mapping
from typing import NamedTuple

from swamp_rl.boat.schema import Boat

GREATEST_RATIO = 1.25
"Of the lengths of two boats; beyond it the distances that a pilot has learned are those of another boat."


class Build(NamedTuple):
    """What a pilot's levers act on, and the size of its turns."""

    length: float
    "[m]"
    thrusters: Mapping[str, str]
    "Kinds by name."

    def __str__(self) -> str:
        thrusters = ", ".join(f"{kind} {name}" for name, kind in self.thrusters.items())
        return f"{self.length:g} m, thrusters {thrusters}"

    def serves(self, other: "Build") -> bool:
        """Whether the thrusters are the same, in any order, and the lengths within GREATEST_RATIO."""
        longer, shorter = sorted((self.length, other.length), reverse=True)
        return dict(self.thrusters) == dict(other.thrusters) and longer <= GREATEST_RATIO * shorter


def build_of(boat: Boat) -> Build:
    """Of a boat file, whatever its mass, its coefficients and its effects."""
    return Build(boat.length, {thruster.name: thruster.kind for thruster in boat.thrusters})

"""Identity of a boat by its numbers, whatever its name and the sources of the numbers."""

import hashlib
import json
from dataclasses import replace
from typing import Any

from swamp_rl.boat.schema import Boat
from swamp_rl.effects import EffectEntry

NO_MOTION: Any = {
    "name": True,
    "effects": True,
    "loading": True,
    "battery": True,
    "covariance": True,
    "thrusters": {"__all__": {"power"}},
}
"Keys without an effect on the motion, and the effects, which are listed by their values."
NEUTRAL = (
    ("power", None),
    ("dead_band", 0.0),
    ("throttle_rate", None),
    ("propeller", None),
    ("thrust_table", None),
    ("foil", None),
    ("open_water", None),
)
"Keys of a thruster that are left out at these values, so that boat files without them keep their digest."


def boat_digest(boat: Boat) -> str:
    """Return the SHA-256 of what acts on a boat's motion: particulars, coefficients, joypad, effects."""
    numbers = boat.model_dump(mode="json", exclude=NO_MOTION)
    numbers["thrusters"] = [_without_neutral(thruster) for thruster in numbers["thrusters"]]
    numbers["effects"] = [_effect(entry) for entry in boat.effects]
    return hashlib.sha256(json.dumps(numbers, sort_keys=True).encode()).hexdigest()


def _effect(entry: EffectEntry) -> list[Any]:
    numbers = [entry.effect.name, entry.thruster, dict(entry.values)]
    if entry.curve is None:
        return numbers
    return [*numbers, replace(entry.curve, standard_errors=()).mapping(entry.values)]


def _without_neutral(thruster: dict[str, Any]) -> dict[str, Any]:
    left = {key: value for key, value in thruster.items() if (key, value) not in NEUTRAL}
    return {key: _without_neutral(value) if isinstance(value, dict) else value for key, value in left.items()}

"""A boat recognised by its numbers, whatever its file is called or says about their sources."""

import hashlib
import json
from typing import Any

from swamp_rl.boat.schema import Boat

GAINED = (("dead_band", 0.0),)


def boat_digest(boat: Boat) -> str:
    """SHA-256 of a boat's particulars, coefficients, joypad and effects; not of its name and its sources."""
    told = boat.model_dump(mode="json", exclude={"name", "effects"})
    told["thrusters"] = [_without_neutral(thruster) for thruster in told["thrusters"]]
    told["effects"] = [[entry.effect.name, entry.thruster, dict(entry.values)] for entry in boat.effects]
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


def _without_neutral(thruster: dict[str, Any]) -> dict[str, Any]:
    """A thruster less the keys that boat files gained later, where they say nothing: the digest stays."""
    return {key: value for key, value in thruster.items() if (key, value) not in GAINED}

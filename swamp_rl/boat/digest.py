"""A boat recognised by its numbers, whatever its file is called or says about their sources."""

import hashlib
import json

from swamp_rl.boat.schema import Boat


def boat_digest(boat: Boat) -> str:
    """SHA-256 of a boat's particulars, coefficients, joypad and effects; not of its name and its sources.

    Neither of its battery and its thrusters' electric power, which do not act on its motion.
    """
    idle = {"name": True, "effects": True, "battery": True, "thrusters": {"__all__": {"power"}}}
    told = boat.model_dump(mode="json", exclude=idle)
    told["effects"] = [[entry.effect.name, entry.thruster, dict(entry.values)] for entry in boat.effects]
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()

"""The library: every effect there is, one declaration each. Names and units are the project's vocabulary."""

from swamp_rl.effects.library import actuators, environment, hull, sensors

__all__ = ["actuators", "environment", "hull", "sensors"]

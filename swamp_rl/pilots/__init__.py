"""Pilots: observation in, joypad out. One that is scripted, and those that learn."""

from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.store import load_pilot, save_pilot

__all__ = ["Pilot", "load_pilot", "save_pilot"]

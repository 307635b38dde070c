"""Pilots: observation in, joypad out. One that is scripted, and those that learn."""

import os

from swamp_rl.pilots.arguments import load_pilot
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.store import save_pilot

# Every optimiser of torch makes the folder of torch's compiler, by default in the temporary directory.
_cache = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
if os.access(_cache if os.path.isdir(_cache) else os.path.dirname(_cache), os.W_OK):
    os.environ.setdefault("TORCHINDUCTOR_CACHE_DIR", os.path.join(_cache, "torchinductor"))

__all__ = ["Pilot", "load_pilot", "save_pilot"]

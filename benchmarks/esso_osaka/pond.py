"""The measured pond tests of the Esso Osaka model ship, read once; they are not part of the project."""

from functools import lru_cache
from pathlib import Path

from swamp_rl.boat import load_boat
from swamp_rl.runs import Run
from swamp_rl.runs.free_running import import_free_running

DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "esso_osaka"
BOAT = load_boat("esso_osaka")


@lru_cache(maxsize=32)
def pond(name: str) -> Run:
    """The run of that file below `DATA`."""
    return import_free_running(DATA / name, BOAT)

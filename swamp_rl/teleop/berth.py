"""A boat that a recorder offers: the levels of disturbance it can meet, and the dataset of its runs."""

from collections.abc import Callable
from dataclasses import dataclass

from swamp_rl.teleop.afloat import MakeEnv
from swamp_rl.teleop.recordings import Recordings


@dataclass(frozen=True)
class Berth:
    """What is there for one boat; its dataset is opened when it is first chosen."""

    make_env: MakeEnv
    levels: tuple[str, ...]
    "Names that `make_env` knows, the first one chosen."
    open_recordings: Callable[[], Recordings]

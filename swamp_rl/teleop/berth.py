"""A boat that a recorder offers: the levels of disturbance it can meet, and the dataset of its runs."""

from collections.abc import Callable
from dataclasses import dataclass

from swamp_rl.teleop.craft import Craft
from swamp_rl.teleop.recordings import Recordings


@dataclass(frozen=True)
class Berth:
    """What is there for one boat; its dataset is opened when it is first chosen."""

    make_craft: Callable[[str, tuple[str, ...]], Craft]
    "Of a level of disturbance, observed by the given names."
    levels: tuple[str, ...]
    "Names that `make_craft` knows, the first one chosen."
    open_recordings: Callable[[], Recordings]

"""Effects of a level of disturbance that the boat file has already."""

from collections.abc import Mapping, Sequence

from swamp_rl.boat import Boat
from swamp_rl.effects.apply import selected
from swamp_rl.effects.entries import EffectEntry
from swamp_rl.effects.levels import read_level
from swamp_rl.effects.random_entry import RandomEntry
from swamp_rl.simulator.reference import size_of


def effects_twice(boat: Boat, levels: Mapping[str, str]) -> list[str]:
    """One line for each level, by level its key in the experiment, with effects that `boat` has too and that
    add up or multiply: both act.

    So does the level that `swamp-rl disturbances` writes of a diagnosis, on the boat that this extended.
    """
    lines = list[str]()
    for level, key in levels.items():
        entries = read_level(level, size_of(boat), boat.thruster_names)[1].entries
        twice = [own for own in boat.effects if any(_adds(own, one, boat.thruster_names) for one in entries)]
        if twice:
            labels = ", ".join(one.label for one in twice)
            lines.append(
                f"{key}: {level}: {labels}: also in boat {boat.name}, and both act; if they are the same, "
                "name a boat or a level without"
            )
    return lines


def _adds(own: EffectEntry, other: RandomEntry, names: Sequence[str]) -> bool:
    if own.effect is not other.effect or own.effect.combine == "replace":
        return False
    mine = selected(own.thruster, names)
    return any((mine & selected(one, names)).any() for one in other.selectors)

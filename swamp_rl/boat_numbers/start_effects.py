"""Effects of the start file on the numbers that a fit moves: a number starts where they leave it."""

from collections.abc import Iterable, Sequence

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.boat_numbers.number import Number
from swamp_rl.effects import EffectEntry
from swamp_rl.effects.apply import selected
from swamp_rl.simulator import parameters

Place = tuple[str, int]  # a field of the record, and which of its thrusters (0 where it has one number)


def free_of_effects(numbers: Sequence[Number], boat: Boat) -> tuple[Number, ...]:
    """The numbers without those that an effect alters together with what none of the numbers is: such an
    effect stays as it is in the file.
    """
    held = [
        altered
        for entry in boat.effects
        if not (altered := _altered(entry, boat)) <= {place for one in numbers for place in _places(one)}
    ]
    free = tuple(one for one in numbers if not any(_places(one) & altered for altered in held))
    return free if len(free) == len(numbers) else free_of_effects(free, boat)


def in_numbers(boat: Boat, numbers: Iterable[Number]) -> tuple[list[EffectEntry], set[Place]]:
    """The effects of the boat that alter none of the numbers, nor what those alter that do; and the places
    that the others alter.
    """
    places = {place for one in numbers for place in _places(one)}
    within: set[Place] = set()
    left = list(boat.effects)
    while met := [entry for entry in left if _altered(entry, boat) & places]:
        within |= {place for entry in met for place in _altered(entry, boat)}
        places |= within
        left = [entry for entry in left if entry not in met]
    return left, within


def lies_at(number: Number, places: set[Place]) -> bool:
    """Whether the number is at one of the places."""
    return bool(_places(number) & places)


def _places(number: Number) -> set[Place]:
    return {(number.field, k) for k in number.thrusters or (0,)}


def _altered(entry: EffectEntry, boat: Boat) -> set[Place]:
    record, names = parameters(boat), boat.thruster_names
    altered = set()
    for parameter in entry.effect.parameters:
        if entry.values[parameter.name] == parameter.neutral:
            continue
        per_thruster = record[parameter.field].ndim == 2
        thrusters = np.flatnonzero(selected(entry.thruster, names)).tolist() if per_thruster else [0]
        altered |= {(parameter.field, k) for k in thrusters}
    return altered

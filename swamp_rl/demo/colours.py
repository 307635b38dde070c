"""One colour for each driver, the same in films, recordings, pages and figures."""

import zlib
from collections.abc import Iterable

Colour = tuple[int, int, int]

PEOPLE = ("human", "scripted", "measured")
"""Who is named first."""
DRIVERS: dict[str, Colour] = {
    "human": (255, 140, 0),
    "measured": (255, 140, 0),
    "scripted": (120, 130, 140),
    "reservoir": (66, 146, 230),
    "cloning": (170, 120, 220),
    "gru": (23, 190, 207),
    "dagger": (150, 100, 60),
    "ppo": (227, 119, 194),
    "sac": (188, 189, 34),
    "line-of-sight": (0, 150, 125),
}
PALETTE: tuple[Colour, ...] = tuple(dict.fromkeys(DRIVERS.values()))
OTHERS: tuple[Colour, ...] = tuple(one for one in PALETTE if one not in {DRIVERS[who] for who in PEOPLE})
"""Colours of drivers that are not in `DRIVERS`: none of the data, beside which some figures show them."""


def driver_colours(drivers: Iterable[str]) -> dict[str, Colour]:
    """The colour of each driver, in RGB of 0 to 255.

    Drivers of `DRIVERS` (`human Anna` too) keep theirs whoever else is shown; of several that begin alike the
    first by name does. Any other has one by a hash of its name, or the next that is free; where none is,
    colours repeat.
    """
    names = list(dict.fromkeys(drivers))
    keeps = {name.split(" ")[0]: name for name in sorted(names, reverse=True)}
    found = {name: DRIVERS[driver] for driver, name in keeps.items() if driver in DRIVERS}
    for name in sorted(set(names) - set(found)):
        first = zlib.crc32(name.encode()) % len(OTHERS)
        ahead = OTHERS[first:] + OTHERS[:first]
        found[name] = next((one for one in ahead if one not in found.values()), ahead[0])
    return {name: found[name] for name in names}


def fractions(colour: Colour) -> tuple[float, float, float]:
    """RGB of 0 to 1, as matplotlib has it."""
    red, green, blue = colour
    return red / 255.0, green / 255.0, blue / 255.0

"""How `swamp-rl boat new` estimates each number, from the files that it writes."""

from collections.abc import Iterator
from typing import Any

from docs.generate.markdown import table
from swamp_rl.boat.estimate import KINDS, boat_file
from swamp_rl.boat.merge import leaves

LENGTH, BREADTH, MASS, THRUST = 1.2, 0.5, 30.0, 40.0  # m, m, kg, N
SHARED = "all"


def estimates() -> str:
    """A table of each key, the kinds of boats that have it, and where its number comes from."""
    found: dict[tuple[str, str], tuple[list[str], str]] = {}
    for kind in KINDS:
        for key, quantity in _quantities(boat_file("boat", kind, LENGTH, BREADTH, MASS, THRUST)):
            kinds, _ = found.setdefault((key, quantity["source"]), ([], quantity["unit"]))
            if kind not in kinds:
                kinds.append(kind)
    rows = [
        [f"`{key}`", unit, SHARED if len(kinds) == len(KINDS) else ", ".join(kinds), source]
        for (key, source), (kinds, unit) in found.items()
    ]
    return table(["key", "unit", "kinds", "estimate"], rows)


def _quantities(content: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every number by its dotted key, thrusters without their names."""
    for path, leaf in leaves(content):
        if isinstance(leaf, dict):
            yield ".".join(path[:1] + path[2:] if path[0] == "thrusters" else path), leaf

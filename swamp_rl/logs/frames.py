"""Positions, attitudes and velocities of ENU and NED frames as columns of a run."""

import math
from collections.abc import Callable
from collections.abc import Mapping as Mapped

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.errors import UserError
from swamp_rl.logs.mapping import Frame, Mapping

Array = NDArray[np.float64]

QUATERNION = ("qw", "qx", "qy", "qz")
TOGETHER = (("x", "y"), QUATERNION, ("vx", "vy"), ("velocity_north", "velocity_east"))
"""Columns of which all or none must be mapped."""
BECOMES = {
    "x": "north",
    "y": "east",
    **dict.fromkeys(("yaw", *QUATERNION), "heading"),
    **dict.fromkeys(("u", "vx", "velocity_north"), "surge"),
    **dict.fromkeys(("v", "vy", "velocity_east"), "sway"),
    "r": "yaw_rate",
}
"""Columns of a run by the mapped quantities that `in_our_frame` makes them of, in NED."""
EXCHANGED = {"x": "y", "y": "x", "vx": "vy", "vy": "vx"}
"""Axes of ENU by those of NED."""
TURNED = (*QUATERNION, "vx", "vy", "velocity_north", "velocity_east")
"""Quantities of which several make a column of a run."""


def column_of(name: str, mapping: Mapping) -> str:
    """The column of a run that a quantity of a mapping becomes; of a velocity over ground, which gives surge
    and sway, the one that has most of it at heading 0."""
    name = EXCHANGED.get(name, name) if mapping.frame_of(name) == "enu" else name
    return BECOMES.get(name, name)


def names_by_column(mapping: Mapping) -> dict[str, str]:
    """The quantities of a mapping by the columns of a run that each alone becomes."""
    return {column_of(name, mapping): name for name in mapping.columns if name not in TURNED}


def refuse_halves(names: Mapped[str, object]) -> None:
    """UserError where a mapping has part of a group, or two sources of one column."""
    for group in TOGETHER:
        missing = [name for name in group if name not in names]
        if 0 < len(missing) < len(group):
            raise UserError(f"the mapping has no {missing[0]}; give all of {', '.join(group)}")
    for ours, others in (
        ("north", ("x", "latitude")),
        ("heading", ("yaw", "qw")),
        ("yaw", ("qw",)),
        ("surge", ("u", "vx", "velocity_north")),
        ("u", ("vx", "velocity_north")),
        ("vx", ("velocity_north",)),
        ("yaw_rate", ("r",)),
    ):
        twice = [name for name in others if ours in names and name in names]
        if twice and (ours, twice[0]) != ("north", "latitude"):
            raise UserError(
                f"the mapping gives {ours} and {twice[0]}, which are one column of a run; drop one"
            )


def in_our_frame(columns: Mapped[str, Array], frame_of: Callable[[str], Frame]) -> dict[str, Array]:
    """Columns (T,) of a run from those that a mapping gave, each in the frame given for its name.

    NED: x north, y east, z down, yaw clockwise from north; body axes forward, starboard, down.
    ENU: x east, y north, z up, yaw counterclockwise from east; body axes forward, port, up (REP 103).
    """
    found = dict(columns)
    for first, second, ours in (
        ("x", "y", ("north", "east")),
        ("vx", "vy", ("velocity_north", "velocity_east")),
    ):
        if first in found:
            pair = found.pop(first), found.pop(second)
            found |= zip(ours, pair[::-1] if frame_of(first) == "enu" else pair, strict=True)
    if "yaw" in found:
        yaw = found.pop("yaw")
        found["heading"] = wrapped(0.5 * math.pi - yaw if frame_of("yaw") == "enu" else yaw)
    if "velocity_north" in found:
        if "heading" not in found:
            raise UserError("velocities over ground need the heading; map heading, yaw or qw, qx, qy, qz too")
        north, east = found.pop("velocity_north"), found.pop("velocity_east")
        cos, sin = np.cos(found["heading"]), np.sin(found["heading"])
        found["surge"], found["sway"] = north * cos + east * sin, east * cos - north * sin
    for given, side in (("u", 1.0), ("v", -1.0), ("r", -1.0)):
        if given in found:
            found[BECOMES[given]] = found.pop(given) * (side if frame_of(given) == "enu" else 1.0)
    return found

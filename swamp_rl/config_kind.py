"""Which kind of configuration file a mapping is, by the keys that only files of this kind have."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from swamp_rl.errors import UserError

MARKS = {
    "boat": {
        *("mass", "draught", "inertia_z", "x_g", "added_mass_surge", "hull", "resistance"),
        *("thrusters", "thrust_deduction", "joypad", "battery"),
    },
    "course": {"gates", "buoy_radius", "boat_speed"},
    "path": {"pieces"},
    "mission": {"legs", "reserve", "charge"},
    "trial": {"trials", "area", "full_rpm"},
    "design": {"design"},
    "vehicle": {"surge_mass", "yaw_inertia", "surge_drag", "yaw_moment"},
    "experiment": {"pilots", "evaluation", "targets", "claims"},
    "sweep": {"experiment", "parameters", "objective", "batch"},
}
"""By the word that stands before `file` in a message."""
HINTS = {("boat", "experiment"): ", whose key boat names this one"}
"""By the kind that was given and the one that is needed."""
DISTURBANCE = {"description", "boat", "start", "effects"}
"""All keys of a disturbance file; it has none that others do not have."""


def config_kind(keys: Iterable[str]) -> str | None:
    """The kind of file that has these keys at its top, None where they are of none or of several alike."""
    held = set(keys)
    found = {kind: len(held & marks) for kind, marks in MARKS.items()}
    best = [kind for kind, count in found.items() if count == max(found.values()) > 0]
    if not best and "effects" in held and held <= DISTURBANCE:
        return "disturbance"
    return best[0] if len(best) == 1 else None


def refuse_other_kind(path: Path | str, data: Mapping[str, Any], needed: str) -> None:
    """UserError where the file at `path` holds no key of the kind needed and is of another kind."""
    kind = config_kind(data)
    if kind is not None and kind != needed and MARKS.get(needed, set()).isdisjoint(data):
        hint = HINTS.get((kind, needed), "")
        raise UserError(f"{path}: is {one_file(kind)}; {one_file(needed)} is needed here{hint}")


def one_file(kind: str) -> str:
    """`a boat file`, `an experiment file`."""
    return f"{'an' if kind == 'experiment' else 'a'} {kind} file"

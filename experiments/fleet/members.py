"""The datasets of a fleet: whose they are, and the names of their folders in the fleet's."""

import os
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from swamp_rl.experiments.fleet.result import Member

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.names import plain_name, told_apart
from swamp_rl.runs.dataset import read_meta


def members_of(datasets: Sequence[Path], boat: str | None = None) -> list[Member]:
    """The datasets sorted by name. Where they lie in several folders, a folder is a boat and its datasets are
    that boat's days, a boat for each vehicle that they name unless `boat` is given; where all lie in one
    folder, each is a boat of its own. UserError for one that is no folder or is given twice.
    """
    whole = [Path(os.path.abspath(one)) for one in datasets]
    _refuse_twice(whole)
    folders = {path.parent for path in whole}
    several = len(folders) > 1
    labels = told_apart(folders)
    found = []
    for path, one in zip(whole, datasets, strict=True):
        own = labels[path.parent] if several else (path.name,)
        try:
            name = plain_name("_".join((*own, path.name) if several else own))
        except ValueError as error:
            raise UserError(f"{clipped(one, 200)}: names no folder of a fleet, {error}; rename it") from error
        found.append(Member(name=name, boat="/".join(own), dataset=str(one), boat_file=boat))
    _refuse_same_names(found)
    for one in datasets:
        if not one.is_dir():
            raise UserError(f"{clipped(one, 200)}: no such folder; name folders that hold a dataset.yaml")
    if several and boat is None:
        found = _by_vehicle(found)
    return sorted(found, key=lambda one: one.name)


def _refuse_twice(paths: Sequence[Path]) -> None:
    """UserError for a dataset that is given twice, also by the path of a link: its runs would count twice."""
    same = defaultdict[str, list[str]](list)
    for path in paths:
        same[os.path.realpath(path)].append(clipped(str(path), 200))
    for given in same.values():
        if len(given) > 1:
            names = list(dict.fromkeys(given))
            fault = "are the same folder" if len(names) > 1 else f"is given {len(given)} times"
            raise UserError(f"{' and '.join(names)}: {fault}; name each dataset once")


def _refuse_same_names(members: Sequence[Member]) -> None:
    """UserError where two datasets would have one folder, on a file system that ignores the case."""
    named = defaultdict[str, list[Member]](list)
    for member in members:
        named[member.name.lower()].append(member)
    for first, *others in named.values():
        if others:
            raise UserError(
                f"{clipped(first.dataset, 200)} and {clipped(others[0].dataset, 200)}: both would be named "
                f"{first.name} in the fleet; rename a folder"
            )


def _by_vehicle(members: Sequence[Member]) -> list[Member]:
    """The same, FOLDER/VEHICLE the boat where the datasets of a folder name several vehicles."""
    vehicles = {member.name: _vehicle(Path(member.dataset)) for member in members}
    named: dict[str, set[str]] = {}
    for member in members:
        named.setdefault(member.boat, set()).update(vehicles[member.name])
    return [
        member.model_copy(update={"boat": "/".join((member.boat, *vehicles[member.name]))})
        if len(named[member.boat]) > 1
        else member
        for member in members
    ]


def _vehicle(dataset: Path) -> tuple[str, ...]:
    """What a dataset names as its vehicle; empty where it cannot be read, which its diagnosis tells."""
    try:
        return (read_meta(dataset).vehicle,)
    except (UserError, OSError):
        return ()

"""Which folder may be replaced by a new result: one that holds nothing but what a command wrote into it."""

import os
from collections.abc import Collection
from pathlib import Path, PurePosixPath

from swamp_rl.clipped import clipped
from swamp_rl.counted import counted
from swamp_rl.errors import UserError
from swamp_rl.files import UNFINISHED, os_error, refuse_name_of_file
from swamp_rl.sums import new_since, write_sums

WRITTEN = ".written"
"""In a folder, the list of all that the command wrote into it, in the form of `SHA256SUMS`."""
LITTER = (".DS_Store", "Thumbs.db", "desktop.ini", "__pycache__")
"""Of operating systems and of Python; nobody's work, as are names that begin with one of NOBODYS."""
NOBODYS = (*UNFINISHED, "._")
NAMED = 3
"""Files that a refusal names."""


def list_written(folder: Path) -> None:
    """Write WRITTEN of all that lies in `folder`, which the command has just written; none if it is empty."""
    if any(folder.iterdir()):
        write_sums(folder, WRITTEN)


def refuse_to_replace(path: Path, replaces: Collection[str], derived: Collection[str] = ()) -> None:
    """UserError unless folder `path` is absent, empty, or holds one of the files named `replaces` and nothing
    that was added or changed since a command wrote it.

    derived: folders in it, with lists of their own, that go with what they were made from. A folder without a
    list, as earlier versions wrote them, is replaced with all that it holds. OSError -> UserError.
    """
    refuse_name_of_file(path)
    if path.is_symlink():
        raise UserError(f"{path}: is a link, a folder was to be written here; name that or remove the link")
    if not path.exists():
        return
    if not path.is_dir():
        raise UserError(f"{path}: is a file, a folder was to be written here; name another or remove it")
    ours = any((path / name).exists() for name in replaces)
    if not ours and any(path.iterdir()):
        raise UserError(
            f"{path}: already exists and is not an earlier result; name another folder or remove it"
        )
    try:
        new = _new_in(path, derived)
    except OSError as error:
        raise os_error(error, path) from error
    if new:
        names = ", ".join(clipped(name) for name in new[:NAMED])
        more = f" and {counted(len(new) - NAMED, 'more file')}" if len(new) > NAMED else ""
        raise UserError(
            f"{path}: is not replaced, as {names}{more} in it came or changed after it was written; move or "
            "remove such files, or name another folder"
        )


def _new_in(folder: Path, derived: Collection[str] = ()) -> list[str]:
    """Paths from `folder` of what came or changed since its list was written; none if it has no list."""
    if not os.path.lexists(folder / WRITTEN):
        return []
    listed = [name for name in derived if os.path.lexists(folder / name / WRITTEN)]
    paths = [PurePosixPath(name) for name in new_since(folder, WRITTEN)]
    new = [str(path) for path in paths if path.parts[0] not in listed and not _is_litter(path)]
    return new + [f"{name}/{inside}" for name in listed for inside in _new_in(folder / name)]


def _is_litter(path: PurePosixPath) -> bool:
    return any(part in LITTER or part.startswith(NOBODYS) for part in path.parts)

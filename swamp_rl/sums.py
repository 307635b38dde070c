"""`SHA256SUMS` beside exported files, as `sha256sum` writes and checks them."""

import hashlib
import os
import re
from collections.abc import Iterator
from pathlib import Path

from swamp_rl.errors import UserError
from swamp_rl.ordinary import MOST_JSON, contents

SUMS = "SHA256SUMS"
_LINE = re.compile(r"([0-9a-f]{64})  (.+)")


def write_sums(folder: Path, name: str = SUMS) -> None:
    """Write the SHA-256 of every file in and below `folder`, by its path from there, into its file `name`."""
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path != folder / name)
    lines = "".join(f"{_digest(file)}  {file.relative_to(folder).as_posix()}\n" for file in files)
    (folder / name).write_text(lines, encoding="utf-8")


def new_since(folder: Path, name: str) -> Iterator[str]:
    """The paths from `folder` of what lies in and below it now and did not, or with other bytes, when its
    file `name` was written by `write_sums`: all, where that cannot be read. Folders alone are nothing; a link
    is one path and is not followed. OSError where something cannot be read.
    """
    try:
        lines = contents(folder / name, MOST_JSON, follow=False).decode("utf-8").split("\n")
    except (OSError, UnicodeDecodeError):
        lines = []
    sums = {match[2]: match[1] for match in map(_LINE.fullmatch, lines) if match}
    for path in all_but_folders(folder):
        found = path.relative_to(folder).as_posix()
        same = found in sums and not path.is_symlink() and path.is_file() and _digest(path) == sums[found]
        if not same and found != name:
            yield found


def all_but_folders(folder: Path) -> list[Path]:
    """The files, links and the like in and below a folder, sorted; OSError for a folder not readable."""
    found = []
    for top, folders, files in os.walk(folder, onerror=_raise):
        links = [name for name in folders if Path(top, name).is_symlink()]
        found += [Path(top, name) for name in (*links, *files)]
    return sorted(found)


def _raise(error: OSError) -> None:
    raise error


def changed(folder: Path) -> list[str]:
    """What is wrong with the files of a folder by its `SHA256SUMS`, a line each; none if it has none."""
    path = folder / SUMS
    if not path.exists():
        return []
    try:
        lines = contents(path, MOST_JSON).decode("utf-8").splitlines()
    except (OSError, UnicodeDecodeError):
        return [f"{SUMS} cannot be read; export the dataset again"]
    found = []
    for number, line in enumerate(lines, 1):
        match = _LINE.fullmatch(line)
        file = _listed(folder, match[2]) if match else None
        if match is None or file is None:
            found.append(
                f"{SUMS} line {number}: is not a checksum of a file in this folder; export the dataset again"
            )
        elif not file.is_file():
            found.append(f"{match[2]}: is listed in {SUMS} but is not here; export the dataset again")
        elif _digest(file) != match[1]:
            found.append(
                f"{match[2]}: its SHA-256 is not the one in {SUMS}; export the dataset again, or remove "
                f"{SUMS} if it was changed on purpose"
            )
    return found


def _listed(folder: Path, name: str) -> Path | None:
    """The path of a listed file, None where it leads out of the folder or can be none."""
    try:
        path = folder / name
        path.is_file()
        return path if path.resolve().is_relative_to(folder.resolve()) else None
    except (OSError, ValueError):
        return None


def refuse_changed_files(folder: Path) -> None:
    """UserError for the first of `changed`."""
    for line in changed(folder):
        raise UserError(f"{folder}: {line}")


def _digest(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()

"""Folders built over more than one life of a process: beside their place, locked, renamed when whole."""

import fcntl
import os
import shutil
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from swamp_rl.errors import UserError
from swamp_rl.files import flush, flush_whole, os_error, refuse_to_replace, write_beside

LOCK = ".lock"


@contextmanager
def taken_up(
    path: Path | str,
    replaces: Collection[str],
    description: Mapping[str, bytes],
    say: Callable[[str], None] = lambda line: None,
) -> Iterator[Path]:
    """Yield a hidden sibling of folder `path`, `.part-NAME`, renamed to `path` once the block has ended well.

    What an earlier life of the same job left in it is still there: the job is the same where the files of
    `description`, which are written into it by relative path, hold the same bytes; otherwise it is emptied,
    and `say` hears so. Files that were being written (`write_beside`, `folder_beside`) are removed. However
    the block ends, what it has made is left for the next life; only one refused by UserError before it made
    anything leaves nothing.

    An existing `path` that is not empty is replaced only if it holds one of the files named `replaces`.
    UserError where it does not, and where another process is at work on the same folder.
    """
    path = Path(path).absolute()
    part, old = (path.with_name(f".{what}-{path.name}") for what in ("part", "old"))
    try:
        refuse_to_replace(path, replaces)
        with _locked(part, path):
            _recover(old, path)
            _begin(part, description, say)
            try:
                yield part
            except UserError:
                if not _made(part, description):
                    shutil.rmtree(part, ignore_errors=True)
                raise
            _publish(part, old, path)
    except OSError as error:
        raise os_error(error, path) from error


@contextmanager
def _locked(part: Path, path: Path) -> Iterator[None]:
    """Hold the lock of `part`, made if need be; the operating system frees it however the process ends."""
    while True:
        part.mkdir(parents=True, exist_ok=True)
        handle = os.open(part / LOCK, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(handle)
            raise UserError(
                f"{path}: another command is at work on it; wait for its end, or name another folder"
            ) from None
        if _same(handle, part / LOCK):
            break
        os.close(handle)  # its holder has just finished, and the lock has gone with the folder
    try:
        yield
    finally:
        os.close(handle)


def _same(handle: int, lock: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), lock.stat())
    except FileNotFoundError:
        return False


def _recover(old: Path, path: Path) -> None:
    """Undo a replacement that was cut short between its two renames, or clear away what was replaced."""
    if old.exists() and not path.exists():
        os.replace(old, path)
    shutil.rmtree(old, ignore_errors=True)


def _begin(part: Path, description: Mapping[str, bytes], say: Callable[[str], None]) -> None:
    """Empty `part` if it belongs to another job, otherwise clear away what was being written to it."""
    found = {name: (part / name).read_bytes() for name in description if (part / name).is_file()}
    if any(description[name] != held for name, held in found.items()):
        say(f"{part}: was begun with another configuration or version; begun anew")
        for entry in part.iterdir():
            if entry.name != LOCK:
                shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
    for pattern in (".part-*", ".old-*"):
        for leftover in list(part.rglob(pattern)):
            shutil.rmtree(leftover) if leftover.is_dir() else leftover.unlink(missing_ok=True)
    for name, held in description.items():
        if not (part / name).is_file():
            with write_beside(part / name) as file:
                file.write_bytes(held)


def _made(part: Path, description: Mapping[str, bytes]) -> bool:
    """Whether anything but the description is whole in `part`."""
    own = {LOCK, *(Path(name).parts[0] for name in description)}
    return any(entry.name not in own and not entry.name.startswith(".part-") for entry in part.iterdir())


def _publish(part: Path, old: Path, path: Path) -> None:
    """Put `part` in the place of `path`, everything safe on the disk before."""
    flush_whole(part)
    if path.exists():
        os.replace(path, old)
    os.replace(part, path)
    (path / LOCK).unlink()  # only now: a lock that others could make anew in `part` would move with it
    flush(path.parent)
    shutil.rmtree(old, ignore_errors=True)

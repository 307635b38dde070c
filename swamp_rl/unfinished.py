"""Folders built beside their place, locked, and renamed when whole; some over several lives of a process."""

import fcntl
import os
import shutil
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import zip_longest
from pathlib import Path

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.files import UNFINISHED, flush, flush_whole, os_error, refuse_nameless, write_beside
from swamp_rl.own_code import is_user_fault
from swamp_rl.replacement import NAMED, list_written, refuse_to_replace


@contextmanager
def folder_beside(
    path: Path | str, replaces: str | None = None, derived: Collection[str] = ()
) -> Iterator[Path]:
    """Yield an empty hidden sibling of folder `path`, renamed to `path` once the block has ended well.

    An existing `path` that is not empty is replaced only if it holds a file named `replaces`, which shows
    that it is an earlier result of the same kind, and nothing that came or changed since it was written, but
    in folders named `derived` (`refuse_to_replace`). UserError where it does not, and where another process
    is at work on the same folder, before any work is done; what another program puts there meanwhile is not
    replaced either. What processes that died have left beside `path` is removed. OSError -> UserError.
    """
    path = Path(path).absolute()
    part, old = _beside(".new-", path), _beside(".old-", path)
    marks = () if replaces is None else (replaces,)
    try:
        with locked(path):
            _recover(old, path)
            refuse_to_replace(path, marks, derived)
            there = _state(path)
            remove_dead(path.parent)
            _remove(part)
            part.mkdir()
            try:
                yield part
                _publish(part, old, path, there, marks, derived)
            finally:
                _recover(old, path)
                shutil.rmtree(part, ignore_errors=True)
    except OSError as error:
        raise os_error(error, path) from error


@contextmanager
def taken_up(
    path: Path | str,
    replaces: Collection[str],
    description: Mapping[str, bytes],
    continues: Callable[[Path], bool] = lambda part: False,
) -> Iterator[Path]:
    """Yield a hidden sibling of folder `path`, `.part-NAME`, renamed to `path` once the block has ended well.

    What an earlier life of the same job left in it is still there: the job is the same where the files of
    `description`, text that is written into it by relative path, hold the same bytes, or where `continues`
    says that this job may continue the other's work in that folder. UserError where another job has finished
    anything in it, which stays; otherwise it is emptied. Files that were being
    written (`write_beside`, `folder_beside`) are removed. However the block ends, what it has made is left
    for the next life; only one that a UserError or the user's own code ends before it made anything leaves
    nothing.

    An existing `path` that is not empty is replaced only if it holds one of the files named `replaces`, and
    nothing that came or changed since it was written. UserError where it does not, and where another process
    is at work on the same folder.
    """
    path = Path(path).absolute()
    part, old = _beside(".part-", path), _beside(".old-", path)
    try:
        with locked(path):
            _recover(old, path)
            refuse_to_replace(path, replaces)
            there = _state(path)
            _begin(part, description, continues)
            try:
                yield part
            except Exception as error:
                if is_user_fault(error) and not _finished(part, description):
                    shutil.rmtree(part, ignore_errors=True)
                raise
            try:
                _publish(part, old, path, there, replaces)
            finally:
                _recover(old, path)
    except OSError as error:
        raise os_error(error, path) from error


def _beside(prefix: str, path: Path) -> Path:
    """A sibling of `path`; those of two prefixes differ, whatever the names of their folders."""
    refuse_nameless(path)
    return path.with_name(prefix + path.name)


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the lock of `path`, a file beside it; UserError where another process does or it cannot be made.

    Folders made for it are removed at the end if they are empty then.
    """
    made = [folder for folder in path.parents if not folder.exists()]
    lock = _beside(".lock-", path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle = _lock(lock)
    except OSError as error:
        raise os_error(error, path) from error
    if handle is None:
        raise UserError(f"{path}: another command is at work on it; wait for its end, or name another folder")
    try:
        yield
    finally:
        _free(lock, handle)
        with suppress(OSError):
            for folder in made:
                folder.rmdir()


def _lock(lock: Path) -> int | None:
    """The handle of a lock file that this process holds now, None where another one does.

    The operating system frees it however the process ends.
    """
    while True:
        handle = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o644)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(handle)
            return None
        if _same(handle, lock):
            return handle
        os.close(handle)  # its holder has just finished, and has removed the file


def _free(lock: Path, handle: int) -> None:
    try:
        with suppress(OSError):
            lock.unlink()  # while it is held: a file that others could lock meanwhile must not go
    finally:
        os.close(handle)


def _same(handle: int, lock: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), lock.stat())
    except FileNotFoundError:
        return False


def remove_dead(folder: Path) -> None:
    """Remove what `folder_beside` was building in `folder` in processes that have ended since, but for that
    of other users, whose locks cannot be opened."""
    for part in folder.glob(".new-*"):
        lock = _beside(".lock-", part.with_name(part.name.removeprefix(".new-")))
        ours = part.is_dir() and not part.is_symlink() and lock.exists()  # which a killed process leaves
        try:
            handle = _lock(lock) if ours else None
        except OSError:
            continue
        if handle is not None:
            shutil.rmtree(part, ignore_errors=True)
            _free(lock, handle)


def _recover(old: Path, path: Path) -> None:
    """Undo a replacement that was cut short between its two renames, or clear away what was replaced."""
    if old.exists() and not path.exists():
        os.replace(old, path)
    _remove(old)


def _remove(path: Path) -> None:
    """Remove a folder and all in it, or the link that stands in its place."""
    if path.is_symlink():
        path.unlink()
    shutil.rmtree(path, ignore_errors=True)


def _begin(part: Path, description: Mapping[str, bytes], continues: Callable[[Path], bool]) -> None:
    """Clear away what was being written to `part`, what is of another job, and all links: no job makes any,
    and what is written must stay here. UserError where another job has finished anything in it."""
    if part.is_symlink():
        part.unlink()
    part.mkdir(exist_ok=True)
    if part.lstat().st_uid != os.geteuid():
        raise UserError(
            f"{part}: belongs to another user, who could change what is made; name another folder"
        )
    for link in [found for found in part.rglob("*") if found.is_symlink()]:
        link.unlink()
    other = differences(part, description)
    finished = _finished(part, description) if other else []
    if finished and not continues(part):
        raise UserError(
            f"{part}: holds unfinished work ({', '.join(finished[:NAMED])}) of another configuration or "
            f"version ({'; '.join(other[:NAMED])}); repeat the earlier command to resume it, name another "
            "folder, or remove this one to start over"
        )
    for entry in list(part.iterdir()) if other and not finished else ():
        shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
    for prefix in UNFINISHED:
        for leftover in list(part.rglob(f"{prefix}*")):
            shutil.rmtree(leftover) if leftover.is_dir() else leftover.unlink(missing_ok=True)
    for name, held in description.items():
        if not (part / name).is_file() or (part / name).read_bytes() != held:
            with write_beside(part / name) as file:
                file.write_bytes(held)


def differences(part: Path, description: Mapping[str, bytes]) -> list[str]:
    """For each file of `description` that holds something else in `part`, its first line that differs."""
    found = []
    for name, now in description.items():
        held = (part / name).read_bytes() if (part / name).is_file() else now
        if held != now:
            texts = (text.decode(errors="replace").splitlines() for text in (held, now))
            old, new = next(
                (pair for pair in zip_longest(*texts, fillvalue="") if pair[0] != pair[1]), ("", "")
            )
            found.append(f"{name}: there {clipped(old.strip(' ,'))!r}, now {clipped(new.strip(' ,'))!r}")
    return found


def _finished(part: Path, description: Mapping[str, bytes]) -> list[str]:
    """Names in `part` of what is whole, but for the description; hidden ones last."""
    files = (path.relative_to(part) for path in part.rglob("*") if path.is_file())
    whole = {
        file.parts[0]
        for file in files
        if file.as_posix() not in description and not any(name.startswith(UNFINISHED) for name in file.parts)
    }
    return sorted(whole, key=lambda name: (name.startswith("."), name))


State = tuple[int, int, tuple[str, ...]]


def _state(path: Path) -> State | None:
    """What changes when something is put into folder `path`, or another one in its place.

    The names are compared as well, since two changes within a tick of the system's clock have one time.
    """
    try:
        found = path.lstat()
        return found.st_ino, found.st_mtime_ns, tuple(sorted(os.listdir(path)))
    except FileNotFoundError:
        return None


def _publish(
    part: Path,
    old: Path,
    path: Path,
    there: State | None,
    replaces: Collection[str],
    derived: Collection[str] = (),
) -> None:
    """Put `part`, with the list of its files, in the place of `path`, everything safe on the disk before.

    there: `_state` of `path` when its replacement was agreed to; UserError where it is another by now, and
    where something in it came or changed since.
    """
    list_written(part)
    flush_whole(part)
    if _state(path) != there:
        raise UserError(
            f"{path}: was written by another command meanwhile and is not replaced; move it, and try again"
        )
    refuse_to_replace(path, replaces, derived)
    if path.exists():
        os.replace(path, old)
    os.replace(part, path)
    flush(path.parent)
    _remove(old)

"""Files that can be read to their end."""

import errno
import os
import stat
from pathlib import Path

MOST_JSON = 2**24
"Bytes of a JSON text: three of them may become a list, which takes 64."


def ordinary(path: Path | str, most: int | None = 2**30) -> Path:
    """The path, where it is that of an ordinary file of at most so many bytes.

    OSError for anything else: a pipe or a device has no end, and a file with holes none that a disk sets.
    """
    _refuse(os.stat(path), most)
    return Path(path)


def contents(path: Path | str, most: int = 2**30, follow: bool = True) -> bytes:
    """The bytes of an ordinary file of at most so many; OSError for anything else, a link unless `follow`.

    It is looked at once it is open, so that nothing can be put in its place between the two.
    """
    handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | (0 if follow else os.O_NOFOLLOW))
    try:
        _refuse(os.fstat(handle), most)
        with open(handle, "rb", closefd=False) as file:
            data = file.read(most + 1)
    finally:
        os.close(handle)
    if len(data) > most:
        raise _too_large(most)
    return data


def _refuse(found: os.stat_result, most: int | None) -> None:
    if not stat.S_ISREG(found.st_mode):
        raise OSError(errno.EINVAL, "is not a regular file")
    if most is not None and found.st_size > most:
        raise _too_large(most)


def _too_large(most: int) -> OSError:
    limit = f"{most / 2**30:g} GiB" if most >= 2**30 else f"{most / 2**20:g} MiB"
    return OSError(errno.EFBIG, f"is larger than {limit}")

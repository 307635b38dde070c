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
    found = os.stat(path)
    if not stat.S_ISREG(found.st_mode):
        raise OSError(errno.EINVAL, "is no ordinary file")
    if most is not None and found.st_size > most:
        told = f"{most / 2**30:g} GiB" if most >= 2**30 else f"{most / 2**20:g} MiB"
        raise OSError(errno.EFBIG, f"is larger than {told}")
    return Path(path)

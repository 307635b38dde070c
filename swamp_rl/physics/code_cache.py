"""Machine code on the disk, a file for each function and types of its arguments.

numba keeps one index of all types of a function and updates it without a lock: of two processes that compile
at the same time, one could give the other's code for its own types, and a file cut off by a loss of power
ended a command.
"""

import hashlib
import os
import pickle
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

from numba import __version__
from numba.core.caching import FunctionCache
from numba.core.serialize import dumps


class CodeCache(FunctionCache):
    """numba's cache of a function, with files named after what they contain in place of an index."""

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        self._cache_file = _Files(Path(self.cache_path), self._impl.filename_base)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the code; where the disk is full or the folder is gone, it is compiled again next time."""
        with suppress(OSError):
            super().save_overload(sig, data)


class _Files:
    """The files of one function: SHA-256 of the rest, then the key and the code."""

    def __init__(self, folder: Path, name: str) -> None:
        self.folder, self.name = folder, name

    def _path(self, key: Any) -> Path:
        digest = hashlib.sha256(repr((__version__, key)).encode()).hexdigest()
        return self.folder / f"{self.name}.{digest[:32]}.code"

    def save(self, key: Any, data: Any) -> None:
        """Write the file whole, or not at all."""
        content = dumps((key, data))
        handle, part = tempfile.mkstemp(dir=self.folder)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(hashlib.sha256(content).digest() + content)
            os.replace(part, self._path(key))
        except OSError:
            Path(part).unlink(missing_ok=True)
            raise

    def load(self, key: Any) -> Any:
        """The code of exactly this key; None where there is none, or the file is damaged."""
        try:
            content = self._path(key).read_bytes()
        except OSError:
            return None
        if hashlib.sha256(content[32:]).digest() != content[:32]:
            return None
        kept, data = pickle.loads(content[32:])
        return data if kept == key else None

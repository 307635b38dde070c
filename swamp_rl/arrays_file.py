"""Named arrays in one .npz file that carries its SHA-256."""

import io
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.files import write_beside
from swamp_rl.seal import BLANK, sealed, sealed_file

AGAIN = "remove it, and it is made again"
BROKEN = (
    OSError,
    EOFError,
    LookupError,
    ValueError,
    RuntimeError,
    MemoryError,
    zipfile.BadZipFile,
    zlib.error,
)
"""What NumPy and zipfile raise on bytes that are no archive of arrays."""


def write_arrays(path: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write the arrays, beside first and then renamed; UserError where they cannot be."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    with zipfile.ZipFile(buffer, "a") as archive:
        archive.comment = BLANK.encode()
    with write_beside(path) as part:
        part.write_bytes(sealed(buffer.getvalue()))


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """What `write_arrays` wrote; UserError where it is damaged or something else."""
    data = sealed_file(path, AGAIN)
    try:
        _refuse_unpacked(data)
        with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
            return {name: arrays[name] for name in arrays.files}
    except BROKEN as error:
        raise UserError(f"{path}: holds no arrays ({' '.join(str(error).split())}); {AGAIN}") from error


def _refuse_unpacked(data: bytes) -> None:
    """ValueError where the arrays are more than the bytes that hold them: none is packed, no two overlap."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = archive.infolist()
    if sum(max(member.file_size, member.compress_size) for member in members) > len(data):
        raise ValueError("its arrays are packed or lie over each other")

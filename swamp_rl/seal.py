"""A file's SHA-256 within the file itself, so that a lone copy of it still tells a changed bit.

The writer leaves room for it (`BLANK`) where the format takes a text: metadata of ONNX and safetensors, the
comment of a zip archive, a key of JSON. It is the SHA-256 of the bytes with that room as it was left.
"""

import hashlib
import re
from pathlib import Path

from swamp_rl.errors import UserError
from swamp_rl.ordinary import contents

MARK = b"swamp_rl-sha256:"
BLANK = MARK.decode() + 64 * "0"
KEY = "seal"
"""Name of the text, where it has one."""
_SEAL = re.compile(re.escape(MARK) + b"([0-9a-f]{64})")


def sealed(data: bytes) -> bytes:
    """`data`, which holds `BLANK` once, with its SHA-256 there; ValueError where it does not."""
    before, found, after = data.partition(BLANK.encode())
    if not found or MARK in before or MARK in after:
        raise ValueError(f"{BLANK} must be there once")
    return before + MARK + hashlib.sha256(data).hexdigest().encode() + after


def refuse_changed(where: Path | str, data: bytes, remedy: str) -> None:
    """UserError where the bytes `data`, read from `where`, are not as `sealed` left them; remedy: what to
    do then."""
    seals = list(_SEAL.finditer(data))
    if len(seals) != 1 or data.count(MARK) != 1:
        raise UserError(f"{where}: carries no checksum, it is damaged or of an older version; {remedy}")
    first, last = seals[0].span()
    if hashlib.sha256(data[:first] + BLANK.encode() + data[last:]).hexdigest().encode() != seals[0][1]:
        raise UserError(f"{where}: is damaged, its SHA-256 is not the one it carries; {remedy}")


def sealed_file(path: Path | str, remedy: str) -> bytes:
    """The bytes of a file as `sealed` left them; UserError where it cannot be read or they have changed."""
    try:
        data = contents(path)
    except OSError as error:
        raise UserError(f"{path}: {error.strerror or 'cannot be read'}; {remedy}") from error
    refuse_changed(path, data, remedy)
    return data

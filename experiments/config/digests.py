"""SHA-256 of datasets and stored pilots, by which they are recognised."""

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path

from swamp_rl.files import write_text
from swamp_rl.pilots.store import DESCRIPTION, load_pilot
from swamp_rl.runs.dataset import files_of

HASHES = "data.sha256"


def hashes(folder: Path) -> dict[str, str]:
    """SHA-256 of each file of a dataset, by name; UserError where it is no dataset."""
    files = sorted(files_of(folder), key=lambda path: path.name)
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def digest(of: Mapping[str, str]) -> str:
    """One SHA-256 for many files: that of the lines that `sha256sum` would print of them."""
    return hashlib.sha256(_lines(of, Path()).encode()).hexdigest()


def write_hashes(data: Path, folder: Path) -> str:
    """Write `data.sha256` into `folder`, to be checked there by `sha256sum -c`; the digest of all of it."""
    found = hashes(data)
    write_text(folder / HASHES, _lines(found, Path(os.path.relpath(data, folder))))
    return digest(found)


def _lines(of: Mapping[str, str], folder: Path) -> str:
    return "".join(f"{value}  {folder / name}\n" for name, value in of.items())


def pilot_hash(folder: Path | str) -> str:
    """SHA-256 of a stored pilot's `pilot.json`, which holds that of its weights; UserError as for
    `load_pilot`."""
    load_pilot(folder)
    return hashlib.sha256((Path(folder) / DESCRIPTION).read_bytes()).hexdigest()

"""`pilot.json`, the description of a stored pilot, with checksums of itself and of the weights."""

import hashlib
import json
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from swamp_rl.boat.likeness import Build
from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.explain import in_yaml, validated
from swamp_rl.pilots.arrays import Array

VERSION = 2
SCALING = ("mean", "scale", "centre")
"Arrays that hold the normalisation of the observations, by the last part of their names."

Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Part(BaseModel):
    """A strict, frozen section of the description."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class FittedOn(Part):
    """The runs that a pilot was trained on.

    dataset: SHA-256 over the lines that `sha256sum` prints of its files; source: its `source`.
    """

    dataset: Sha256
    source: str
    runs: tuple[str, ...]


class Made(Part):
    """Package, boat, course and step that a pilot was made for.

    package: name and version; boat, course: their names; boat_sha256: `swamp_rl.boat.digest.boat_digest` of
    the boat; length [m], thrusters: kinds by name, both None in pilots of before there were these keys;
    step: time between decisions [s].
    """

    package: str
    boat: str
    boat_sha256: Sha256
    length: Annotated[float | None, Field(gt=0.0)] = None
    thrusters: dict[str, str] | None = None
    course: str
    step: Annotated[float, Field(gt=0.0)]

    @property
    def build(self) -> Build | None:
        """Of the boat; None where the pilot does not tell."""
        if self.length is None or self.thrusters is None:
            return None
        return Build(self.length, self.thrusters)


class Arrays(Part):
    """The file of the weights: its SHA-256, the shape and type of each array, and which of them normalise."""

    sha256: Sha256
    shapes: dict[str, tuple[str, tuple[int, ...]]]
    normalisation: tuple[str, ...]


class Description(Part):
    """All of `pilot.json` but its seal."""

    format: Literal["swamp_rl pilot"] = "swamp_rl pilot"
    version: Literal[2] = 2
    kind: str
    senses: tuple[str, ...]
    settings: dict[str, Any]
    fitted_on: FittedOn | None
    made: Made | None = None
    weights: Arrays


def described_arrays(arrays: dict[str, Array], stored: bytes) -> Arrays:
    """Of the arrays, and of the file that holds them."""
    return Arrays(
        sha256=hashlib.sha256(stored).hexdigest(),
        shapes={name: (str(array.dtype), array.shape) for name, array in sorted(arrays.items())},
        normalisation=tuple(name for name in sorted(arrays) if name.split(".")[-1] in SCALING),
    )


def sealed(description: Description) -> str:
    """The text of `pilot.json`: the description, and last the SHA-256 of its text without that."""
    data = description.model_dump(mode="json")
    return _text({**data, "sha256": _digest(data)})


def unsealed(path: Path, stored: bytes) -> Description:
    """The description in a file's bytes; UserError where they are damaged, changed or of another version."""
    try:
        data = json.loads(stored)
        whole = isinstance(data, dict) and stored == _text(data).encode()
    except (ValueError, RecursionError) as error:
        raise UserError(f"{path}: is not JSON ({error}); train the pilot again") from error
    if not isinstance(data, dict) or "kind" not in data:
        raise UserError(f"{path}: does not describe a pilot; name a folder that holds one")
    if data.get("version") != VERSION:
        version = clipped(in_yaml(data.get("version", 1)), 20)
        raise UserError(f"{path}: is of format {version}, this reads format {VERSION}; train the pilot again")
    seal = data.pop("sha256", None)
    if not whole or seal != _digest(data):
        raise UserError(f"{path}: was changed since it was written; train the pilot again")
    return validated(path, Description, data)


def _digest(data: dict[str, Any]) -> str:
    return hashlib.sha256(_text(data).encode()).hexdigest()


def _text(data: dict[str, Any]) -> str:
    return json.dumps(data, indent=2, allow_nan=False) + "\n"

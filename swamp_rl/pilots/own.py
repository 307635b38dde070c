"""A researcher's own pilots: any class of the protocol `OwnClass`, named `module:Class` or by an entry point.

Naming a class imports its module, which runs its code. `own_class` is called for what the user named (an
experiment's `kind`, an argument); a stored pilot never imports anything, see `known_class`.
"""

import hashlib
import inspect
import tempfile
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, Protocol, Self

import numpy as np
from pydantic import BaseModel, ValidationError

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.names import file_in
from swamp_rl.ordinary import contents
from swamp_rl.own_code import imported, is_code, own_code
from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array, checked, checked_count
from swamp_rl.pilots.settings import Settings

GROUP = "swamp_rl.pilots"
"Entry points of installed packages that name pilots, by the kind that experiments call them."
SHIPPED = {"sb3": "swamp_rl.envs.sb3_zip:SB3Zip", "onnx": "swamp_rl.export.onnx_copy:OnnxCopy"}
"Pilots that follow the same protocol, imported where they are asked for."
ANY = ("",)
"Ends of the names of files that a pilot may save."
NEEDED = {
    "train": ("training",),
    "save": ("self", "folder"),
    "load": ("folder", "settings"),
    "reset": ("self", "n"),
    "act": ("self", "observation"),
}
"Methods of a class, and what they are called with."

_named: dict[str, type[Any]] = {}
_models: set[str] = set()


class OwnClass(Protocol):
    """What a class must have to be trained, stored and evaluated as the built-in pilots are.

    `Settings`, a pydantic model of the experiment's `options` (by default there are none), and `from_runs`,
    False where it learns from no runs, are attributes of the class. A pilot with a memory has
    `reset_boats(mask)` too, which forgets that of the boats of `mask` (n,) bool.
    """

    senses: tuple[str, ...]
    "Names of the d observations it wants, of the class or of each pilot."

    @classmethod
    def train(cls, training: Any) -> Self:
        """A pilot from a `swamp_rl.experiments.config.learners.Training`."""

    def save(self, folder: Path) -> None:
        """Write files into the empty `folder`, in no folder within it."""

    @classmethod
    def load(cls, folder: Path, settings: Any) -> Self:
        """The same pilot from those files and the settings that it was trained with."""

    def reset(self, n: int) -> None:
        """Begin a run with each of n boats."""

    def act(self, observation: Array) -> Array:
        """Levers (n, 2), throttle in [0, 1] and angle in [-1, 1], from the observation (n, d), SI units."""


def runs_code(kind: str) -> bool:
    """Whether loading a pilot of this kind runs code that comes with it."""
    return is_code(kind) or kind == "sb3"


def own_kinds() -> list[str]:
    """Kinds that `own_class` knows beside `module:Class`."""
    return sorted({*SHIPPED, *(entry.name for entry in entry_points(group=GROUP))})


def own_class(kind: str) -> type[Any]:
    """The class that the user named as `module:Class`, or by an entry point; its module is imported.

    Modules are looked for in the working directory too, last. UserError where there is none, or where it
    lacks a part of the protocol.
    """
    if kind not in _named:
        found = own_code(kind) if is_code(kind) else _installed(kind)
        _check(kind, found)
        _named[kind] = found
    return _named[kind]


def is_named(kind: str) -> bool:
    """Whether the user has named this class in this process."""
    return kind in _named


def known_class(kind: str) -> type[Any]:
    """The class of a stored pilot's kind; UserError where it is code that was not named in this process."""
    if is_code(kind) and kind not in _named:
        raise UserError(
            f"the pilot is of the class {kind}, which is code; if it is yours, name it: {kind}=FOLDER"
        )
    return own_class(kind)


def settings_of(found: type[Any]) -> type[Any]:
    """The model of a class's options."""
    return getattr(found, "Settings", Settings)


class OwnPilot:
    """A researcher's pilot as a `Pilot`: its levers checked, its files kept as arrays of bytes.

    Boats that have ended stay in the batch that the pilot sees, so that it needs no `keep`.
    """

    _seen: Array
    _places: Array

    def __init__(self, kind: str, pilot: Any, options: BaseModel) -> None:
        """kind: under which `own_class` knows its class; options: those it was trained with."""
        self.kind, self.pilot, self.options = kind, pilot, options
        missing = [name for name in ("reset", "act") if not callable(getattr(pilot, name, None))]
        if missing:
            raise UserError(
                f"{kind}: made {clipped(repr(pilot))}, which has no {', '.join(missing)}; return a pilot "
                "from train and load"
            )
        senses = getattr(pilot, "senses", None)
        if not isinstance(senses, list | tuple) or not all(isinstance(name, str) for name in senses):
            raise UserError(f"{kind}.senses: must be names of observations in order, not {senses!r}")
        self.senses: tuple[str, ...] = tuple(senses)
        self._begin(0)

    def reset(self, n: int) -> None:
        """Begin a run with each of n boats."""
        self._begin(checked_count(n))
        self.pilot.reset(n)

    def reset_boats(self, mask: Array) -> None:
        """Begin a new run with the boats of `mask` (n,)."""
        if hasattr(self.pilot, "reset_boats"):
            whole = np.zeros(len(self._seen), dtype=bool)
            whole[self._places[np.asarray(mask, dtype=bool)]] = True
            self.pilot.reset_boats(whole)

    def keep(self, boats: Array) -> None:
        """Go on with the boats of the places `boats` (m,) alone."""
        self._places = self._places[boats]

    def act(self, observation: Array) -> Array:
        """Levers (n, 2), stopped at the ends of their ways; UserError where they are not such numbers."""
        seen = checked(observation, self.senses)
        if len(seen) != len(self._places):
            self.reset(len(seen))
        self._seen[self._places] = seen
        given = self.pilot.act(self._seen.copy())
        try:
            levers = np.asarray(given, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise UserError(f"{self.kind}.act: gave no array of numbers ({error})") from error
        if levers.shape != (len(self._seen), 2):
            raise UserError(
                f"{self.kind}.act: gave the shape {levers.shape}, ({len(self._seen)}, 2) is needed"
            )
        if not np.isfinite(levers).all():
            raise UserError(f"{self.kind}.act: gave levers that are not finite numbers")
        return np.clip(levers[self._places], LOWEST, HIGHEST)

    def _begin(self, n: int) -> None:
        self._seen = np.zeros((n, len(self.senses)))
        self._places = np.arange(n)

    def settings(self) -> dict[str, Any]:
        """Its kind and options."""
        return {"kind": self.kind, "options": self.options.model_dump(mode="json")}

    def weights(self) -> dict[str, Array]:
        """The bytes of each file that it saves, by name."""
        with tempfile.TemporaryDirectory() as folder:
            self.pilot.save(Path(folder))
            files = sorted(Path(folder).iterdir())
            if any(not file.is_file() for file in files):
                raise UserError(f"{self.kind}.save: wrote a folder; write files only")
            kept = {
                file.name: contents(file_in(Path(folder), file.name, ANY), follow=False) for file in files
            }
        return {name: np.frombuffer(content, dtype=np.uint8) for name, content in kept.items()}

    @classmethod
    def build(cls, settings: dict[str, Any], weights: dict[str, Array]) -> "OwnPilot":
        """The pilot of `settings()` and `weights()`; UserError where its class was not named."""
        kind = settings["kind"]
        found = known_class(kind)
        try:
            options = settings_of(found).model_validate(settings["options"])
        except ValidationError as error:
            raise ValueError(f"its options do not fit {kind}") from error
        with tempfile.TemporaryDirectory() as folder:
            for name, content in weights.items():
                file_in(Path(folder), name, ANY).write_bytes(content.tobytes())
            try:
                loaded = found.load(Path(folder), options)
            except OSError as error:
                raise UserError(
                    f"{kind}.load: {Path(str(error.filename)).name}: {error.strerror}; {kind}.save wrote "
                    f"{', '.join(weights) or 'nothing'}"
                ) from error
        return cls(kind, loaded, options)


def model_file(file: str, sha256: str | None = None) -> bytes:
    """The content of a model's file; UserError where it cannot be read or is not the one of `sha256`."""
    try:
        content = contents(file)
    except OSError as error:
        whole = f"{file}.zip" if Path(f"{file}.zip").is_file() else "the file of a model"
        raise UserError(f"{file}: {error.strerror}; name {whole}") from error
    found = hashlib.sha256(content).hexdigest()
    if sha256 not in (None, found):
        raise UserError(f"{file}: is no longer the model of sha256 {sha256}; bring it back, or drop the key")
    _models.add(found)
    return content


def is_known_model(content: bytes) -> bool:
    """Whether this is the content of a model's file that the user has named in this process."""
    return hashlib.sha256(content).hexdigest() in _models


def _installed(kind: str) -> Any:
    if kind in SHIPPED:
        return imported(SHIPPED[kind])
    found = [entry for entry in entry_points(group=GROUP) if entry.name == kind]
    if not found:
        raise UserError(f"{kind!r} is not a kind of pilot of an installed package (entry points {GROUP})")
    return found[0].load()


def _check(kind: str, found: Any) -> None:
    if not isinstance(found, type):
        raise UserError(f"{kind}: is not a class; name one as module:Class")
    missing = [name for name in NEEDED if not callable(getattr(found, name, None))]
    if missing:
        raise UserError(f"{kind}: has no {', '.join(missing)}; see docs/own_pilot.md")
    for name, given in NEEDED.items():
        signature = inspect.signature(getattr(found, name))
        try:
            signature.bind(*given)
        except TypeError as error:
            raise UserError(f"{kind}.{name}{signature}: is called with ({', '.join(given)})") from error
    model = settings_of(found)
    if not (isinstance(model, type) and issubclass(model, BaseModel)):
        raise UserError(f"{kind}.Settings: must be a pydantic model, not {model!r}")

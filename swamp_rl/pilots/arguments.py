"""Pilots as arguments name them: folder, name, `sb3:model.zip`, `onnx:pilot.onnx`, `module:Class`."""

import hashlib
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from swamp_rl.errors import UserError
from swamp_rl.files import shipped_folders
from swamp_rl.own_code import own_code
from swamp_rl.pilots.own import SHIPPED, OwnPilot, model_file, own_class, settings_of
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.store import BUILT_IN, DESCRIPTION, unknown_name
from swamp_rl.pilots.store import load_pilot as load_stored

CLASS = re.compile(r"(?P<kind>[A-Za-z_][\w.]*:[A-Za-z_]\w*)(=(?P<pilot>.+))?")


@dataclass(frozen=True)
class Asked:
    """A pilot that was asked for: stored in `folder`, or of a `kind` with its `options`."""

    name: str
    folder: Path | None = None
    kind: str = "stored"
    options: dict[str, Any] = field(default_factory=dict)

    @property
    def place(self) -> Path | None:
        """Its folder or its file; None of a class and of a built-in pilot."""
        return Path(self.options["file"]) if "file" in self.options else self.folder


def asked_pilot(text: str) -> Asked:
    """What an argument asks for. The class of `module:Class` or `module:Class=PILOT` is imported, and so is
    the function of `module:function=PILOT`, a term that the pilots of that argument observe or are rewarded
    by.

    A name is that of a folder, else of a built-in pilot, else of one that comes with the package. UserError
    for another name, and where code or a model's file is not there; a path of a folder is not looked for.
    """
    kind, colon, file = text.partition(":")
    if colon and kind in SHIPPED:
        sha256 = hashlib.sha256(model_file(file)).hexdigest()
        own_class(kind)
        return Asked(Path(file).stem, kind=kind, options={"file": file, "sha256": sha256})
    named = CLASS.fullmatch(text)
    if Path(text).is_dir():
        return Asked(Path(text).resolve().name, Path(text))
    if text in BUILT_IN:
        return Asked(text, kind=text)
    if named is None:
        shipped = shipped_folders("pilots")
        if text not in shipped and len(Path(text).parts) == 1:
            raise unknown_name(text)
        return Asked(Path(text).name, shipped.get(text, Path(text)))
    if named["pilot"] is not None:
        if isinstance(own_code(named["kind"]), type):
            own_class(named["kind"])
        return asked_pilot(named["pilot"])
    own_class(named["kind"])
    return Asked(named["kind"].partition(":")[2], kind=named["kind"])


def load_pilot(name: Path | str) -> Pilot:
    """Load a pilot by any name that `evaluate` takes.

    - A folder of a stored pilot, the name of one that comes with the package, or `line-of-sight`.
    - `sb3:model.zip` or `onnx:pilot.onnx`.
    - `module:Class=FOLDER`: as FOLDER, a pilot of that class, whose module is imported.
    - `module:function=PILOT`: as PILOT, which observes that term. `module:Class`: called without arguments.

    UserError if there is no such pilot, or if it is damaged, changed, or of code that was not named.
    """
    if not isinstance(name, str | Path):
        raise UserError(
            f"load_pilot: an object of the type {type(name).__name__} was given; name a pilot or its folder"
        )
    return opened(asked_pilot(str(name)))


def names_pilot(text: str) -> bool:
    """Whether an argument that may name runs as well names a pilot."""
    kind, colon, _ = text.partition(":")
    path = Path(text)
    if path.exists():
        return (path / DESCRIPTION).is_file()
    named = text in BUILT_IN or text in shipped_folders("pilots")
    return named or (bool(colon) and kind in SHIPPED) or CLASS.fullmatch(text) is not None


def opened(asked: Asked) -> Pilot:
    """The pilot, without any training: a class alone is called without arguments. UserError if it cannot."""
    if asked.folder is not None:
        return load_stored(asked.folder)
    if asked.kind in BUILT_IN:
        return BUILT_IN[asked.kind]()
    found = own_class(asked.kind)
    try:
        options = settings_of(found).model_validate(asked.options)
        pilot = found.read(options) if asked.kind in SHIPPED else found()
    except (TypeError, ValidationError) as error:
        raise UserError(
            f"{asked.kind}: cannot be made without training; train it, then {asked.kind}=FOLDER"
        ) from error
    return OwnPilot(asked.kind, pilot, options)

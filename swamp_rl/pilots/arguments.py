"""Pilots as a command line names them: a folder, `sb3:model.zip`, `onnx:pilot.onnx` or `module:Class`."""

import hashlib
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from swamp_rl.errors import UserError
from swamp_rl.pilots.own import SHIPPED, OwnPilot, model_file, own_class, settings_of
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.store import load_pilot

CLASS = re.compile(r"(?P<kind>[A-Za-z_][\w.]*:[A-Za-z_]\w*)(=(?P<folder>.+))?")


@dataclass(frozen=True)
class Asked:
    """A pilot that was asked for: stored in `folder`, or of a `kind` with its `options`."""

    name: str
    folder: Path | None = None
    kind: str = "stored"
    options: dict[str, Any] = field(default_factory=dict)


def asked_pilot(text: str) -> Asked:
    """What an argument asks for. The class of `module:Class` or `module:Class=FOLDER` is imported.

    UserError where a class or a model's file is not there; a folder is not looked for.
    """
    kind, colon, file = text.partition(":")
    if colon and kind in SHIPPED:
        sha256 = hashlib.sha256(model_file(file)).hexdigest()
        own_class(kind)
        return Asked(Path(file).stem, kind=kind, options={"file": file, "sha256": sha256})
    named = CLASS.fullmatch(text)
    if named is None or Path(text).is_dir():
        return Asked(Path(text).name, Path(text))
    own_class(named["kind"])
    if named["folder"] is not None:
        return Asked(Path(named["folder"]).name, Path(named["folder"]))
    return Asked(named["kind"].partition(":")[2], kind=named["kind"])


def opened(asked: Asked) -> Pilot:
    """The pilot, without any training: a class alone is called without arguments. UserError if it cannot."""
    if asked.folder is not None:
        return load_pilot(asked.folder)
    found = own_class(asked.kind)
    try:
        options = settings_of(found).model_validate(asked.options)
        pilot = found.read(options) if asked.kind in SHIPPED else found()
    except (TypeError, ValidationError) as error:
        raise UserError(
            f"{asked.kind}: cannot be made without training; train it, then {asked.kind}=FOLDER"
        ) from error
    return OwnPilot(asked.kind, pilot, options)

"""Pilots on the disk: `pilot.json` says what it is, `weights.safetensors` holds what it learned."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.files import folder_beside
from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.reservoir import ReservoirPilot
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.takeover import TakeoverPilot

DESCRIPTION, WEIGHTS = "pilot.json", "weights.safetensors"
KINDS: dict[str, Any] = {
    "scripted": ScriptedPilot,
    "reservoir": ReservoirPilot,
    "cloning": NetworkPilot,
    "ppo": NetworkPilot,
}


def save_pilot(pilot: Pilot, folder: Path | str) -> None:
    """Write the pilot into `folder`, whole or not at all, over an earlier one; UserError if it cannot."""
    from safetensors.numpy import save

    description = {"kind": pilot.kind, "settings": pilot.settings()}
    with folder_beside(folder, replaces=DESCRIPTION) as part:
        text = json.dumps(description, indent=2, allow_nan=False) + "\n"
        (part / DESCRIPTION).write_text(text, encoding="utf-8")
        # written here and not by the library, whose error on a full disk is one of its own
        weights = save({name: np.ascontiguousarray(array) for name, array in pilot.weights().items()})
        (part / WEIGHTS).write_bytes(weights)


def load_pilot(folder: Path | str) -> Pilot:
    """The pilot stored in `folder`, ready to be reset; UserError where it is missing or damaged."""
    folder = Path(folder)
    try:
        description = json.loads((folder / DESCRIPTION).read_text(encoding="utf-8"))
    except OSError as error:
        raise UserError(
            f"{folder / DESCRIPTION}: {error.strerror}; name a folder that holds a pilot"
        ) from error
    except ValueError as error:
        raise UserError(f"{folder / DESCRIPTION}: is not JSON ({error}); train the pilot again") from error
    weights = _read_weights(folder / WEIGHTS)
    try:
        return _build(description, weights)
    except (KeyError, TypeError, ValueError) as error:
        cause = f"{error} is missing" if isinstance(error, KeyError) else " ".join(str(error).split())
        raise UserError(f"{folder}: does not hold a whole pilot ({cause}); train it again") from error


def _read_weights(path: Path) -> dict[str, Array]:
    from safetensors import SafetensorError
    from safetensors.numpy import load_file

    try:
        return load_file(path)
    except OSError as error:
        raise UserError(f"{path}: {error.strerror or 'cannot be read'}; train the pilot again") from error
    except SafetensorError as error:
        raise UserError(f"{path}: is damaged ({error}); train the pilot again") from error


def _build(description: dict[str, Any], weights: dict[str, Array]) -> Pilot:
    kind, settings = description["kind"], description["settings"]
    if kind == TakeoverPilot.kind:
        first, then = (_build(settings[name], _of(name, weights)) for name in ("first", "then"))
        return TakeoverPilot(first, then, settings["seconds"], settings["step"])
    if kind not in KINDS:
        raise ValueError(f"kind {kind!r} is none of {', '.join(KINDS)}, {TakeoverPilot.kind}")
    return KINDS[kind].build(settings, weights)


def _of(name: str, weights: dict[str, Array]) -> dict[str, Array]:
    """The weights of one of the pilots of a takeover."""
    return {
        key.removeprefix(f"{name}."): value for key, value in weights.items() if key.startswith(f"{name}.")
    }

"""Pilots on the disk: `pilot.json` says what it is, `weights.safetensors` holds what it learned.

Nothing in either is ever executed: a kind is looked up in `KINDS`, and arrays are numbers. A researcher's own
class, or term of the observation, is used only where the user has named it (`own.known_class`, `own_code`).
"""

import hashlib
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.files import shipped_folders
from swamp_rl.ordinary import MOST_JSON, contents
from swamp_rl.own_code import fault_in_own_code, is_code, refuse_unnamed
from swamp_rl.pilots.arrays import Array, owned
from swamp_rl.pilots.description import Description, FittedOn, Made, described_arrays, sealed, unsealed
from swamp_rl.pilots.gru import GRUPilot
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.own import OwnPilot, own_kinds
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.reservoir import ReservoirPilot
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.stored_settings import refuse_odd_settings
from swamp_rl.pilots.takeover import TakeoverPilot
from swamp_rl.tensors_file import tensors_in
from swamp_rl.unfinished import folder_beside

DESCRIPTION, WEIGHTS = "pilot.json", "weights.safetensors"
KINDS: dict[str, Any] = {
    "scripted": ScriptedPilot,
    "line-of-sight": LineOfSightPilot,
    "reservoir": ReservoirPilot,
    "cloning": NetworkPilot,
    "gru": GRUPilot,
    "ppo": NetworkPilot,
    "sac": NetworkPilot,
}


BUILT_IN = {"line-of-sight": LineOfSightPilot}
"Kinds that need neither training nor options, by the name that asks for them."


def save_pilot(
    pilot: Pilot, folder: Path | str, fitted_on: FittedOn | None = None, made: Made | None = None
) -> None:
    """Write the pilot into `folder`, whole or not at all, over an earlier one; UserError if it cannot.

    fitted_on: the runs it learned from; None where it learned from none. made: with what and for which boat,
    None where that is not known. UserError for a kind that `load_pilot` could not read.
    """
    from safetensors.numpy import save

    _check_kind(pilot)
    arrays = {name: np.ascontiguousarray(array) for name, array in pilot.weights().items()}
    stored = save(arrays)
    description = Description(
        kind=pilot.kind,
        senses=tuple(pilot.senses),
        settings=pilot.settings(),
        fitted_on=fitted_on,
        made=made,
        weights=described_arrays(arrays, stored),
    )
    with folder_beside(folder, replaces=DESCRIPTION) as part:
        (part / DESCRIPTION).write_bytes(sealed(description).encode())
        # written here and not by the library, whose error on a full disk is one of its own
        (part / WEIGHTS).write_bytes(stored)


def load_pilot(folder: Path | str) -> Pilot:
    """Load the pilot stored in `folder`; UserError if it is missing, damaged or changed.

    What the `load` of a class of the user's own raises is passed on.

    If there is no such folder, `folder` is the name of a pilot that comes with the package, or
    `line-of-sight`.
    """
    folder = Path(folder)
    if not folder.exists() and len(folder.parts) == 1:
        if folder.name in BUILT_IN:
            return BUILT_IN[folder.name]()
        if (shipped := shipped_folders("pilots").get(folder.name)) is None:
            raise unknown_name(folder.name)
        folder = shipped
    description = describe_pilot(folder)
    refuse_unnamed(description.senses, f"{folder}: the pilot observes")
    weights = _read_weights(folder / WEIGHTS, description)
    try:
        pilot = _build(description.kind, description.settings, weights)
        if tuple(pilot.senses) != description.senses:
            raise ValueError("its settings and its description differ in the observation")
    except (LookupError, TypeError, AttributeError, ValueError, ArithmeticError, RecursionError) as error:
        if fault_in_own_code(error):
            raise  # as of `train` and `act`: no damage of the folder
        cause = f"{error} is missing" if isinstance(error, KeyError) else " ".join(str(error).split())
        raise UserError(f"{folder}: does not hold a whole pilot ({cause}); train it again") from error
    return pilot


def unknown_name(text: str) -> UserError:
    """Message for `text`, which names neither a folder nor a pilot."""
    return UserError(f"{text}: no such folder, and no pilot of that name{known_names(text)}")


def known_names(text: str) -> str:
    """The end of a complaint about `text`, which names no pilot: the names, the nearest one, and a folder."""
    names = nearest(text, [*BUILT_IN, *shipped_folders("pilots")])
    return f"{names}; a pilot that was trained is named by its folder, as results/camogli/pilots/cloning"


def describe_pilot(folder: Path | str) -> Description:
    """What the pilot stored in `folder` is, without its weights; UserError as for `load_pilot`."""
    path = Path(folder) / DESCRIPTION
    try:
        return unsealed(path, contents(path, MOST_JSON))
    except OSError as error:
        inside = [str(file.parent) for file in sorted(Path(folder).glob(f"pilots/*/{DESCRIPTION}"))]
        named = ", ".join(inside) or "a folder that holds a pilot"
        raise UserError(f"{path}: {error.strerror}; name {named}") from error


def _read_weights(path: Path, description: Description) -> dict[str, Array]:
    from safetensors.numpy import load

    try:
        stored = contents(path)
        if hashlib.sha256(stored).hexdigest() != description.weights.sha256:
            raise UserError(f"{path}: is damaged, its SHA-256 is not in {DESCRIPTION}; train the pilot again")
        weights = tensors_in(stored, load)[1]
    except OSError as error:
        raise UserError(f"{path}: {error.strerror or 'cannot be read'}; train the pilot again") from error
    except ValueError as error:
        raise UserError(f"{path}: is damaged ({error}); train the pilot again") from error
    if described_arrays(weights, stored) != description.weights:
        raise UserError(f"{path}: holds other arrays than {DESCRIPTION} lists; train the pilot again")
    for name, array in weights.items():
        if not np.isfinite(array).all():
            raise UserError(f"{path}: {name} holds numbers that are not finite; train the pilot again")
        if name.split(".")[-1] == "scale" and not (array > 0.0).all():
            raise UserError(f"{path}: {name} must be above 0, it is divided by; train the pilot again")
    return weights


def _build(kind: str, settings: dict[str, Any], weights: dict[str, Array]) -> Pilot:
    refuse_odd_settings(kind, settings)
    if kind == TakeoverPilot.kind:
        first, then = (
            _build(settings[name]["kind"], settings[name]["settings"], owned(name, weights))
            for name in ("first", "then")
        )
        return TakeoverPilot(first, then, settings["seconds"], settings["step"])
    if is_code(kind) or kind in own_kinds():
        if settings["kind"] != kind:
            raise ValueError(f"its settings are of the kind {settings['kind']!r}, not {kind!r}")
        return OwnPilot.build(settings, weights)
    if kind not in KINDS:
        raise ValueError(f"kind {clipped(kind)!r} is none of {', '.join(KINDS)}, {TakeoverPilot.kind}")
    return KINDS[kind].build(settings, weights)


def _check_kind(pilot: Any) -> None:
    if isinstance(pilot, TakeoverPilot):
        _check_kind(pilot.first)
        _check_kind(pilot.then)
    elif not isinstance(pilot, OwnPilot | KINDS.get(pilot.kind, OwnPilot)):
        raise UserError(
            f"a pilot of the class {type(pilot).__name__} and kind {pilot.kind!r} could not be loaded again; "
            "wrap your own in swamp_rl.pilots.own.OwnPilot"
        )

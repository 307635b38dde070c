"""The extended boat file: the given one and the effects that were found; and the weather that was found."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.model.candidates import Hypothesis, joined
from swamp_rl.effects.entries import entry_mapping
from swamp_rl.files import write_yaml
from swamp_rl.names import file_in


def effect_mappings(hypothesis: Hypothesis, x: NDArray[np.float64]) -> list[dict[str, Any]]:
    """The effects as mappings for YAML; x: (p,)."""
    return [entry_mapping(entry) for entry in hypothesis.entries(x)]


BOAT, CONDITIONS = "extended_boat.yaml", "conditions"


def write_extended(
    folder: Path,
    boat: str | Path,
    hypothesis: Hypothesis,
    x: NDArray[np.float64],
    names: Sequence[str] = (),
    curves: Sequence[dict[str, Any]] = (),
) -> None:
    """Write BOAT and, where the hypothesis has weather or effects that differ between days or runs, levels of
    disturbances with those into `folder`: CONDITIONS.yaml, or CONDITIONS/RUN.yaml of each of the runs `names`
    where some differ.

    BOAT extends `boat`, given by name or by path, with the other effects and the `curves` of a missing
    force. x: (p,).
    """
    parts = list(hypothesis.parts(x))
    own = effect_mappings(*joined(part for part in parts if part[0].of_boat))
    conditions, numbers = joined(part for part in parts if not part[0].of_boat)
    if conditions.differs:
        (folder / CONDITIONS).mkdir()
        for run, name in enumerate(names):
            path = file_in(folder / CONDITIONS, f"{name}.yaml", (".yaml",))
            _write_conditions(path, effect_mappings(*conditions.of_run(numbers, run)[:2]))
    else:
        _write_conditions(folder / f"{CONDITIONS}.yaml", effect_mappings(conditions, numbers))
    given = Path(boat)
    is_name = given.suffix == "" and len(given.parts) == 1
    extends = str(boat) if is_name else os.path.relpath(given, folder)
    write_yaml(
        folder / BOAT, {"extends": extends, "name": f"{given.stem}-extended", "effects": [*own, *curves]}
    )


def _write_conditions(path: Path, effects: list[dict[str, Any]]) -> None:
    """A level of disturbances, if there are any."""
    if effects:
        write_yaml(path, {"description": "conditions of a run by a diagnosis", "effects": effects})

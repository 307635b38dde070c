"""The boat file that a diagnosis leads to: the given one, and the effects that were found."""

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.files import write_yaml


def effect_mappings(hypothesis: Hypothesis, x: NDArray[np.float64]) -> list[dict[str, Any]]:
    """The effects as they stand in YAML; x: (p,)."""
    found = []
    for entry in hypothesis.entries(x):
        selector = list(entry.thruster) if isinstance(entry.thruster, tuple) else entry.thruster
        thruster = {} if selector is None else {"thruster": selector}
        found.append(
            {"effect": entry.effect.name, **thruster, **{k: float(v) for k, v in entry.values.items()}}
        )
    return found


def write_extended(path: Path, boat: str | Path, hypothesis: Hypothesis, x: NDArray[np.float64]) -> None:
    """Write a boat file at `path` that extends `boat`, given by name or by path, with the hypothesis's
    effects.
    """
    given = Path(boat)
    is_name = given.suffix == "" and len(given.parts) == 1
    extends = str(boat) if is_name else os.path.relpath(given, path.parent)
    name = f"{given.stem}-extended"
    write_yaml(path, {"extends": extends, "name": name, "effects": effect_mappings(hypothesis, x)})

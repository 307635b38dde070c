"""Checkpoints of trainings: safetensors files with JSON in the header and a checksum, replaced atomically."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.files import write_beside
from swamp_rl.json_text import parsed_json
from swamp_rl.pilots.arrays import Array, owned
from swamp_rl.seal import BLANK, KEY, sealed, sealed_file
from swamp_rl.tensors_file import tensors_in

SAID = "training"
REMEDY = "remove it to train again"


def save_checkpoint(path: Path, description: Mapping[str, Any], arrays: Mapping[str, Array]) -> None:
    """Replace the checkpoint `path` by JSON and named arrays; UserError where it cannot be written."""
    from safetensors.numpy import save

    whole = {name: np.array(value, order="C") for name, value in arrays.items()}
    with write_beside(path) as part:
        part.write_bytes(sealed(save(whole, metadata={SAID: json.dumps(description), KEY: BLANK})))


def load_checkpoint(path: Path) -> tuple[Any, dict[str, Array]] | None:
    """What `save_checkpoint` wrote, None where there is no file; UserError where it is damaged."""
    from safetensors.numpy import load

    if not path.exists():
        return None
    data = sealed_file(path, REMEDY)
    with readable(path):
        header, arrays = tensors_in(data, load)
        return parsed_json(header[SAID]), arrays


@contextmanager
def readable(path: Path) -> Iterator[None]:
    """UserError for whatever the contents of the checkpoint `path` lack."""
    try:
        yield
    except (LookupError, TypeError, AttributeError, ValueError, RuntimeError) as error:
        raise UserError(f"{path}: is not a complete checkpoint ({error}); {REMEDY}") from error


def module_state(owner: str, module: Any) -> dict[str, Array]:
    """Return the weights of a torch module, by names that begin with `owner`."""
    return {f"{owner}.{name}": value.numpy() for name, value in module.state_dict().items()}


def load_module_state(owner: str, module: Any, arrays: Mapping[str, Array]) -> None:
    """Load the weights that `module_state` returned into a torch module."""
    import torch

    own = owned(owner, arrays)
    module.load_state_dict({name: torch.from_numpy(own[name]) for name in module.state_dict()})


def optimiser_state(owner: str, optimiser: Any) -> dict[str, Array]:
    """Return the state of a torch optimiser, by names that begin with `owner`."""
    return {
        f"{owner}.{i}.{name}": value.numpy()
        for i, known in optimiser.state_dict()["state"].items()
        for name, value in known.items()
    }


def load_optimiser_state(owner: str, optimiser: Any, arrays: Mapping[str, Array]) -> None:
    """Load the state that `optimiser_state` returned into a torch optimiser."""
    import torch

    state: dict[int, dict[str, Any]] = {}
    for name, value in owned(owner, arrays).items():
        i, moment = name.split(".")
        state.setdefault(int(i), {})[moment] = torch.from_numpy(value)
    optimiser.load_state_dict({**optimiser.state_dict(), "state": state})

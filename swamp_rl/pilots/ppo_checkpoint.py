"""A training by PPO on the disk, in one file without pickle: tensors, and JSON in its header."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.files import write_beside
from swamp_rl.pilots.arrays import Array

FORMAT = "1"


@dataclass
class Progress:
    """How far a training is. curve: what each leg told, with the `step` it had reached, in decisions."""

    settings: dict[str, Any]
    legs: int = 0
    seconds: float = 0.0
    curve: list[dict[str, Any]] = field(default_factory=list)


def save_progress(path: Path, progress: Progress, learner: Any, scaled: Any) -> None:
    """Replace the checkpoint `path`, whole or not at all; UserError where it cannot be written."""
    from safetensors.numpy import save

    header = {
        "format": FORMAT,
        "settings": json.dumps(progress.settings),
        "legs": str(progress.legs),
        "seconds": repr(progress.seconds),
        "curve": json.dumps(progress.curve),
        "decisions": str(learner.num_timesteps),
    }
    tensors = {name: np.array(value, order="C") for name, value in _tensors(learner, scaled).items()}
    with write_beside(path) as part:
        part.write_bytes(save(tensors, metadata=header))


def load_progress(path: Path, progress: Progress, learner: Any, scaled: Any) -> None:
    """Bring `progress`, the learner and its scaling to the checkpoint `path`, if one is there.

    UserError where it is damaged or was made with other settings.
    """
    if not path.exists():
        return
    header, tensors = _read(path)
    try:
        made_with = json.loads(header["settings"])
        if header["format"] == FORMAT and made_with == progress.settings:
            _restore(learner, scaled, tensors)
            learner.num_timesteps = int(header["decisions"])
            progress.legs, progress.seconds = int(header["legs"]), float(header["seconds"])
            progress.curve = json.loads(header["curve"])
            return
    except (KeyError, ValueError, RuntimeError) as error:
        raise UserError(f"{path}: is no whole checkpoint ({error}); remove it to train anew") from error
    other = [key for key in progress.settings if made_with.get(key) != progress.settings[key]]
    raise UserError(
        f"{path}: was made with other settings ({', '.join(other) or 'of another version'}); "
        "train with those, or remove it to train anew"
    )


def _read(path: Path) -> tuple[dict[str, str], dict[str, Array]]:
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(path, "numpy") as file:
            return file.metadata() or {}, {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (OSError, SafetensorError) as error:
        raise UserError(f"{path}: is damaged ({error}); remove it to train anew") from error


def _tensors(learner: Any, scaled: Any) -> dict[str, Array]:
    tensors = {f"policy.{name}": value.numpy() for name, value in learner.policy.state_dict().items()}
    for i, moments in learner.policy.optimizer.state_dict()["state"].items():
        tensors |= {f"optimiser.{i}.{name}": value.numpy() for name, value in moments.items()}
    for name, seen in (("observation", scaled.obs_rms), ("return", scaled.ret_rms)):
        tensors |= {f"{name}.mean": np.asarray(seen.mean), f"{name}.var": np.asarray(seen.var)}
        tensors[f"{name}.count"] = np.asarray(seen.count, dtype=np.float64)
    return tensors


def _restore(learner: Any, scaled: Any, tensors: dict[str, Array]) -> None:
    import torch

    weights = {name: torch.from_numpy(tensors[f"policy.{name}"]) for name in learner.policy.state_dict()}
    learner.policy.load_state_dict(weights)
    state: dict[int, dict[str, Any]] = {}
    for name, value in tensors.items():
        if name.startswith("optimiser."):
            _, i, moment = name.split(".")
            state.setdefault(int(i), {})[moment] = torch.from_numpy(value)
    groups = learner.policy.optimizer.state_dict()["param_groups"]
    learner.policy.optimizer.load_state_dict({"state": state, "param_groups": groups})
    for name, seen in (("observation", scaled.obs_rms), ("return", scaled.ret_rms)):
        seen.mean, seen.var = tensors[f"{name}.mean"], tensors[f"{name}.var"]
        seen.count = float(tensors[f"{name}.count"])

"""Behaviour cloning with a memory: a gated recurrent unit (Cho and others 2014) learns whole runs."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from swamp_rl.one_thread import one_thread
from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array, checked, checked_count, times
from swamp_rl.pilots.callbacks import Log, Tick
from swamp_rl.pilots.demonstrations import NEXT_GATE, POSE, examples
from swamp_rl.pilots.network import REACH
from swamp_rl.pilots.regression import RegressionSettings, task_of, train_by_epochs
from swamp_rl.pilots.settings import Many, Positive, Width
from swamp_rl.runs import Run


class GRUSettings(RegressionSettings):
    """As `CloningSettings`, with a memory of `units` numbers in place of layers."""

    senses: Annotated[tuple[str, ...], Field(min_length=1)] = (*POSE, "yaw_rate", *NEXT_GATE)
    units: Width = 32
    batch_size: Many = 4
    "Runs in a batch."
    learning_rate: Positive = 5e-3


class GRUPilot:
    """One network for all boats, with a state (n, units) that is zero at the start of a run."""

    kind: ClassVar[str] = "gru"

    def __init__(self, senses: Sequence[str], weights: dict[str, Array]) -> None:
        """weights, float32: mean, scale (d,), input (d, 3 h), recurrent (h, 3 h), input_bias, recurrent_bias
        (3 h,), for the reset gate, the update gate and the candidate in this order, Wout (h, 2) and out (2,).

        ValueError where their shapes do not agree.
        """
        self.senses = tuple(senses)
        self._weights = {name: np.asarray(weights[name], dtype=np.float32) for name in _NAMES}
        d, h = len(self.senses), len(self._weights["Wout"])
        shapes = ((d,), (d,), (d, 3 * h), (h, 3 * h), (3 * h,), (3 * h,), (h, 2), (2,))
        for name, shape in zip(_NAMES, shapes, strict=True):
            if self._weights[name].shape != shape:
                raise ValueError(f"{name} has the shape {self._weights[name].shape}, {shape} is needed")
        self.reset(0)

    def reset(self, n: int) -> None:
        """Set the number of boats to n and all states to zero."""
        self.memory = np.zeros((checked_count(n), len(self._weights["Wout"])), dtype=np.float32)

    def reset_boats(self, mask: Array) -> None:
        """Set the states of the boats of `mask` (n,) to zero."""
        self.memory[np.asarray(mask, dtype=bool)] = 0.0

    def keep(self, boats: Array) -> None:
        """Keep only the boats with the indices `boats` (m,)."""
        self.memory = self.memory[boats]

    def act(self, observation: Array) -> Array:
        """Levers (n, 2) from the observation (n, d); advances the states by one step."""
        w, h = self._weights, self.memory.shape[1]
        seen = checked(observation, self.senses, len(self.memory))
        x = np.clip((seen - w["mean"]) / w["scale"], -REACH, REACH).astype(np.float32)
        driven = times(x, w["input"]) + w["input_bias"]
        recurrent = times(self.memory, w["recurrent"]) + w["recurrent_bias"]
        gates = _sigmoid(driven[:, : 2 * h] + recurrent[:, : 2 * h])
        reset, update = gates[:, :h], gates[:, h:]
        candidate = np.tanh(driven[:, 2 * h :] + reset * recurrent[:, 2 * h :])
        self.memory = candidate + update * (self.memory - candidate)
        levers = (times(self.memory, w["Wout"]) + w["out"]).astype(np.float64)
        return np.clip(levers, LOWEST, HIGHEST)

    def settings(self) -> dict[str, Any]:
        """The senses."""
        return {"senses": list(self.senses)}

    def weights(self) -> dict[str, Array]:
        """Return the weights, as given to the constructor."""
        return self._weights

    @classmethod
    def build(cls, settings: dict[str, Any], weights: dict[str, Array]) -> "GRUPilot":
        """The pilot of `settings()` and `weights()`."""
        return cls(settings["senses"], weights)


_NAMES = ("mean", "scale", "input", "recurrent", "input_bias", "recurrent_bias", "Wout", "out")


@one_thread(torch=True)
def fit_gru(
    runs: Sequence[Run],
    settings: GRUSettings | None = None,
    tick: Tick = lambda done: None,
    checkpoint: Path | None = None,
    log: Log = lambda epoch, values: None,
) -> GRUPilot:
    """Return a pilot fitted to whole `runs`, its state zero at each start; otherwise as `fit_cloning`."""
    import torch

    settings = settings or GRUSettings()
    observations, levers, demonstrated = examples(runs, settings.senses, settings.reaction)
    everything = np.concatenate(observations)
    mean, scale = everything.mean(axis=0), np.maximum(everything.std(axis=0), 1e-6)
    # Rows that are no demonstration, or beyond a run's end, have weight zero.
    inputs, targets, row_weights = (
        torch.nn.utils.rnn.pad_sequence([torch.tensor(x).float() for x in parts], batch_first=True)
        for parts in ([(x - mean) / scale for x in observations], levers, demonstrated)
    )
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(settings.seed)
        memory = torch.nn.GRU(len(settings.senses), settings.units, batch_first=True)
        readout = torch.nn.Linear(settings.units, 2)
    network = torch.nn.ModuleDict({"memory": memory, "readout": readout})

    def losses(chance: Any) -> Iterator[Any]:
        for batch in torch.randperm(len(inputs), generator=chance).split(settings.batch_size):
            noise = settings.noise * torch.randn(inputs[batch].shape, generator=chance)
            error = readout(memory(inputs[batch] + noise)[0]) - targets[batch]
            yield (error.square().mean(dim=2) * row_weights[batch]).sum() / row_weights[batch].sum().clamp(
                min=1.0
            )

    task = task_of(settings, (everything, *levers, *demonstrated))
    train_by_epochs(network, losses, settings, task, tick, checkpoint, log)
    return GRUPilot(settings.senses, {"mean": mean, "scale": scale, **_arrays(memory, readout)})


def _arrays(memory: Any, readout: Any) -> dict[str, Array]:
    named = {
        "input": memory.weight_ih_l0.T,
        "recurrent": memory.weight_hh_l0.T,
        "input_bias": memory.bias_ih_l0,
        "recurrent_bias": memory.bias_hh_l0,
        "Wout": readout.weight.T,
        "out": readout.bias,
    }
    return {name: value.detach().numpy().copy() for name, value in named.items()}


def _sigmoid(x: Array) -> Array:
    return 0.5 * (1.0 + np.tanh(0.5 * x))

"""A pilot without memory: the network that behaviour cloning and PPO leave behind, in NumPy alone."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array

REACH = 10.0
"Inputs are held within so many standard deviations of what was seen in training."


class NetworkPilot:
    """Tanh layers, then a linear one; the levers stop at the ends of their ways."""

    def __init__(self, kind: str, senses: Sequence[str], weights: dict[str, Array]) -> None:
        """kind: how it was trained, `cloning` or `ppo`.

        weights, float32: mean, scale (d,) of the observations, and for each layer i from 0 `weight_<i>`
        (in, out) and `bias_<i>` (out,). ValueError where their shapes do not fit.
        """
        self.kind = kind
        self.senses = tuple(senses)
        self._weights = {name: np.asarray(value, dtype=np.float32) for name, value in weights.items()}
        count = sum(name.startswith("weight_") for name in weights)
        self._layers = [(self._weights[f"weight_{i}"], self._weights[f"bias_{i}"]) for i in range(count)]
        self._check_shapes()

    def reset(self, n: int) -> None:
        """Nothing to forget: a decision depends on the present observation alone."""

    def reset_boats(self, mask: Array) -> None:
        """As `reset`."""

    def act(self, observation: Array) -> Array:
        """Levers (n, 2) from the observation (n, d)."""
        x = (observation - self._weights["mean"]) / self._weights["scale"]
        x = np.clip(x, -REACH, REACH).astype(np.float32)
        for weight, bias in self._layers[:-1]:
            x = np.tanh(x @ weight + bias)
        weight, bias = self._layers[-1]
        return np.clip((x @ weight + bias).astype(np.float64), LOWEST, HIGHEST)

    def settings(self) -> dict[str, Any]:
        """Kind and senses."""
        return {"kind": self.kind, "senses": list(self.senses)}

    def weights(self) -> dict[str, Array]:
        """As given at first."""
        return self._weights

    @classmethod
    def build(cls, settings: dict[str, Any], weights: dict[str, Array]) -> "NetworkPilot":
        """The pilot of `settings()` and `weights()`."""
        return cls(settings["kind"], settings["senses"], weights)

    def _check_shapes(self) -> None:
        widths = [len(self.senses), *(len(bias) for _, bias in self._layers)]
        if len(widths) < 2 or widths[-1] != 2:
            raise ValueError("the last layer must have two outputs, throttle and angle")
        shapes = {"mean": widths[:1], "scale": widths[:1]}
        for i in range(len(self._layers)):
            shapes |= {f"weight_{i}": widths[i : i + 2], f"bias_{i}": widths[i + 1 : i + 2]}
        for name, shape in shapes.items():
            if self._weights[name].shape != tuple(shape):
                raise ValueError(
                    f"{name} has the shape {self._weights[name].shape}, {tuple(shape)} is needed"
                )


def layers_of(modules: Iterable[Any]) -> dict[str, Array]:
    """`weight_<i>` (in, out) and `bias_<i>` (out,) of the torch modules that are linear, in their order."""
    import torch

    layers = [module for module in modules if isinstance(module, torch.nn.Linear)]
    named = {f"weight_{i}": layer.weight.detach().numpy().T.copy() for i, layer in enumerate(layers)}
    return named | {f"bias_{i}": layer.bias.detach().numpy().copy() for i, layer in enumerate(layers)}

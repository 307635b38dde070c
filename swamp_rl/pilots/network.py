"""The network that behaviour cloning and PPO leave behind as a pilot, in NumPy alone."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array

REACH = 10.0
"Inputs are held within so many standard deviations of what was seen in training."


class NetworkPilot:
    """Tanh layers, then a linear one; the levers stop at the ends of their ways.

    A decision depends on the present observation alone and is held for `hold` steps, counted for each boat
    from the start of its run.
    """

    def __init__(self, kind: str, senses: Sequence[str], weights: dict[str, Array], hold: int = 1) -> None:
        """kind: how it was trained, `cloning` or `ppo`; hold: steps from one decision to the next.

        weights, float32: mean, scale (d,) of the observations, and for each layer i from 0 `weight_<i>`
        (in, out) and `bias_<i>` (out,). ValueError where their shapes do not fit, or `hold` is no whole
        number of at least 1.
        """
        if isinstance(hold, bool) or not isinstance(hold, int) or hold < 1:
            raise ValueError(f"hold must be a whole number of at least 1, not {hold!r}")
        self.kind = kind
        self.senses = tuple(senses)
        self.hold = hold
        self._weights = {name: np.asarray(value, dtype=np.float32) for name, value in weights.items()}
        count = sum(name.startswith("weight_") for name in weights)
        self._layers = [(self._weights[f"weight_{i}"], self._weights[f"bias_{i}"]) for i in range(count)]
        self._check_shapes()
        self.reset(0)

    def reset(self, n: int) -> None:
        """Begin with n boats, each of which decides at its next step."""
        self._held_for = np.zeros(n, dtype=np.int64)
        self._levers = np.zeros((n, 2))

    def reset_boats(self, mask: Array) -> None:
        """The boats of `mask` (n,) decide at their next step, whatever they held."""
        self._held_for[np.asarray(mask, dtype=bool)] = 0

    def act(self, observation: Array) -> Array:
        """Levers (n, 2) from the observation (n, d): decided now, or held since an earlier step."""
        due = self._held_for == 0
        if due.all():
            self._levers = self._decide(observation)
        elif due.any():
            self._levers[due] = self._decide(observation[due])
        self._held_for = (self._held_for + 1) % self.hold
        return self._levers.copy()

    def _decide(self, observation: Array) -> Array:
        x = (observation - self._weights["mean"]) / self._weights["scale"]
        x = np.clip(x, -REACH, REACH).astype(np.float32)
        for weight, bias in self._layers[:-1]:
            x = np.tanh(x @ weight + bias)
        weight, bias = self._layers[-1]
        return np.clip((x @ weight + bias).astype(np.float64), LOWEST, HIGHEST)

    def settings(self) -> dict[str, Any]:
        """Kind, senses and hold."""
        return {"kind": self.kind, "senses": list(self.senses), "hold": self.hold}

    def weights(self) -> dict[str, Array]:
        """As given at first."""
        return self._weights

    @classmethod
    def build(cls, settings: dict[str, Any], weights: dict[str, Array]) -> "NetworkPilot":
        """The pilot of `settings()` and `weights()`."""
        return cls(settings["kind"], settings["senses"], weights, settings["hold"])

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

"""The network of behaviour cloning, PPO and SAC as a pilot, in NumPy alone."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array, checked, checked_count, times
from swamp_rl.pilots.held import Held
from swamp_rl.pilots.memory import Memory

REACH = 10.0
"Inputs are clipped to this many standard deviations of the training data."


class NetworkPilot:
    """Tanh layers and a linear output layer, clipped to the range of the levers.

    A decision depends on the present observation and on the observations and levers of the `memory` decisions
    before. It is held for `hold` steps, counted for each boat from the start of its run.
    """

    def __init__(
        self, kind: str, senses: Sequence[str], weights: dict[str, Array], hold: int = 1, memory: int = 0
    ) -> None:
        """kind: how it was trained, `cloning`, `ppo` or `sac`; hold: steps from one decision to the next.

        weights, float32: mean, scale (d,) of the observation with its history (`Memory`), and for each layer
        i from 0 `weight_<i>` (in, out) and `bias_<i>` (out,). ValueError where shapes do not fit, `hold`
        is no whole number of at least 1, or `memory` none of at least 0.
        """
        _check_count("hold", hold, 1)
        _check_count("memory", memory, 0)
        self.kind = kind
        self.senses = tuple(senses)
        self._held = Held(hold)
        self._memory = Memory(memory, len(self.senses))
        self._weights = {name: np.asarray(value, dtype=np.float32) for name, value in weights.items()}
        count = sum(name.startswith("weight_") for name in weights)
        self._layers = [(self._weights[f"weight_{i}"], self._weights[f"bias_{i}"]) for i in range(count)]
        self._check_shapes()
        self.reset(0)

    @property
    def hold(self) -> int:
        """Steps from one decision to the next."""
        return self._held.steps

    def reset(self, n: int) -> None:
        """Set the number of boats to n; each decides at its next step."""
        n = checked_count(n)
        self._held.begin(n)
        self._memory.begin(n)

    def reset_boats(self, mask: Array) -> None:
        """Clear the history of the boats of `mask` (n,), which decide at their next step."""
        self._held.forget(mask)
        self._memory.forget(mask)

    def keep(self, boats: Array) -> None:
        """Keep only the boats with the indices `boats` (m,)."""
        self._held.choose(boats)
        self._memory.choose(boats)

    def act(self, observation: Array) -> Array:
        """Return levers (n, 2) for observations (n, d): a new decision or the one held.

        If the number of boats differs from before, all are reset.
        """
        observed = checked(observation, self.senses)
        if len(observed) != len(self._held):
            self.reset(len(observed))

        def decide(due: Array) -> Array:
            levers = self._decide(self._memory.recall(observed[due], due))
            self._memory.keep(observed[due], levers, due)
            return levers

        return self._held.step(decide)

    def _decide(self, recalled: Array) -> Array:
        x = (recalled - self._weights["mean"]) / self._weights["scale"]
        x = np.clip(x, -REACH, REACH).astype(np.float32)
        for weight, bias in self._layers[:-1]:
            x = np.tanh(times(x, weight) + bias)
        weight, bias = self._layers[-1]
        return np.clip((times(x, weight) + bias).astype(np.float64), LOWEST, HIGHEST)

    def settings(self) -> dict[str, Any]:
        """Kind, senses, hold and memory."""
        return {
            "kind": self.kind,
            "senses": list(self.senses),
            "hold": self.hold,
            "memory": self._memory.depth,
        }

    def weights(self) -> dict[str, Array]:
        """Return the weights, as given to the constructor."""
        return self._weights

    @classmethod
    def build(cls, settings: dict[str, Any], weights: dict[str, Array]) -> "NetworkPilot":
        """The pilot of `settings()` and `weights()`."""
        return cls(settings["kind"], settings["senses"], weights, settings["hold"], settings.get("memory", 0))

    def _check_shapes(self) -> None:
        widths = [self._memory.seen_width, *(len(bias) for _, bias in self._layers)]
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


def _check_count(name: str, value: Any, least: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise ValueError(f"{name} must be a whole number of at least {least}, not {value!r}")


def layers_of(modules: Iterable[Any]) -> dict[str, Array]:
    """Return `weight_<i>` (in, out) and `bias_<i>` (out,) of the linear torch modules, in their order."""
    import torch

    layers = [module for module in modules if isinstance(module, torch.nn.Linear)]
    named = {f"weight_{i}": layer.weight.detach().numpy().T.copy() for i, layer in enumerate(layers)}
    return named | {f"bias_{i}": layer.bias.detach().numpy().copy() for i, layer in enumerate(layers)}

"""A clone as PPO's first guess: its layers become the policy, its scaling that of the observations."""

from typing import Any

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.pilot import Pilot

UNSEEN_SCALE = 3.0
"Standard deviation taken for a number that the clone never scaled, of order one as they all are in SI."


def warm_start(learner: Any, scaled: Any, start: Pilot, senses: tuple[str, ...]) -> None:
    """Make the policy's mean drive as `start` does; its value function stays as it is.

    What `start` does not sense, the past included, has no weight at first. The scaling of the observations
    stays at that of `start`. UserError where `start` is no network, senses what the learner does not, has a
    memory or other layers.
    """
    import torch

    if not isinstance(start, NetworkPilot):
        raise UserError(f"PPO cannot start from a {start.kind} pilot; name one of kind cloning or ppo")
    weights = start.weights()
    places = _places(start, senses)
    width = scaled.observation_space.shape[0]
    mean, var = np.zeros(width), np.full(width, UNSEEN_SCALE**2)
    mean[places], var[places] = weights["mean"], weights["scale"].astype(float) ** 2
    scaled.obs_rms.mean, scaled.obs_rms.var = mean, var
    modules = [*learner.policy.mlp_extractor.policy_net, learner.policy.action_net]
    linear = [module for module in modules if isinstance(module, torch.nn.Linear)]
    layers = _as_actions(weights, len(linear))
    first = np.zeros((width, layers[0][0].shape[1]), dtype=np.float32)
    first[places] = layers[0][0]
    layers[0] = (first, layers[0][1])
    with torch.no_grad():
        for module, (weight, bias) in zip(linear, layers, strict=True):
            if module.weight.shape != weight.T.shape:
                raise UserError(f"the initial pilot has a layer {weight.shape}; use the same `hidden`")
            module.weight.copy_(torch.from_numpy(weight.T.copy()))
            module.bias.copy_(torch.from_numpy(bias.copy()))


def freeze_policy(learner: Any, frozen: bool) -> None:
    """Let training change the value function alone, or all."""
    policy = learner.policy
    for module in (policy.mlp_extractor.policy_net, policy.action_net):
        module.requires_grad_(not frozen)
    policy.log_std.requires_grad_(not frozen)


def _places(start: NetworkPilot, senses: tuple[str, ...]) -> list[int]:
    missing = [name for name in start.senses if name not in senses]
    if missing or start.settings()["memory"]:
        what = f"senses {missing[0]}" if missing else "has a memory"
        raise UserError(f"the pilot to start from {what}, which the learner does not start with")
    return [senses.index(name) for name in start.senses]


def _as_actions(weights: dict[str, Array], layers: int) -> list[tuple[Array, Array]]:
    """The layers (weight, bias) with levers turned into actions from -1 to 1."""
    if f"weight_{layers - 1}" not in weights or f"weight_{layers}" in weights:
        raise UserError("the initial pilot has another number of layers; use the same `hidden`")
    pairs = [(weights[f"weight_{i}"], weights[f"bias_{i}"]) for i in range(layers)]
    middle, reach = 0.5 * (HIGHEST + LOWEST), 0.5 * (HIGHEST - LOWEST)
    weight, bias = pairs[-1]
    pairs[-1] = ((weight / reach).astype(np.float32), ((bias - middle) / reach).astype(np.float32))
    return pairs

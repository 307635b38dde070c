"""Behaviour cloning: a small network learns by regression what the logged pilots did where they were."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from swamp_rl.pilots.demonstrations import NEXT_GATE, POSE, examples
from swamp_rl.pilots.network import NetworkPilot, layers_of
from swamp_rl.pilots.settings import Count, NotNegative, Positive, Seed, Settings
from swamp_rl.runs import Run


class CloningSettings(Settings):
    """What is sensed, how large the network is and how it is trained (AdamW, mean squared error).

    The defaults were chosen on episodes from seed 1000000 on, which the main job does not evaluate. A clone
    that senses surge and sway as well does worse: from the motion it learns what the levers have just done.
    """

    senses: Annotated[tuple[str, ...], Field(min_length=1)] = (*POSE, "yaw_rate", *NEXT_GATE)
    reaction: NotNegative = 0.4
    "Time [s] from what the logged pilot saw to the lever that it led to: the clone is to act at once."
    hidden: Annotated[tuple[Count, ...], Field(min_length=1)] = (64, 64)
    epochs: Count = 60
    batch_size: Count = 256
    learning_rate: Positive = 2e-3
    weight_decay: NotNegative = 1e-3
    noise: NotNegative = 0.0
    "Standard deviation of noise on the scaled observations, new each epoch, against learning by heart."
    seed: Seed = 0


def fit_cloning(
    runs: Sequence[Run],
    settings: CloningSettings | None = None,
    tick: Callable[[float], None] = lambda done: None,
) -> NetworkPilot:
    """A pilot regressed on `runs`; the same seed gives the same pilot on the same machine.

    Where pilots at the same place held a lever hard over to either side, the clone holds it in between.
    `tick` hears the share done. UserError where a run lacks a column; those of the next gate
    are put there by `envs.hindsight.with_gates`.
    """
    import torch

    settings = settings or CloningSettings()
    seen, levers = (np.concatenate(parts) for parts in examples(runs, settings.senses, settings.reaction))
    mean, scale = seen.mean(axis=0), np.maximum(seen.std(axis=0), 1e-6)
    inputs = torch.tensor((seen - mean) / scale, dtype=torch.float32)
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(settings.seed)
        network = _network((len(settings.senses), *settings.hidden, 2))
        _train(network, inputs, torch.tensor(levers, dtype=torch.float32), settings, tick)
    return NetworkPilot("cloning", settings.senses, {"mean": mean, "scale": scale, **layers_of(network)})


def _network(widths: Sequence[int]) -> Any:
    import torch

    layers: list[Any] = []
    for before, after in pairwise(widths):
        layers += [torch.nn.Linear(before, after), torch.nn.Tanh()]
    return torch.nn.Sequential(*layers[:-1])


def _train(
    network: Any, inputs: Any, levers: Any, settings: CloningSettings, tick: Callable[[float], None]
) -> None:
    """The learning rate falls to nought by half a cosine."""
    import torch

    optimiser = torch.optim.AdamW(
        network.parameters(), lr=settings.learning_rate, weight_decay=settings.weight_decay
    )
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, settings.epochs)
    for epoch in range(settings.epochs):
        for batch in torch.randperm(len(inputs)).split(settings.batch_size):
            noisy = inputs[batch] + settings.noise * torch.randn_like(inputs[batch])
            loss = torch.nn.functional.mse_loss(network(noisy), levers[batch])
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
        schedule.step()
        tick((epoch + 1) / settings.epochs)

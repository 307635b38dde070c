"""Behaviour cloning: regression of the logged levers on the observations by a small network."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from swamp_rl.one_thread import one_thread
from swamp_rl.pilots.callbacks import Log, Tick
from swamp_rl.pilots.demonstrations import NEXT_GATE, POSE, examples
from swamp_rl.pilots.network import NetworkPilot, layers_of
from swamp_rl.pilots.regression import RegressionSettings, task_of, train_by_epochs
from swamp_rl.pilots.settings import Layers, Many
from swamp_rl.runs import Run


class CloningSettings(RegressionSettings):
    """Settings of behaviour cloning.

    The defaults were chosen on episodes of seeds from 1,000,000 on, which no experiment evaluates. With surge
    and sway as observations a clone performs worse: it infers the previous action from them.
    """

    senses: Annotated[tuple[str, ...], Field(min_length=1)] = (*POSE, "yaw_rate", *NEXT_GATE)
    hidden: Layers = (64, 64)
    batch_size: Many = 256


@one_thread(torch=True)
def fit_cloning(
    runs: Sequence[Run],
    settings: CloningSettings | None = None,
    tick: Tick = lambda done: None,
    checkpoint: Path | None = None,
    log: Log = lambda epoch, values: None,
) -> NetworkPilot:
    """Return a pilot fitted to `runs`; the same seed gives the same pilot on the same machine.

    The fit is to the conditional mean: where drivers held a lever at either end, the clone holds its mean.
    `tick`, `checkpoint`, `log`: see `train_by_epochs`. UserError where a run lacks a column; those of the
    next gate are added by `swamp_rl.envs.hindsight.with_gates`.
    """
    import torch

    settings = settings or CloningSettings()
    observations, levers, demonstrated = (
        np.concatenate(parts) for parts in examples(runs, settings.senses, settings.reaction)
    )
    observations, levers = observations[demonstrated], levers[demonstrated]
    mean, scale = observations.mean(axis=0), np.maximum(observations.std(axis=0), 1e-6)
    inputs = torch.tensor((observations - mean) / scale, dtype=torch.float32)
    targets = torch.tensor(levers, dtype=torch.float32)
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(settings.seed)
        network = _network((len(settings.senses), *settings.hidden, 2))

    def losses(generator: Any) -> Iterator[Any]:
        for batch in torch.randperm(len(inputs), generator=generator).split(settings.batch_size):
            noise = settings.noise * torch.randn(inputs[batch].shape, generator=generator)
            yield torch.nn.functional.mse_loss(network(inputs[batch] + noise), targets[batch])

    train_by_epochs(
        network, losses, settings, task_of(settings, (observations, levers)), tick, checkpoint, log
    )
    return NetworkPilot("cloning", settings.senses, {"mean": mean, "scale": scale, **layers_of(network)})


def _network(widths: Sequence[int]) -> Any:
    import torch

    layers: list[Any] = []
    for before, after in pairwise(widths):
        layers += [torch.nn.Linear(before, after), torch.nn.Tanh()]
    return torch.nn.Sequential(*layers[:-1])

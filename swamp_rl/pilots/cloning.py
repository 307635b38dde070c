"""Behaviour cloning: a small network learns by regression what the logged pilots did where they were."""

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
    """What is sensed, how large the network is and how it is trained.

    The defaults were chosen on episodes from seed 1000000 on, which the main job does not evaluate. A clone
    that senses surge and sway as well does worse: from the motion it learns what the levers have just done.
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
    """A pilot regressed on `runs`; the same seed gives the same pilot on the same machine.

    Where pilots at the same place held a lever hard over to either side, the clone holds it in between.
    `tick`, `checkpoint`, `log`: see `train_by_epochs`. UserError where a run lacks a column; those of the
    next gate are put there by `swamp_rl.envs.hindsight.with_gates`.
    """
    import torch

    settings = settings or CloningSettings()
    seen, levers, taught = (
        np.concatenate(parts) for parts in examples(runs, settings.senses, settings.reaction)
    )
    seen, levers = seen[taught], levers[taught]
    mean, scale = seen.mean(axis=0), np.maximum(seen.std(axis=0), 1e-6)
    inputs = torch.tensor((seen - mean) / scale, dtype=torch.float32)
    targets = torch.tensor(levers, dtype=torch.float32)
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(settings.seed)
        network = _network((len(settings.senses), *settings.hidden, 2))

    def losses(chance: Any) -> Iterator[Any]:
        for batch in torch.randperm(len(inputs), generator=chance).split(settings.batch_size):
            noise = settings.noise * torch.randn(inputs[batch].shape, generator=chance)
            yield torch.nn.functional.mse_loss(network(inputs[batch] + noise), targets[batch])

    train_by_epochs(network, losses, settings, task_of(settings, (seen, levers)), tick, checkpoint, log)
    return NetworkPilot("cloning", settings.senses, {"mean": mean, "scale": scale, **layers_of(network)})


def _network(widths: Sequence[int]) -> Any:
    import torch

    layers: list[Any] = []
    for before, after in pairwise(widths):
        layers += [torch.nn.Linear(before, after), torch.nn.Tanh()]
    return torch.nn.Sequential(*layers[:-1])

"""Training of networks by regression in epochs, resumable from a checkpoint with the same bits."""

import hashlib
import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.callbacks import Log, Tick
from swamp_rl.pilots.checkpoint import (
    load_checkpoint,
    load_module_state,
    load_optimiser_state,
    module_state,
    optimiser_state,
    readable,
    save_checkpoint,
)
from swamp_rl.pilots.demonstrations import rows_to_learn
from swamp_rl.pilots.divergence import refuse_diverged
from swamp_rl.pilots.settings import Count, NotNegative, Positive, Seconds, Seed, Settings
from swamp_rl.runs import Run

Losses = Callable[[Any], Iterable[Any]]
"""The losses of an epoch's batches, one at a time, from the torch Generator of the epoch."""
REMEDY = "lower learning_rate or weight_decay"


class RegressionSettings(Settings):
    """Settings common to all networks: AdamW (Loshchilov and Hutter 2019), squared error."""

    senses: Annotated[tuple[str, ...], Field(min_length=1)]
    reaction: Seconds = 0.4
    "Reaction time [s] of the logged driver: the levers are shifted by it, the clone acts without delay."
    epochs: Count = 60
    learning_rate: Positive = 2e-3
    "Initial value; cosine decay to zero."
    weight_decay: NotNegative = 1e-3
    noise: NotNegative = 0.0
    "Standard deviation of the noise on the scaled observations, new each epoch, to reduce overfitting."
    seed: Seed = 0

    def check_runs(self, runs: Sequence[Run]) -> None:
        """Raise SettingsError as `rows_to_learn`."""
        rows_to_learn(runs, self.reaction)


def train_by_epochs(
    network: Any,
    losses: Losses,
    settings: RegressionSettings,
    task: str,
    tick: Tick,
    checkpoint: Path | None = None,
    log: Log = lambda epoch, values: None,
) -> None:
    """Train the torch `network` for `settings.epochs`; `tick` is called with the share done, `log` with each
    epoch's mean `loss`, including epochs before a resumption.

    checkpoint: a file written after each epoch and resumed from if it is of the same `task` (from `task_of`);
    that of another task is overwritten. Random numbers of an epoch depend on the seed and the epoch alone.
    SettingsError where the training diverges.
    """
    import torch

    optimiser = torch.optim.AdamW(
        network.parameters(), lr=settings.learning_rate, weight_decay=settings.weight_decay
    )
    means = [] if checkpoint is None else _resume(network, optimiser, checkpoint, task)
    for epoch, mean in enumerate(means, 1):
        log(epoch, {"loss": mean})
    for epoch in range(len(means), settings.epochs):
        for group in optimiser.param_groups:
            group["lr"] = settings.learning_rate * 0.5 * (1.0 + math.cos(math.pi * epoch / settings.epochs))
        batch_losses = []
        for loss in losses(generator_of(settings.seed, epoch)):
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            batch_losses.append(float(loss.detach()))
        means.append(float(np.mean(batch_losses)))
        refuse_diverged([means[-1], *module_state("network", network).values()], REMEDY)
        if checkpoint is not None:
            arrays = module_state("network", network) | optimiser_state("optimiser", optimiser)
            save_checkpoint(checkpoint, {"task": task, "losses": means}, arrays)
        log(epoch + 1, {"loss": means[-1]})
        tick((epoch + 1) / settings.epochs)


def generator_of(seed: int, epoch: int) -> Any:
    """The torch Generator of one epoch."""
    import torch

    drawn = int(np.random.SeedSequence([seed, epoch]).generate_state(1, np.uint64)[0])
    return torch.Generator().manual_seed(drawn >> 1)


def task_of(settings: Settings, arrays: Iterable[Array]) -> str:
    """Return a hash of the settings and the training data, which identifies a training."""
    hashed = hashlib.sha256(f"{type(settings).__name__} {settings.model_dump_json()}".encode())
    for array in arrays:
        hashed.update(np.ascontiguousarray(array).tobytes())
    return hashed.hexdigest()


def _resume(network: Any, optimiser: Any, path: Path, task: str) -> list[float]:
    """Load a checkpoint into network and optimiser; return the mean losses of the epochs done."""
    kept = load_checkpoint(path)
    if kept is None:
        return []
    description, arrays = kept
    with readable(path):
        if description["task"] != task:
            return []
        load_module_state("network", network, arrays)
        load_optimiser_state("optimiser", optimiser, arrays)
        return [float(mean) for mean in description["losses"]]

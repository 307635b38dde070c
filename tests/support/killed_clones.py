"""A clone whose training is killed at random instants and started again, until it has ended.

    python -m tests.support.killed_clones FOLDER SEED

It writes the pilot into FOLDER/pilot and prints how often it was killed. A process of its own, for it forks.
"""

import sys
from pathlib import Path

import torch

from swamp_rl.pilots.cloning import CloningSettings, fit_cloning
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.store import save_pilot
from tests.support.killed import lead_lives
from tests.support.steering_runs import RUNS

SENSES = ("north", "east", "cos_heading", "sin_heading")
SETTINGS = CloningSettings(senses=SENSES, epochs=20, noise=0.05, seed=3)


def trained(checkpoint: Path | None, settings: CloningSettings = SETTINGS) -> NetworkPilot:
    """The pilot of a whole training, from the checkpoint on where there is one."""
    return fit_cloning(RUNS, settings, checkpoint=checkpoint)


if __name__ == "__main__":
    torch.set_num_threads(1)  # a fork has none of its parent's other threads, and would wait for them
    save_pilot(
        trained(None, SETTINGS.model_copy(update={"epochs": 1})), Path(sys.argv[1]) / "pilot"
    )  # imports
    lead_lives(trained)

"""A clone whose training is killed at random instants and started again, until it has ended.

    python -m tests.killed_clones FOLDER SEED

It writes the pilot into FOLDER/pilot and prints how often it was killed. A process of its own, for it forks.
"""

import random
import sys
from pathlib import Path

import torch

from swamp_rl.pilots.cloning import CloningSettings, fit_cloning
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.store import save_pilot
from tests.lives import killed_until_done
from tests.test_reservoir import RUNS

SENSES = ("north", "east", "cos_heading", "sin_heading")
SETTINGS = CloningSettings(senses=SENSES, epochs=20, noise=0.05, seed=3)


def trained(checkpoint: Path | None, settings: CloningSettings = SETTINGS) -> NetworkPilot:
    """The pilot of a whole training, from the checkpoint on where there is one."""
    return fit_cloning(RUNS, settings, checkpoint=checkpoint)


def main() -> None:
    """One life after another."""
    folder, chance = Path(sys.argv[1]), random.Random(int(sys.argv[2]))
    torch.set_num_threads(1)  # a fork has none of its parent's other threads, and would wait for them
    few = SETTINGS.model_copy(update={"epochs": 1})
    save_pilot(trained(folder / "warm", few), folder / "pilot")  # whatever is imported for it
    kills, done = killed_until_done(
        lambda: save_pilot(trained(folder / "checkpoint"), folder / "pilot"), folder / "checkpoint", chance
    )
    print(kills)
    sys.exit(not done)


if __name__ == "__main__":
    main()

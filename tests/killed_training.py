"""A training by PPO that is killed at random instants and started again, until it has ended.

    python -m tests.killed_training FOLDER SEED

It writes the pilot into FOLDER/pilot and prints how often it was killed. A process of its own, for it forks.
"""

import random
import sys
from pathlib import Path

from envs.batched import GatesVectorEnv
from envs.sb3 import GatesVecEnv
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.ppo import PPOSettings, train_ppo
from swamp_rl.pilots.store import save_pilot
from tests.lives import killed_until_done

SETTINGS = PPOSettings(boats=8, decisions=1280, horizon=32, batch_size=64, epochs=2, leg=1, memory=1, seed=3)


def trained(checkpoint: Path | None, settings: PPOSettings = SETTINGS) -> NetworkPilot:
    """The pilot of a whole training, from the checkpoint on where there is one."""
    boats = GatesVectorEnv(8, observation=settings.senses, disturbances="severe", autoreset_mode="SameStep")
    return train_ppo(GatesVecEnv(boats, settings.hold), settings, checkpoint=checkpoint)


def main() -> None:
    """One life after another."""
    folder, chance = Path(sys.argv[1]), random.Random(int(sys.argv[2]))
    trained(None, SETTINGS.model_copy(update={"decisions": 1}))  # whatever is imported and compiled for it
    kills, done = killed_until_done(
        lambda: save_pilot(trained(folder / "checkpoint"), folder / "pilot"), folder / "checkpoint", chance
    )
    print(kills)
    sys.exit(not done)


if __name__ == "__main__":
    main()

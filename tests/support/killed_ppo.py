"""A training by PPO that is killed at random instants and started again, until it has ended.

    python -m tests.support.killed_ppo FOLDER SEED

It writes the pilot into FOLDER/pilot and prints how often it was killed. A process of its own, for it forks.
"""

from pathlib import Path

from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.sb3 import GatesVecEnv

from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.ppo import PPOSettings, train_ppo
from tests.support.killed import lead_lives

SETTINGS = PPOSettings(boats=8, decisions=1280, horizon=32, batch_size=64, epochs=2, leg=1, memory=1, seed=3)


def trained(checkpoint: Path | None, settings: PPOSettings = SETTINGS) -> NetworkPilot:
    """The pilot of a whole training, from the checkpoint on where there is one."""
    boats = GatesVectorEnv(8, observation=settings.senses, disturbances="severe", autoreset_mode="SameStep")
    return train_ppo(GatesVecEnv(boats, settings.hold), settings, checkpoint=checkpoint)


if __name__ == "__main__":
    trained(None, SETTINGS.model_copy(update={"decisions": 1}))  # whatever is imported and compiled for it
    lead_lives(trained)

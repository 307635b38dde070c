"""A training by SAC that is killed at random instants and started again, until it has ended.

    python -m tests.support.killed_sac FOLDER SEED

It writes the pilot into FOLDER/pilot and prints how often it was killed. A process of its own, for it forks.
"""

from pathlib import Path

from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.sb3 import GatesVecEnv

from swamp_rl.pilots.callbacks import Log
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.sac import SACSettings, train_sac
from tests.support.killed import lead_lives

SETTINGS = SACSettings(boats=8, decisions=1020, random=200, updates=1, hidden=(16,), leg=20, seed=3)


def trained(
    checkpoint: Path | None,
    settings: SACSettings = SETTINGS,
    log: Log = lambda decisions, values: None,
) -> NetworkPilot:
    """The pilot of a whole training, from the checkpoint on where there is one."""
    boats = GatesVectorEnv(8, observation=settings.senses, disturbances="severe", autoreset_mode="SameStep")
    return train_sac(GatesVecEnv(boats, settings.hold), settings, log=log, checkpoint=checkpoint)


if __name__ == "__main__":
    trained(None, SETTINGS.model_copy(update={"decisions": 300}))  # whatever is imported and compiled for it
    lead_lives(trained)

"""A training by PPO that is killed at random instants and started again, until it has ended.

    python -m tests.killed_training FOLDER SEED

It writes the pilot into FOLDER/pilot and prints how often it was killed. A process of its own, for it forks.
"""

import os
import random
import signal
import sys
import time
from pathlib import Path

from envs.batched import GatesVectorEnv
from envs.sb3 import GatesVecEnv
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.ppo import PPOSettings, train_ppo
from swamp_rl.pilots.store import save_pilot

SETTINGS = PPOSettings(boats=8, decisions=1280, horizon=32, batch_size=64, epochs=2, leg=1, memory=1, seed=3)


def trained(checkpoint: Path | None, settings: PPOSettings = SETTINGS) -> NetworkPilot:
    """The pilot of a whole training, from the checkpoint on where there is one."""
    boats = GatesVectorEnv(8, observation=settings.senses, disturbances="severe", autoreset_mode="SameStep")
    return train_ppo(GatesVecEnv(boats, settings.hold), settings, checkpoint=checkpoint)


def main() -> None:
    """One try after another, each with a little more time: at first half of what a whole training takes."""
    folder, chance = Path(sys.argv[1]), random.Random(int(sys.argv[2]))
    trained(None, SETTINGS.model_copy(update={"decisions": 1}))  # whatever is imported and compiled for it
    began = time.perf_counter()
    trained(None)
    kills, patience = 0, 0.5 * (time.perf_counter() - began)
    while True:
        child = os.fork()
        if child == 0:
            save_pilot(trained(folder / "checkpoint"), folder / "pilot")
            os._exit(0)
        time.sleep(patience * chance.random())
        os.kill(child, signal.SIGKILL)
        status = os.waitpid(child, 0)[1]
        if status != signal.SIGKILL:
            break
        kills, patience = kills + 1, patience * 1.2
    print(kills)
    sys.exit(status != 0)


if __name__ == "__main__":
    main()

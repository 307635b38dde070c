"""A wrapper that adds a penalty for failed episodes; imported only for training by stable-baselines3."""

from typing import Any

import numpy as np
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper

from swamp_rl.pilots.arrays import Array


class CautiousBoats(VecEnvWrapper):
    """A VecEnv that subtracts `caution` from the last reward of episodes that fail before the time limit."""

    def __init__(self, boats: VecEnv, caution: float) -> None:
        super().__init__(boats)
        self._caution = caution

    def reset(self) -> Any:
        """As of the boats."""
        return self.venv.reset()

    def step_wait(self) -> tuple[Any, Array, Array, list[dict[str, Any]]]:
        """As of the boats, with the penalty in the rewards (n,)."""
        seen, rewards, dones, infos = self.venv.step_wait()
        for i in np.flatnonzero(dones):
            if infos[i]["outcome"] != "success" and not infos[i]["TimeLimit.truncated"]:
                rewards[i] -= self._caution
        return seen, rewards, dones, infos

"""A wrapper that adds `Memory` to the observation; imported only for training by stable-baselines3."""

from typing import Any

import numpy as np
from gymnasium import spaces
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper

from swamp_rl.pilots.arrays import Array, levers_of
from swamp_rl.pilots.memory import Memory


class RememberingBoats(VecEnvWrapper):
    """A VecEnv with actions in [-1, 1] whose observations (n, d + depth (d + 2)) include the history."""

    def __init__(self, boats: VecEnv, depth: int) -> None:
        assert boats.observation_space.shape is not None
        self._memory = Memory(depth, boats.observation_space.shape[0])
        self._seen = np.empty((0, self._memory.width), np.float32)
        super().__init__(boats, spaces.Box(-np.inf, np.inf, (self._memory.seen_width,), np.float32))

    def reset(self) -> Array:
        """Return observations (n, ...) of boats without history."""
        self._seen = np.asarray(self.venv.reset())
        self._memory.begin(self.num_envs)
        return self._memory.recall(self._seen)

    def step_async(self, actions: Array) -> None:
        """Append the actions (n, 2), as levers, to the history and pass them on."""
        self._memory.keep(self._seen, levers_of(actions))
        self.venv.step_async(actions)

    def step_wait(self) -> tuple[Array, Array, Array, list[dict[str, Any]]]:
        """As of the boats; a terminal observation includes its history, a first one has none."""
        seen, rewards, dones, infos = self.venv.step_wait()
        for i in np.flatnonzero(dones):
            last = infos[i]["terminal_observation"]
            infos[i]["terminal_observation"] = self._memory.recall(last[None], [int(i)])[0]
        self._memory.forget(dones)
        self._seen = np.asarray(seen)
        return self._memory.recall(self._seen), rewards, dones, infos

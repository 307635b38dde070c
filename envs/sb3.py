"""The batched environment as stable-baselines3 wants it; imported only by who trains with that library."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorWrapper
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.spaces import joypad_space
from swamp_rl.envs.task import MOST_STEPS

from swamp_rl.errors import UserError
from swamp_rl.whole_number import whole_number


class GatesVecEnv(VecEnv):
    """A `GatesVectorEnv` behind stable-baselines3's own interface, without a Python loop over the boats.

    Actions are in [-1, 1], as the library wants them, and reach over the whole way of each lever: a learner
    whose first guess is nought begins at half throttle, where trying less and more both do something.
    The info of a boat that ends holds `terminal_observation` (d,), `TimeLimit.truncated`, `outcome` and
    `time` [s].
    """

    def __init__(self, boats: GatesVectorEnv, hold: int = 1) -> None:
        """boats: with `autoreset_mode` SAME_STEP, which is what the library expects; UserError otherwise.

        hold: steps of the boats for which each action is held; their rewards are summed.
        """
        if isinstance(boats, VectorWrapper):
            raise UserError(
                f"GatesVecEnv: takes the batch itself, not Gymnasium's wrapper {type(boats).__name__}; use a "
                "wrapper of stable-baselines3, such as VecMonitor(GatesVecEnv(batch))"
            )
        if not isinstance(boats, GatesVectorEnv) or boats.autoreset_mode != AutoresetMode.SAME_STEP:
            raise UserError(
                "GatesVecEnv: needs a batch that restarts in the same step: gymnasium.make_vec("
                '"swamp/Gates-v1", num_envs=8, autoreset_mode="SameStep")'
            )
        self.boats, self.hold = boats, whole_number("GatesVecEnv: hold", hold, 1, MOST_STEPS)
        self._actions: NDArray[Any] | None = None
        levers = joypad_space()
        self._middle, self._reach = 0.5 * (levers.high + levers.low), 0.5 * (levers.high - levers.low)
        whole = spaces.Box(-1.0, 1.0, levers.shape, np.float32)
        super().__init__(boats.num_envs, boats.single_observation_space, whole)
        self.metadata = {**boats.metadata, "render_fps": boats.metadata["render_fps"] / self.hold}

    def reset(self) -> NDArray[np.float32]:
        """Observations (n, d); boat i takes the seed of `seed()` plus i, if that was called since the last
        reset. Options of `set_options` are those of the batch; UserError for a list of them."""
        options = self._options[0]
        if any(other is not options and (other or options) for other in self._options[1:]):
            raise UserError("set_options: the boats share their options; give one dict for all")
        observations, _ = self.boats.reset(seed=self._seeds[0], options=options)
        self._reset_seeds()
        self._reset_options()
        return observations

    def step_async(self, actions: NDArray[Any]) -> None:
        """Note the actions (n, 2) for `step_wait`."""
        self._actions = actions

    def step_wait(
        self,
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Observations (n, d), rewards, dones (n,) and an info for each boat."""
        assert self._actions is not None
        levers = self._middle + self._reach * self._actions
        observations, rewards, terminated, truncated, info = self.boats.step_held(levers, self.hold)
        dones = terminated | truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for i in np.flatnonzero(dones):
            infos[i] = {
                "terminal_observation": info["final_obs"][i],
                "TimeLimit.truncated": bool(truncated[i]),
                "outcome": info["final_info"]["outcome"][i],
                "time": float(info["final_info"]["time"][i]),
            }
        return observations, rewards.astype(np.float32), dones, infos

    def close(self) -> None:
        """Close the boats."""
        self.boats.close()

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """A top view of each boat, or None of each where there is no render mode."""
        frames = self.boats.render()
        return [None] * self.num_envs if frames is None else frames

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The attribute of the batch, once for each of the boats asked for: they share it."""
        return [getattr(self.boats, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set the attribute of the batch."""
        setattr(self.boats, attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any
    ) -> list[Any]:
        """Call a method of the batch once; its result for each of the boats asked for."""
        result = getattr(self.boats, method_name)(*method_args, **method_kwargs)
        return [result] * len(list(self._get_indices(indices)))

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """Never: there are no single environments to wrap."""
        return [False] * len(list(self._get_indices(indices)))

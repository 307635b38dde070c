"""One boat as a `gymnasium.Env`."""

from typing import Any, Unpack

import gymnasium
import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.fleet import Fleet
from swamp_rl.envs.kernel import CUT
from swamp_rl.envs.spaces import joypad_space, known_levers, known_options, known_render_mode
from swamp_rl.envs.task import Task, TaskArguments, refuse_unknown

from swamp_rl.errors import UserError
from swamp_rl.whole_number import known_seed

ONLY = np.zeros(1, dtype=np.intp)
PAIR = (2,)


class GatesEnv(gymnasium.Env[NDArray[Any], NDArray[Any]]):
    """Drive a boat through the gates of a course by its joypad: `swamp/Gates-v1`.

    Action: throttle in [0, 1] and angle in [-1, 1], held for `step` seconds; what is beyond is brought back
    to the end of the lever's way. What is not two numbers is a UserError that leaves the episode as it was.
    Observation: `envs.observation.OBSERVATION`, or the names given as `observation`; SI units. Reward: see
    `envs.reward`. The run ends in success when the gates are passed in order, each from behind; as a failure
    when the boat touches a buoy or the ground or leaves the bounds; it is truncated at the time limit, and
    where the simulated motion diverges, with the last finite observation. The last `info` holds `outcome`
    (success, buoy, aground, out_of_bounds, timeout or diverged) and `time` [s]. `reset(seed=s)` gives the
    same episode, bit for bit, as boat i of a batch reset with seed s - i.

    Arguments by name: `envs.task.TaskArguments`. UserError for what is unknown, cannot be read or does not
    fit. docs/environment.md has the whole.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012  as Gymnasium

    def __init__(self, *, render_mode: str | None = None, **task: Unpack[TaskArguments]) -> None:
        refuse_unknown(task, ("render_mode",))
        self.render_mode = known_render_mode(render_mode)
        self.task = Task.read(**task)
        self.metadata = {**self.metadata, "render_fps": self.task.frames_per_second}
        self.fleet = Fleet(1, self.task)
        self.action_space = joypad_space()
        self.observation_space = self.task.observation_space
        self._started = False
        self._asked, self._reward = np.zeros((1, 2)), np.zeros(1)
        self._seen = np.empty((1, *self.observation_space.shape), np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start an episode; observation (d,) and an empty info. There are no options."""
        super().reset(seed=known_seed("reset", seed))
        known_options(options, ())
        self.fleet.draw_from([self.np_random])
        self.fleet.begin(ONLY)
        self._started = True
        self.fleet.look(ONLY, self._seen)
        return self._seen[0].copy(), {}

    def step(self, action: NDArray[Any]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Sail for one step; observation (d,), reward, terminated, truncated, info."""
        if not self._started:
            raise UserError("step: the episode has not started; call reset first")
        if type(action) is np.ndarray and action.shape == PAIR and action.dtype.kind == "f":
            self._asked[0] = action  # the usual case, without the copy of `known_levers`
        else:
            self._asked[0] = known_levers(action, PAIR)
        if not self.fleet.sail(self._asked, self._reward, self._seen):
            return self._seen[0].copy(), self._reward.item(), False, False, {}
        truncated = self.fleet.boats["outcome"].item() in CUT
        info = {"outcome": self.fleet.outcomes(ONLY)[0], "time": self.fleet.time.item()}
        return self._seen[0].copy(), self._reward.item(), not truncated, truncated, info

    def render(self) -> NDArray[np.uint8] | None:
        """The course from above, north up, (H, W, 3); None unless the render mode is `rgb_array`."""
        if self.render_mode is None:
            return None
        from swamp_rl.envs.view import top_view

        return top_view(self.fleet, 0)

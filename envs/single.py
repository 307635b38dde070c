"""One boat as a `gymnasium.Env`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.fleet import Disturbances, Fleet
from swamp_rl.envs.kernel import CUT
from swamp_rl.envs.observation import observation_space
from swamp_rl.envs.spaces import joypad_space, known_levers, known_options, known_render_mode, known_seed

from swamp_rl.boat import Boat
from swamp_rl.course import Course
from swamp_rl.errors import UserError

ONLY = np.zeros(1, dtype=np.intp)
PAIR = (2,)


class GatesEnv(gymnasium.Env[NDArray[Any], NDArray[Any]]):
    """Drive a boat through the gates of a course by its joypad: `swamp/Gates-v1`.

    Action: throttle in [0, 1] and angle in [-1, 1], held for `step` seconds; what is beyond is brought back
    to the end of the lever's way. What is not two numbers is a UserError that leaves the episode as it was.
    Observation: the names in `envs.observation.OBSERVATION`, or those of them given as `observation`; SI
    units. Reward: see `envs.reward`. The run ends in success when the gates are passed in order, each from
    behind; as a failure when the boat touches a buoy or leaves the bounds; it is truncated at the course's
    time limit, and where the simulated motion diverges, with the last finite observation. The last `info`
    holds `outcome` (success, buoy, out_of_bounds, timeout or diverged) and `time` [s].
    `reset(seed=s)` gives the same episode, bit for bit, as boat i of a batch reset with seed s - i.

    boat, course, disturbances: a name in `configs`, a path, or the thing itself (a list of effects for
    disturbances, None for none). UserError for what cannot be read or does not fit.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012  as Gymnasium

    def __init__(
        self,
        boat: str | Path | Boat = "swamp",
        course: str | Path | Course = "camogli",
        disturbances: Disturbances = None,
        observation: Sequence[str] | None = None,
        step: float = 0.1,
        render_mode: str | None = None,
    ) -> None:
        self.render_mode = known_render_mode(render_mode)
        self.fleet = Fleet(1, boat, course, disturbances, observation, step)
        self.action_space = joypad_space()
        self.observation_space = observation_space(self.fleet.places, len(self.fleet.course.gates))
        self._started = False
        self._asked, self._reward = np.zeros((1, 2)), np.zeros(1)
        self._shape = (1, len(self.fleet.places))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start an episode; observation (d,) and an empty info. There are no options."""
        super().reset(seed=known_seed(seed))
        known_options(options, ())
        self.fleet.draw_from([self.np_random])
        self.fleet.begin(ONLY)
        self._started = True
        observations = np.empty(self._shape, np.float32)
        self.fleet.look(ONLY, observations)
        return observations[0], {}

    def step(self, action: NDArray[Any]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Sail for one step; observation (d,), reward, terminated, truncated, info."""
        if not self._started:
            raise UserError("step: the episode has not started; call reset first")
        if type(action) is np.ndarray and action.shape == PAIR and action.dtype.kind == "f":
            self._asked[0] = action  # the usual case, without the copy of `known_levers`
        else:
            self._asked[0] = known_levers(action, PAIR)
        observations = np.empty(self._shape, np.float32)
        if not self.fleet.sail(self._asked, self._reward, observations):
            return observations[0], self._reward.item(), False, False, {}
        truncated = self.fleet.boats["outcome"].item() in CUT
        info = {"outcome": self.fleet.outcomes(ONLY)[0], "time": self.fleet.time.item()}
        return observations[0], self._reward.item(), not truncated, truncated, info

    def render(self) -> NDArray[np.uint8] | None:
        """The course from above, north up, (H, W, 3); None unless the render mode is `rgb_array`."""
        if self.render_mode is None:
            return None
        from swamp_rl.envs.view import top_view

        return top_view(self.fleet, 0)

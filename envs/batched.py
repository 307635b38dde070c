"""Many boats as a `gymnasium.vector.VectorEnv`, all in one compiled step."""

from collections.abc import Sequence
from typing import Any, Unpack

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray
from swamp_rl.envs.fleet import Fleet
from swamp_rl.envs.kernel import CUT, RUNNING
from swamp_rl.envs.spaces import joypad_space, known_levers, known_options, known_render_mode
from swamp_rl.envs.supply import Supply
from swamp_rl.envs.task import MOST_STEPS, Task, TaskArguments, refuse_unknown

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.whole_number import known_seed, whole_number

Step = tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]
Array = NDArray[Any]
MOST_BOATS = 1_000_000


class GatesVectorEnv(VectorEnv[Array, Array, Array]):
    """`GatesEnv`, n boats at once; what `gymnasium.make_vec("swamp/Gates-v1", num_envs=n)` makes.

    A boat that has ended starts anew by itself: with `autoreset_mode` NEXT_STEP (the default, and
    Gymnasium's) in the following step, which ignores its levers and pays nothing, so that until then `pose`
    and the others still show how it ended; with SAME_STEP at once, its last observation and info being in
    `info["final_obs"]` and `info["final_info"]`. An episode of a boat depends on its own generator alone.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012  Gymnasium declares it so
        "render_modes": ["rgb_array"],
        "render_fps": 10,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        num_envs: int = 1,
        *,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        **task: Unpack[TaskArguments],
    ) -> None:
        refuse_unknown(task, ("num_envs", "render_mode", "autoreset_mode"))
        self.num_envs = whole_number("num_envs:", num_envs, 1, MOST_BOATS)
        self.render_mode = known_render_mode(render_mode)
        self.autoreset_mode = _known_autoreset(autoreset_mode)
        self.task = Task.read(**task)
        own = {"autoreset_mode": self.autoreset_mode, "render_fps": self.task.frames_per_second}
        self.metadata = {**self.metadata, **own}
        self.fleet = Fleet(num_envs, self.task)
        self.single_action_space = joypad_space()
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.single_observation_space = self.task.observation_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._started = self._once = False
        self._ended = np.empty(0, dtype=np.intp)
        self._shape = (num_envs, *self.single_observation_space.shape)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start an episode of every boat; observation (n, d) and an empty info.

        seed: boat i takes the generator of seed + i. options: `episodes`, (n,) seeds, one for each boat, in
        place of `seed`. With neither, each boat goes on with its generator. `once`, bool: a boat that has
        ended does not start anew, but lies still and stays over until the next reset.
        """
        if isinstance(seed, list | tuple | np.ndarray):
            raise UserError('reset: seed must be one whole number; several are options={"episodes": seeds}')
        seed = known_seed("reset", seed)
        super().reset(seed=seed)
        asked = known_options(options, ("episodes", "once"))
        episodes, once = asked.get("episodes"), asked.get("once", False)
        if not isinstance(once, bool | np.bool_):
            raise UserError(f"reset: once must be True or False, not {clipped(repr(once))}")
        seeds: Sequence[int | None] = [None] * self.num_envs
        if episodes is not None:
            seeds = _seeds(episodes, self.num_envs)
        elif seed is not None:
            seeds = range(seed, seed + self.num_envs)
        if episodes is not None or seed is not None or not self._started:
            self.fleet.draw_from([np.random.default_rng(s) for s in seeds])
        self._once = bool(once)
        everyone = np.arange(self.num_envs)
        self.fleet.begin(everyone)
        self._started, self._ended = True, everyone[:0]
        observations = np.empty(self._shape, np.float32)
        self.fleet.look(everyone, observations)
        return observations, {}

    def step(self, actions: Array) -> Step:
        """Sail all boats for one step with actions (n, 2).

        Observations (n, d), rewards, terminations, truncations (n,); the info of boats that end holds
        `outcome` and `time` [s], each with its mask `_outcome` and `_time` (n,).
        """
        return self.step_held(actions, 1)

    def step_held(self, actions: Array, steps: int) -> Step:
        """As `step`, but the actions (n, 2) are held for so many steps, whose rewards are summed.

        A boat that ends on the way lies still until all have sailed their steps or have ended, and so does
        one that starts anew in this call.
        """
        if not self._started:
            raise UserError("step: the boats have not started; call reset first")
        steps = whole_number("step_held: steps", steps, 1, MOST_STEPS)
        asked = known_levers(actions, (self.num_envs, 2))
        self.fleet.refuse_levers(asked)
        begun, self._ended = self._ended, self._ended[:0]
        if begun.size:
            self.fleet.begin(begun)
        observations, rewards = np.empty(self._shape, np.float32), np.zeros(self.num_envs)
        over, truncated = np.zeros(self.num_envs, np.bool_), np.zeros(self.num_envs, np.bool_)
        info: dict[str, Any] = {}
        paid, ended = np.empty(self.num_envs), 0
        for _ in range(steps):
            if begun.size:
                self.fleet.boats["fresh"][begun] = True
            ended = self.fleet.sail(asked, paid, observations)
            rewards += paid
            if ended + begun.size == self.num_envs:
                break
        if ended:
            outcome = self.fleet.boats["outcome"]
            over, truncated = outcome != RUNNING, np.isin(outcome, CUT)
            info = self._end(over, observations)
        return observations, rewards, over & ~truncated, truncated, info

    def _end(self, over: NDArray[np.bool_], observations: NDArray[np.float32]) -> dict[str, Any]:
        """Info on the boats that are over (n,), which are started anew now or marked to be in the next
        step."""
        ended = np.flatnonzero(over)
        outcome = np.full(self.num_envs, None, dtype=object)
        outcome[ended] = self.fleet.outcomes(ended)
        time = np.where(over, self.fleet.time, 0.0)
        info = {"outcome": outcome, "_outcome": over, "time": time, "_time": over.copy()}
        if self._once:
            return info
        if self.autoreset_mode == AutoresetMode.NEXT_STEP:
            self._ended = ended
            return info
        final = observations.copy()
        self.fleet.begin(ended)
        self.fleet.look(ended, observations)
        return {"final_obs": final, "_final_obs": over.copy(), "final_info": info, "_final_info": over.copy()}

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """A top view (H, W, 3) of every boat; None unless the render mode is `rgb_array`."""
        if self.render_mode is None:
            return None
        from swamp_rl.envs.view import top_view

        return tuple(top_view(self.fleet, i) for i in range(self.num_envs))

    @property
    def pose(self) -> NDArray[np.float64]:
        """North, east [m] and heading [rad, not wrapped], (n, 3): a view that the next step changes."""
        return self.fleet.pose

    @property
    def sensed_pose(self) -> NDArray[np.float64]:
        """As `pose`, but as the sensors report it, (n, 3), an array of its own."""
        return self.fleet.sensed_pose

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Surge, sway [m/s over ground] and yaw rate [rad/s], (n, 3), a view."""
        return self.fleet.velocity

    @property
    def supply(self) -> Supply | None:
        """The batteries, where their charge is counted."""
        return self.fleet.supply

    @property
    def sensed_velocity(self) -> NDArray[np.float64]:
        """As `velocity`, but as the sensors report it, (n, 3), an array of its own."""
        return self.fleet.sensed_velocity

    @property
    def commands(self) -> NDArray[np.float64]:
        """What the levers asked of the thrusters: azimuths [rad], then throttles [1], (n, 2K), a view."""
        return self.fleet.commands

    @property
    def applied(self) -> NDArray[np.float64]:
        """What the thrusters did, (n, 2K) as `commands`, a view."""
        return self.fleet.applied


def _known_autoreset(mode: AutoresetMode | str) -> AutoresetMode:
    served = (AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP)
    for known in served:
        if mode in (known, known.value):
            return known
    raise UserError(f"autoreset_mode: must be one of {', '.join(m.value for m in served)}, not {mode!r}")


def _seeds(episodes: Any, n: int) -> list[int]:
    """The seeds of `episodes`, n whole numbers of at least 0; UserError otherwise."""
    try:
        seeds = np.asarray(episodes)
    except ValueError:  # rows of several lengths
        seeds = np.array(None)
    if seeds.shape != (n,) or seeds.dtype.kind not in "iu" or (seeds < 0).any():
        raise UserError(f"reset: episodes must be {n} seeds, whole numbers of at least 0")
    return [int(seed) for seed in seeds]

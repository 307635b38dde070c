"""n boats on one course: their episodes and their common step."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.depth import as_effects
from swamp_rl.envs.episodes import START_DRAWS, Episodes, Generators, draw_episodes
from swamp_rl.envs.kernel import (
    LEVERS,
    OUTCOMES,
    RUNNING,
    look_all,
    sail_all,
    sail_all_parallel,
    sense_all,
)
from swamp_rl.envs.own_step import OwnStep
from swamp_rl.envs.supply import Supply, counts_charge
from swamp_rl.envs.task import Task
from swamp_rl.envs.world import world_of

from swamp_rl.course import buoy_table, gate_table
from swamp_rl.errors import UserError
from swamp_rl.simulator import tank
from swamp_rl.simulator.state import ACTUATORS, NORTH, SURGE, YAW_RATE

PARALLEL_FROM = 256  # boats; with 128 two cores already gain, when no one else wants them


class Fleet:
    """The state of n boats and everything their step needs.

    Each episode takes from its boat's generator one block of uniforms, for the start and the disturbances,
    then one integer, the seed of its gusts; nothing else is random. Episodes are drawn ahead, for all the
    boats that have none waiting at once: drawing for one costs almost as much as drawing for a thousand.
    """

    def __init__(self, n: int, task: Task) -> None:
        self.task = task
        self.boat, self.course, self.level, self.step = task.boat, task.course, task.level, task.step
        self._now, self._next = (
            Episodes.empty(n, self.boat, self.course, self.level, self.step, counts_charge(task))
            for _ in range(2)
        )
        self._waiting = np.zeros(n, dtype=np.bool_)
        self._generators: Generators = ()
        self.boats, self.params = self._now.boats, self._now.params
        self._world = world_of(task)
        self._shared = (
            self._world,
            tank(self.boat),
            gate_table(self.course),
            buoy_table(self.course),
            task.observed.places,
        )
        self._sail = sail_all_parallel if n >= PARALLEL_FROM else sail_all
        self.supply = Supply(task, self.boats, self.params) if counts_charge(task) else None
        self._own = None
        if task.own_rewards or task.observed.own:
            self._own = OwnStep(task, self.boats, self.params)

    def draw_from(self, generators: Generators) -> None:
        """Take the boats' following episodes from these n generators; what was drawn ahead is forgotten."""
        self._generators = generators
        self._waiting[:] = False

    def begin(self, chosen: NDArray[np.intp]) -> None:
        """Start the next episode of each of the boats `chosen` (m,)."""
        if not self._waiting[chosen].all():
            missing = np.flatnonzero(~self._waiting)
            draw_episodes(
                self._next,
                missing,
                [self._generators[i] for i in missing.tolist()],
                self.boat,
                self.course,
                self.level,
            )
            self._waiting[missing] = True
        self._now.take(self._next, chosen)
        self._waiting[chosen] = False

    def sail(
        self, asked: NDArray[np.float64], rewards: NDArray[np.float64], observations: NDArray[np.float32]
    ) -> int:
        """One step of all boats; see `sail_all`. UserError where a lever is not a number, and then that boat
        stays where it is."""
        if self._own is not None:
            self._own.note()
        if self.supply is not None:
            self.supply.feed()
        ended = self._sail(self.boats, self.params, asked, self._shared, rewards, observations)
        if ended and (unmoved := self.boats["outcome"] == LEVERS).any():
            self.boats["outcome"][unmoved] = RUNNING
            self.refuse_levers(asked)
        if self.supply is not None:
            self.supply.draw(observations)
        if self._own is not None:
            self._own.add(rewards, observations)
        return ended

    def refuse_levers(self, asked: NDArray[np.float64]) -> None:
        """UserError where a lever of `asked` (n, 2) of a boat that is to sail is not a number."""
        if math.isfinite(asked.sum()):  # far quicker, and finite only if all of them are
            return
        wrong = ~np.isfinite(asked).all(axis=1) & (self.boats["outcome"] == RUNNING)
        if wrong.any():
            i = int(np.argmax(wrong))
            raise UserError(
                f"boat {i}: the levers {asked[i].tolist()} are not numbers; look at what drives it"
            )

    def look(self, chosen: NDArray[np.intp], observations: NDArray[np.float32]) -> None:
        """Fill the rows `chosen` (m,) of observations (n, d) with what those boats sense now."""
        look_all(self.boats, self.params, chosen, self._shared, observations)
        if self.supply is not None:
            self.supply.look(chosen, observations)
        if self._own is not None:
            self._own.look(chosen, observations)

    def hold(self, thrusters: Sequence[str], azimuth: float, throttle: float) -> None:
        """Command thrusters that the levers do not drive, of all boats, from the next step on.

        azimuth [rad], or the rudder's angle; throttle [1], a share of the highest. An effect that kicks the
        same thruster still overrides it. ValueError for a thruster that the levers drive.
        """
        world = self._world
        for name in thrusters:
            if name in self.boat.joypad.thrusters:
                raise ValueError(f"thruster {name} obeys the levers")
            k = self.boat.thruster_names.index(name)
            world["lever_middle"][0, k] = azimuth
            world["lever_idle"][0, k] = throttle * self.boat.thrusters[k].throttle_max

    @property
    def pose(self) -> NDArray[np.float64]:
        """North, east [m] and heading [rad, not wrapped], (n, 3), a view."""
        return self.boats["state"][:, NORTH : NORTH + 3]

    @property
    def sensed_pose(self) -> NDArray[np.float64]:
        """As `pose`, but as the sensors report it, (n, 3), an array of its own."""
        sensed = np.empty((len(self.boats), 3))
        sense_all(self.boats, self.params, self.step, sensed)
        return sensed

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Surge, sway [m/s over ground] and yaw rate [rad/s], (n, 3), a view."""
        return self.boats["state"][:, SURGE : YAW_RATE + 1]

    @property
    def sensed_velocity(self) -> NDArray[np.float64]:
        """As `velocity`, but as the sensors report it, (n, 3), an array of its own."""
        return self.velocity + np.outer(self.params["gyro_bias"], [0.0, 0.0, 1.0])

    @property
    def applied(self) -> NDArray[np.float64]:
        """What the actuators did: azimuths [rad], then throttles [1], (n, 2K), a view."""
        return self.boats["state"][:, ACTUATORS:]

    @property
    def commands(self) -> NDArray[np.float64]:
        """What the levers asked of the actuators, (n, 2K) as `applied`, a view."""
        return self.boats["command"]

    @property
    def time(self) -> NDArray[np.float64]:
        """Time since the start of the episode [s], (n,), rounded to nanoseconds."""
        return np.round(self.boats["tick"] * self.step, 9)

    def outcomes(self, chosen: NDArray[np.intp]) -> list[str | None]:
        """How the episodes of the boats `chosen` ended; None for one that is still running."""
        codes = self.boats["outcome"][chosen].tolist()
        return [None if code == RUNNING else OUTCOMES[code] for code in codes]

    def drawn(self, i: int) -> dict[str, Any]:
        """What was drawn for the episode of boat i, enough to replay it: its effects, the seed of its gusts
        and, where the course has one, `water_depth` [m]."""
        uniforms = self._now.uniforms[i, START_DRAWS : START_DRAWS + self.level.draw_count]
        depth = float(self.boats["depth"][i]) if self.course.depth else None
        return {
            "effects": [*self.level.drawn(uniforms), *as_effects(self.boat, depth)],
            "gust_seed": int(self.boats["gust_seed"][i]),
            **({} if depth is None else {"water_depth": depth}),
        }

"""A boat outside the simulator: its course, judged by measured motion, and what levers or a pilot command."""

from collections.abc import Sequence
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.kernel import OUTCOMES, RUNNING, SENSED, boat_record, judge, pull_levers
from swamp_rl.envs.observation import NAMES, look
from swamp_rl.envs.task import Task, TaskArguments
from swamp_rl.envs.world import world_of

from swamp_rl.course.geometry import crosses_gate
from swamp_rl.course.tables import buoy_table, gate_table
from swamp_rl.errors import UserError
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.simulator.state import EAST, NORTH, YAW_RATE

Array = NDArray[np.float64]
UNMEASURED = ("wind_ahead", "wind_starboard", "current_ahead", "current_starboard", "charge")
"What may be observed in the simulator and is measured by no sensor of the boat."


class Measured:
    """A boat outside the simulator, the course that it sails, and what its levers command."""

    def __init__(self, **given: Unpack[TaskArguments]) -> None:
        """given: boat, course and step, as of an environment."""
        task = Task.read(**given)
        self.boat, self.course, self.step = task.boat, task.course, task.step
        self.stern = self.boat.beside_joypad
        "Thrusters that the levers do not drive."
        self._places = task.observed.places
        self._world, self._gates, self._buoys = (
            world_of(task),
            gate_table(self.course),
            buoy_table(self.course),
        )
        self._record = np.zeros(1, boat_record(len(self.boat.thrusters)))
        self._begun = False

    def begin(self) -> None:
        """Put the boat at the beginning of the course."""
        self._record[:] = np.zeros_like(self._record)
        self._begun = False

    @property
    def outcome(self) -> str | None:
        """How the course ended, a name of `OUTCOMES`; None while it has not."""
        code = int(self._record["outcome"][0])
        return None if code == RUNNING else OUTCOMES[code]

    @property
    def passed(self) -> int:
        """Gates so far."""
        return int(self._record["passed"][0])

    def move(self, time: float, senses: Array) -> None:
        """Take the motion at `time` [s] since the start; gates, buoys, bounds and time limit are judged.

        senses: (6,) north, east [m], heading [rad], surge, sway [m/s], yaw rate [rad/s].
        """
        record = self._record[0]
        before = record["state"][[NORTH, EAST]].copy()
        record["state"][NORTH : YAW_RATE + 1] = senses
        record["tick"] = round(time / self.step)
        if self._begun:
            self._judge(record, before)
        self._begun = True

    def commands(self, levers: Sequence[float] | Array, stern: Sequence[float] = (0.0, 0.0)) -> Array:
        """Commands (2K,), azimuths [rad] then throttles [1], of the levers: throttle in [0, 1], angle in
        [-1, 1]; stern: throttle [1] and azimuth in quarter turns of the thrusters that these do not drive."""
        found, K = np.empty(2 * len(self.boat.thrusters)), len(self.boat.thrusters)
        pull_levers(float(levers[0]), float(levers[1]), self._world[0], found)
        if stern[0] > 0.0:
            for k in map(self.boat.thruster_names.index, self.stern):
                found[k], found[K + k] = (
                    0.5 * np.pi * stern[1],
                    stern[0] * self.boat.thrusters[k].throttle_max,
                )
        return found

    def _judge(self, record: Any, before: Array) -> None:
        if record["outcome"] != RUNNING:
            return
        state = record["state"]
        if self.passed < len(self._gates):
            ends = (*before.tolist(), float(state[NORTH]), float(state[EAST]))
            record["passed"] += crosses_gate(*ends, *self._gates[self.passed].tolist())
        record["outcome"] = judge(
            self._record[0], before[0], before[1], len(self._gates), self._buoys, self._world[0], False
        )


class Aboard(Measured):
    """A pilot on that boat, and the way from motion to commands."""

    def __init__(self, pilot: Pilot, **given: Unpack[TaskArguments]) -> None:
        """given: boat, course and step, as of an environment. UserError for a pilot that observes what is not
        measured aboard."""
        given["observation"] = pilot.senses
        super().__init__(**given)
        self._pilot = pilot
        unknown = [name for name in pilot.senses if name in UNMEASURED or name not in NAMES]
        if unknown:
            raise UserError(
                f"the pilot observes {', '.join(unknown)}, which nothing aboard measures; choose another"
            )
        self.levers = np.zeros(2)
        "Throttle and angle asked last."
        self.begin()

    def begin(self) -> None:
        """Put the pilot at the beginning of the course."""
        super().begin()
        self.levers = np.zeros(2)
        self._pilot.reset(1)

    def decide(self, time: float, senses: Array) -> Array:
        """Commands (2K,), azimuths [rad] then throttles [1], for the motion at `time` [s] since the start.

        senses: as `move` takes them.
        """
        self.move(time, senses)
        record = self._record[0]
        everything = np.zeros(SENSED)
        look(tuple(senses[:3].tolist()), record["state"], self.passed, self._gates, everything)
        left = max((int(self._world["last_tick"][0]) - int(record["tick"])) * self.step, 0.0)
        everything[[NAMES.index(name) for name in ("last_throttle", "last_angle", "time_left")]] = (
            *self.levers,
            left,
        )
        asked = self._pilot.act(everything[None, self._places])[0]
        self.levers = np.clip(asked, (0.0, -1.0), (1.0, 1.0))
        return self.commands(self.levers)

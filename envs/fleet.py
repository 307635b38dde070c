"""n boats on one course: their episodes and their common step."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.episodes import START_DRAWS, Episodes, Generators, draw_episodes
from swamp_rl.envs.kernel import (
    LEVERS,
    OUTCOMES,
    RUNNING,
    look_all,
    sail_all,
    sail_all_parallel,
    sense_all,
    world_record,
)
from swamp_rl.envs.observation import senses

from swamp_rl.boat import Boat, Thruster, load_boat
from swamp_rl.boat.load import refuse_untested_depth
from swamp_rl.course import Course, buoy_table, gate_table, load_course
from swamp_rl.effects import load_disturbances
from swamp_rl.errors import UserError
from swamp_rl.simulator import tank
from swamp_rl.simulator.state import ACTUATORS, NORTH, SURGE, YAW_RATE
from swamp_rl.simulator.step import substeps_of

Disturbances = str | Path | Sequence[Mapping[str, Any]] | None

SHORTEST_STEP, LONGEST_STEP = 1e-3, 1.0  # s
PARALLEL_FROM = 256  # boats; with 128 two cores already gain, when no one else wants them


class Fleet:
    """The state of n boats and everything their step needs.

    Each episode takes from its boat's generator one block of uniforms, for the start and the disturbances,
    then one integer, the seed of its gusts; nothing else is random. Episodes are drawn ahead, for all the
    boats that have none waiting at once: drawing for one costs almost as much as drawing for a thousand.
    """

    def __init__(
        self,
        n: int,
        boat: str | Path | Boat,
        course: str | Path | Course,
        disturbances: Disturbances,
        observation: Sequence[str] | None,
        step: float,
    ) -> None:
        self.boat = boat if isinstance(boat, Boat) else load_boat(boat)
        self.course = course if isinstance(course, Course) else load_course(course)
        self.level = load_disturbances(disturbances, self.boat.thruster_names)
        drawn = (entry.effect for entry in self.level.entries)
        refuse_untested_depth(self.boat, drawn, f"disturbances {self.level.name}")
        self.step = checked_step(step)
        self.places = senses(observation)
        self._now = Episodes.empty(n, self.boat, self.level, self.step)
        self._next = Episodes.empty(n, self.boat, self.level, self.step)
        self._waiting = np.zeros(n, dtype=np.bool_)
        self._generators: Generators = ()
        self.boats, self.params = self._now.boats, self._now.params
        self._state = self.boats["state"]
        self._world = world_of(self.boat, self.course, self.step)
        self._shared = (
            self._world,
            tank(self.boat),
            gate_table(self.course),
            buoy_table(self.course),
            self.places,
        )
        self._sail = sail_all_parallel if n >= PARALLEL_FROM else sail_all

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
        ended = self._sail(self.boats, self.params, asked, self._shared, rewards, observations)
        if ended and (unmoved := self.boats["outcome"] == LEVERS).any():
            self.boats["outcome"][unmoved] = RUNNING
            self.refuse_levers(asked)
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
        return self._state[:, NORTH : NORTH + 3]

    @property
    def sensed_pose(self) -> NDArray[np.float64]:
        """As `pose`, but as the sensors report it, (n, 3), an array of its own."""
        sensed = np.empty((len(self.boats), 3))
        sense_all(self.boats, self.params, self.step, sensed)
        return sensed

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Surge, sway [m/s over ground] and yaw rate [rad/s], (n, 3), a view."""
        return self._state[:, SURGE : YAW_RATE + 1]

    @property
    def applied(self) -> NDArray[np.float64]:
        """What the actuators did: azimuths [rad], then throttles [1], (n, 2K), a view."""
        return self._state[:, ACTUATORS:]

    @property
    def commands(self) -> NDArray[np.float64]:
        """What the levers asked of the actuators, (n, 2K) as `applied`, a view."""
        return self.boats["command"]

    @property
    def time(self) -> NDArray[np.float64]:
        """Time since the start of the episode [s], (n,)."""
        return self.boats["tick"] * self.step

    def outcomes(self, chosen: NDArray[np.intp]) -> list[str | None]:
        """How the episodes of the boats `chosen` ended; None for one that is still running."""
        codes = self.boats["outcome"][chosen].tolist()
        return [None if code == RUNNING else OUTCOMES[code] for code in codes]

    def drawn(self, i: int) -> dict[str, Any]:
        """What was drawn for the episode of boat i, enough to replay it: its effects and the seed of its
        gusts."""
        return {
            "effects": self.level.drawn(self._now.uniforms[i, START_DRAWS:]),
            "gust_seed": int(self.boats["gust_seed"][i]),
        }


def world_of(boat: Boat, course: Course, step: float) -> NDArray[np.void]:
    """The `world_record` (1,) of a boat on a course; UserError where the boat does not fit through a gate."""
    reach = course.buoy_radius + 0.5 * boat.breadth
    for gate in course.gates:
        if gate.width <= 2.0 * reach:
            raise UserError(
                f"course {course.name}: gate {gate.name} is {gate.width:g} m wide, but boat {boat.name} "
                f"and the buoys need more than {2.0 * reach:g} m; choose a wider gate or a narrower boat"
            )
    world = np.zeros(1, world_record(len(boat.thrusters)))
    world["step"], world["substeps"] = step, substeps_of(step)
    world["last_tick"] = math.ceil(course.time_limit / step - 1e-9)
    world["reach"] = reach
    for edge in ("south", "north", "west", "east"):
        world[f"{edge}_edge"] = getattr(course.bounds, edge)
    low_azimuth, high_azimuth = boat.joypad.azimuth
    low_throttle, high_throttle = boat.joypad.throttle
    for k, thruster in enumerate(boat.thrusters):
        full = thruster.throttle_max  # 1, or the propeller's revolutions
        world["lever_low"][0, k], world["lever_high"][0, k] = thruster.throttle_min, full
        if thruster.name not in boat.joypad.thrusters:
            continue
        world["lever_idle"][0, k] = low_throttle * full
        world["lever_gain"][0, k] = (high_throttle - low_throttle) * full
        if thruster.kind == "fixed":
            ahead, turn = fixed_lever(thruster)
            world["lever_middle"][0, k] = thruster.azimuth_min
            world["lever_idle"][0, k] *= ahead
            world["lever_gain"][0, k] *= ahead
            world["lever_turn"][0, k] = turn * high_throttle
        else:
            # Aft of midship a jet has to push the other way for the bow to go where the lever goes.
            side = -1.0 if thruster.kind == "azimuth" and thruster.x < 0.0 else 1.0
            world["lever_middle"][0, k] = side * 0.5 * (low_azimuth + high_azimuth)
            world["lever_swing"][0, k] = side * 0.5 * (high_azimuth - low_azimuth)
    return world


def fixed_lever(thruster: Thruster) -> tuple[float, float]:
    """Signs (ahead, turn) with which a fixed thruster obeys the levers: differential thrust.

    Its throttle is that of the throttle's lever times `ahead`, 0 for one that pushes across, plus the angle's
    lever times `turn`, which turns the bow the way of the lever.
    """
    cos, sin = math.cos(thruster.azimuth_min), math.sin(thruster.azimuth_min)
    moment = thruster.x * sin - thruster.y * cos
    return float(np.sign(round(cos, 6))), float(np.sign(round(moment, 6)))


def checked_step(step: float) -> float:
    """`step` [s] if it is one that can be sailed; UserError otherwise."""
    number = isinstance(step, int | float) and not isinstance(step, bool)
    if not number or not SHORTEST_STEP <= step <= LONGEST_STEP:
        raise UserError(f"step: must be a time from {SHORTEST_STEP:g} to {LONGEST_STEP:g} s, not {step!r}")
    return float(step)

"""How an episode begins: where the boat starts and what disturbs it, drawn for many boats at once."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.depth import depth_draws, give_depth
from swamp_rl.envs.kernel import boat_record
from swamp_rl.envs.past import POSITIONS, begin_at_rest, past_fields
from swamp_rl.envs.supply import DRAWN, GAIN, supply_fields

from swamp_rl.boat import Boat
from swamp_rl.course import Course
from swamp_rl.effects import Level
from swamp_rl.simulator import initial_state, parameters

Generators = Sequence[np.random.Generator]
START_DRAWS = 3  # north, east, heading within the course's spread


@dataclass(frozen=True)
class Episodes:
    """One episode of each of n boats; frozen are the arrays, not what is in them."""

    boats: NDArray[Any]
    "(n,) of `boat_record`, as they stand at the start"
    params: NDArray[Any]
    "(n,) the simulator's parameter records, disturbances applied"
    uniforms: NDArray[np.float64]
    "(n, D) in [0, 1), what start, disturbances and depth were drawn from, in this order"

    @classmethod
    def empty(
        cls, n: int, boat: Boat, course: Course, level: Level, step: float, counts: bool = False
    ) -> Self:
        """Room for the episodes of n boats in steps of `step` [s]; counts: whether their batteries are."""
        effects = [*(entry.effect for entry in boat.effects), *(entry.effect for entry in level.entries)]
        past = past_fields(effects, len(boat.thrusters), step)
        past += supply_fields(boat) if counts else ()
        return cls(
            np.zeros(n, boat_record(len(boat.thrusters), past)),
            parameters(boat, n),
            np.zeros((n, START_DRAWS + level.draw_count + depth_draws(course))),
        )

    def take(self, other: "Episodes", chosen: NDArray[np.intp]) -> None:
        """Copy the episodes of the boats `chosen` (m,) from `other`."""
        in_bytes(self.boats)[chosen] = in_bytes(other.boats)[chosen]
        in_bytes(self.params)[chosen] = in_bytes(other.params)[chosen]
        self.uniforms[chosen] = other.uniforms[chosen]


def in_bytes(records: NDArray[Any]) -> NDArray[Any]:
    """A view of records (n,) as blocks of bytes: these NumPy copies whole, records field by field."""
    return records.view(f"V{records.dtype.itemsize}")


def draw_episodes(
    episodes: Episodes,
    chosen: NDArray[np.intp],
    generators: Generators,
    boat: Boat,
    course: Course,
    level: Level,
) -> None:
    """Draw new episodes of the boats `chosen` (m,) into `episodes`, each from its own of m generators."""
    uniforms = np.empty((len(chosen), episodes.uniforms.shape[1]))
    boats = np.zeros(len(chosen), episodes.boats.dtype)
    for row, generator in enumerate(generators):
        generator.random(out=uniforms[row])
        boats["gust_seed"][row] = generator.bit_generator.random_raw()
    params = parameters(boat, len(chosen))
    drawn, of_depth = np.split(uniforms[:, START_DRAWS:], [level.draw_count], axis=1)
    level.apply(params, drawn)
    give_depth(boats, params, boat, course, of_depth)
    pose = start_poses(course, uniforms) + level.start(drawn)
    boats["state"] = initial_state(params, pose)
    if POSITIONS in (boats.dtype.names or ()):
        begin_at_rest(boats, params)
    if DRAWN in (boats.dtype.names or ()):
        boats[GAIN] = params[GAIN]
    in_bytes(episodes.boats)[chosen] = in_bytes(boats)
    in_bytes(episodes.params)[chosen] = in_bytes(params)
    episodes.uniforms[chosen] = uniforms


def start_poses(course: Course, uniforms: NDArray[np.float64]) -> NDArray[np.float64]:
    """Starts (m, 3) north, east [m], heading [rad] in the course's spread, from uniforms (m, 3 or more)."""
    pose, spread = course.start.pose, course.start.spread
    centre = np.array([pose.north, pose.east, pose.heading])
    reach = np.array([spread.north, spread.east, spread.heading])
    return centre + reach * (2.0 * uniforms[:, :START_DRAWS] - 1.0)

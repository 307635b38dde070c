"""What a pilot may sense: named numbers, of which each pilot chooses its own."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from swamp_rl.envs.own_terms import OwnTerm, own_term, refuse_function

from swamp_rl.course.tables import GATE_COS, GATE_EAST, GATE_NORTH, GATE_SIN
from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.own_code import is_code
from swamp_rl.physics.compile import compiled
from swamp_rl.physics.motion import current_at
from swamp_rl.simulator.state import HEADING, SURGE, SWAY, TIME, YAW_RATE
from swamp_rl.simulator.step import wind_now


@dataclass(frozen=True)
class Sense:
    """A number that may be observed, with its unit and bounds; GATES and LIMIT are of the course."""

    name: str
    unit: str
    meaning: str
    low: float | str = -math.inf
    high: float | str = math.inf


GATES, LIMIT = "number of gates", "time limit"
SENSES = (
    Sense("north", "m", "place of midship, as the sensors report it"),
    Sense("east", "m", "as `north`"),
    Sense("cos_heading", "1", "of the heading, clockwise from north, as the sensors report it", -1.0, 1.0),
    Sense("sin_heading", "1", "as `cos_heading`", -1.0, 1.0),
    Sense("surge", "m/s", "velocity ahead, over ground"),
    Sense("sway", "m/s", "velocity to starboard, over ground"),
    Sense("yaw_rate", "rad/s", "of the heading"),
    Sense("gate_ahead", "m", "from midship to the middle of the next gate, in the boat's frame"),
    Sense("gate_starboard", "m", "as `gate_ahead`"),
    Sense("gate_cos", "1", "of the direction of passage, not the bearing, from the bow clockwise", -1.0, 1.0),
    Sense("gate_sin", "1", "as `gate_cos`", -1.0, 1.0),
    Sense("gates_passed", "1", "so far", 0.0, GATES),
    Sense(
        "wind_ahead",
        "m/s",
        "true velocity of the air over ground, ahead in the boat's frame, in the step before; "
        "a wind from astern is positive; at the start without gusts",
    ),
    Sense("wind_starboard", "m/s", "as `wind_ahead`, to starboard"),
    Sense("current_ahead", "m/s", "true velocity of the current over ground, ahead in the boat's frame"),
    Sense("current_starboard", "m/s", "as `current_ahead`, to starboard"),
    Sense("last_throttle", "1", "of the action of the step before; 0 at the start", 0.0, 1.0),
    Sense("last_angle", "1", "as `last_throttle`", -1.0, 1.0),
    Sense("time_left", "s", "until the time limit", 0.0, LIMIT),
    Sense(
        "charge",
        "1",
        "state of charge of the battery, of the pack that has least; of a boat with a `battery`",
        0.0,
        1.0,
    ),
)
CHARGE = "charge"
DEFAULT_COUNT = 12
OBSERVATION = tuple(sense.name for sense in SENSES[:DEFAULT_COUNT])
"""What is observed where nothing else is asked for."""
NAMES = tuple(sense.name for sense in SENSES)


@compiled
def look(pose: tuple[float, float, float], state: Any, passed: int, gates: Any, everything: Any) -> None:
    """Fill the first 12 of `everything`, OBSERVATION, for the boat of `state` (S,) sensed at `pose`.

    Where the next gate lies follows from the pose sensed. Once all gates of `gates` (G, 5) are passed, the
    last stays the next.
    """
    gate = gates[min(passed, gates.shape[0] - 1)]
    north, east, heading = pose
    cos, sin = math.cos(heading), math.sin(heading)
    to_north, to_east = gate[GATE_NORTH] - north, gate[GATE_EAST] - east
    everything[0] = north
    everything[1] = east
    everything[2] = cos
    everything[3] = sin
    everything[4] = state[SURGE]
    everything[5] = state[SWAY]
    everything[6] = state[YAW_RATE]
    everything[7] = to_north * cos + to_east * sin
    everything[8] = to_east * cos - to_north * sin
    everything[9] = gate[GATE_COS] * cos + gate[GATE_SIN] * sin
    everything[10] = gate[GATE_SIN] * cos - gate[GATE_COS] * sin
    everything[11] = passed


@compiled
def look_further(boat: Any, p: Any, world: Any, everything: Any) -> None:
    """Fill the rest of `everything` (20,), in the order of SENSES; `charge` is put in after the step, by
    `swamp_rl.envs.supply`."""
    cos, sin = math.cos(boat.state[HEADING]), math.sin(boat.state[HEADING])
    from_north, from_east = wind_now(boat.state, p)
    everything[12] = -(from_north * cos + from_east * sin)
    everything[13] = -(from_east * cos - from_north * sin)
    north, east = current_at(boat.state[TIME], p)
    everything[14] = north * cos + east * sin
    everything[15] = east * cos - north * sin
    everything[16], everything[17] = boat.lever[0], boat.lever[1]
    everything[18] = max((world.last_tick - boat.tick) * world.step, 0.0)
    everything[19] = 1.0


@dataclass(frozen=True)
class Observed:
    """What is observed, in order: SENSES and terms of one's own."""

    names: tuple[str, ...]
    places: NDArray[np.int64]
    "(d,) in SENSES, 0 where the term is one's own."
    own: tuple[tuple[int, OwnTerm], ...]
    "Terms of one's own by their place in the observation."

    @property
    def further(self) -> bool:
        """Whether more than OBSERVATION is needed."""
        return bool((self.places >= DEFAULT_COUNT).any())


def observed(names: Sequence[str] | None) -> Observed:
    """The named numbers, OBSERVATION for None; a name `module:function` is a term of one's own.

    UserError for an unknown or doubled name, and for a term that cannot be imported.
    """
    if names is None:
        names = OBSERVATION
    refuse_function("observation", names)
    if isinstance(names, str) or not isinstance(names, Collection) or len(names) == 0:
        raise UserError(
            f"observation: must be a list of names out of {', '.join(NAMES)}, module:function, not {names!r}"
        )
    for name in names:
        refuse_function("observation", name)
        if name not in NAMES and not is_code(name):
            raise UserError(
                f"observation: unknown name {name!r}{nearest(str(name), NAMES)}, module:function of your own"
            )
    if len(set(names)) != len(names):
        raise UserError(f"observation: a name is given twice in {list(names)}; give each once")
    places = [NAMES.index(name) if name in NAMES else 0 for name in names]
    own = [(i, own_term("observation", name)) for i, name in enumerate(names) if name not in NAMES]
    return Observed(tuple(names), np.array(places, dtype=np.int64), tuple(own))


def observation_space(asked: Observed, gate_count: int, time_limit: float) -> spaces.Box:
    """Box of the numbers `asked`, SI units and not scaled, float32, with the bounds of SENSES.

    time_limit [s]: of whole steps.
    """
    low, high = observation_bounds(asked, float(gate_count), time_limit)
    return spaces.Box(low, high, dtype=np.float32)


def observation_bounds(
    asked: Observed, gate_count: float = math.nan, time_limit: float = math.nan
) -> NDArray[np.float32]:
    """Least and greatest value of the numbers `asked` (2, d), NaN where it is of a course not given."""
    of_course = {GATES: gate_count, LIMIT: time_limit}
    terms = dict(asked.own)
    bounds = []
    for i, place in enumerate(asked.places.tolist()):
        term = terms.get(i, SENSES[place])
        bounds.append([of_course[end] if isinstance(end, str) else end for end in (term.low, term.high)])
    return np.array(bounds, dtype=np.float32).T

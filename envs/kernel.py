"""One step of the environment for one boat or a batch: levers, physics, course, reward, observation.

A boat's arithmetic is the same whatever the batch, so it gives the same bits alone and among thousands.
"""

import math
from functools import lru_cache
from typing import Any

import numba
import numpy as np
from swamp_rl.envs.observation import NAMES, SENSES, look, look_further
from swamp_rl.envs.past import arrived_command, keep_pose, sensed_pose
from swamp_rl.envs.reward import further_costs, reward

from swamp_rl.course.geometry import crosses_gate, outside, touches_buoy
from swamp_rl.course.progress import distance_to_go
from swamp_rl.course.tables import GATE_COS, GATE_EAST, GATE_HALF_WIDTH, GATE_NORTH, GATE_SIN
from swamp_rl.physics.compile import compiled, uncounted
from swamp_rl.physics.force_curve import JET
from swamp_rl.physics.motion import constants_of, current_at
from swamp_rl.simulator.ground import touches_ground
from swamp_rl.simulator.state import EAST, HEADING, NORTH, SURGE, SWAY, TIME, YAW_RATE, state_size
from swamp_rl.simulator.step import continue_boat, forget_outputs, wind_now

OUTCOMES = ("running", "success", "buoy", "aground", "out_of_bounds", "timeout", "levers", "diverged")
RUNNING, SUCCESS, BUOY, AGROUND, OUT_OF_BOUNDS, TIMEOUT, LEVERS, DIVERGED = range(len(OUTCOMES))
FAILED = (BUOY, AGROUND, OUT_OF_BOUNDS)
"""Outcomes that cost the reward's `failure`."""
CUT = (TIMEOUT, DIVERGED)
"""Outcomes that truncate an episode: no state of the task brought them about."""
LARGEST = 1e6  # m, rad, m/s or rad/s: what no boat's motion reaches before it has diverged
SENSED = len(SENSES)
SENSED_YAW_RATE = NAMES.index("yaw_rate")
CHUNK = (
    64  # boats that one task of the parallel loop takes, so that scratch memory is made once for all of them
)


@lru_cache(maxsize=64)
def boat_record(thrusters: int, past: tuple[tuple[Any, ...], ...] = ()) -> np.dtype[np.void]:
    """What the environment keeps of each boat; K thrusters. past: `swamp_rl.envs.past.past_fields`.

    These come first: numba takes a record that begins like another for one of its kind. Equal records are one
    object, as in `swamp_rl.simulator.parameters.record_of`.
    """
    return np.dtype(
        [
            *past,
            ("state", np.float64, (state_size(thrusters),)),  # as in swamp_rl.simulator.state
            ("command", np.float64, (2 * thrusters,)),  # azimuths [rad], then throttles [1]
            ("lever", np.float64, (2,)),  # throttle in [0, 1], angle in [-1, 1]
            ("passed", np.int64),  # gates
            ("tick", np.int64),  # steps since the start
            ("outcome", np.int64),  # place in OUTCOMES; it stays until the boat is started again
            ("fresh", np.bool_),  # started again just now: the next step is not sailed
            ("gust_seed", np.uint64),
            ("depth", np.float64),  # of the water [m], inf where it is deep
        ],
        align=True,
    )


@compiled
def diverged(state: Any) -> bool:
    """Whether the motion of `state` (S,) is not finite, or larger than any boat's."""
    size = abs(state[NORTH]) + abs(state[EAST]) + abs(state[HEADING])
    size += abs(state[SURGE]) + abs(state[SWAY]) + abs(state[YAW_RATE])
    return not size < LARGEST


@compiled
def judge(
    boat: Any, north0: float, east0: float, gate_count: int, buoys: Any, world: Any, aground: bool
) -> int:
    """Outcome after the way from point 0; a buoy touched counts before all else, then the ground, and success
    before the bounds."""
    north, east = boat.state[NORTH], boat.state[EAST]
    for b in range(buoys.shape[0]):
        if touches_buoy(north0, east0, north, east, buoys[b, 0], buoys[b, 1], world.reach):
            return BUOY
    if aground:
        return AGROUND
    if boat.passed == gate_count:
        return SUCCESS
    if outside(north, east, world.south_edge, world.north_edge, world.west_edge, world.east_edge):
        return OUT_OF_BOUNDS
    return TIMEOUT if boat.tick >= world.last_tick else RUNNING


@compiled
def pull_levers(throttle: float, angle: float, world: Any, command: Any) -> None:
    """Fill `command` (2K,), azimuths [rad] then throttles [1], with what the two levers ask for."""
    thrusters = world.lever_swing.shape[0]
    for k in range(thrusters):
        azimuth = world.lever_middle[k] + world.lever_swing[k] * angle
        command[k] = min(max(azimuth, world.lever_least[k]), world.lever_most[k])
        level = world.lever_idle[k] + world.lever_gain[k] * throttle + world.lever_turn[k] * angle
        command[thrusters + k] = min(max(level, world.lever_low[k]), world.lever_high[k])


@compiled
def sail(
    boat: Any, p: Any, asked: Any, world: Any, tank: Any, gates: Any, buoys: Any, jets: Any, room: Any
) -> float:
    """Sail one boat for a step with the levers `asked` (2,), note its outcome and return the reward.

    The course judges where the boat is, whatever its sensors say. A boat whose motion diverges stays where it
    was before the step, and ends. jets (3, K, JET), room (2K,): scratch.
    """
    if not (math.isfinite(asked[0]) and math.isfinite(asked[1])):
        boat.outcome = LEVERS
        return 0.0
    throttle, angle = min(max(asked[0], 0.0), 1.0), min(max(asked[1], -1.0), 1.0)
    throttle_rate = (throttle - boat.lever[0]) / world.step
    angle_rate = (angle - boat.lever[1]) / world.step
    boat.lever[0], boat.lever[1] = throttle, angle
    pull_levers(throttle, angle, world, boat.command)
    north0, east0, heading0 = boat.state[NORTH], boat.state[EAST], boat.state[HEADING]
    u0, v0, r0 = boat.state[SURGE], boat.state[SWAY], boat.state[YAW_RATE]
    to_go = distance_to_go(north0, east0, boat.passed, gates)
    arrived = arrived_command(boat, p, world.step, room)
    state, given, curves = uncounted(boat.state), uncounted(arrived), uncounted(tank)
    forget_outputs(jets)  # not `step_boat`: numba would compile all of a step once more
    constants = constants_of(p, curves)
    continue_boat(state, p, curves, given, boat.gust_seed, world.step, world.substeps, jets, constants)
    boat.tick += 1
    if diverged(boat.state):
        boat.state[NORTH], boat.state[EAST], boat.state[HEADING] = north0, east0, heading0
        boat.state[SURGE], boat.state[SWAY], boat.state[YAW_RATE] = u0, v0, r0
        keep_pose(boat, p)
        boat.outcome = DIVERGED
        return 0.0
    keep_pose(boat, p)
    north, east = boat.state[NORTH], boat.state[EAST]
    gate = gates[boat.passed]
    passes = crosses_gate(
        north0,
        east0,
        north,
        east,
        gate[GATE_NORTH],
        gate[GATE_EAST],
        gate[GATE_COS],
        gate[GATE_SIN],
        gate[GATE_HALF_WIDTH],
    )
    boat.passed += passes
    aground = touches_ground(boat.state, p, boat.depth)
    boat.outcome = judge(boat, north0, east0, gates.shape[0], buoys, world, aground)
    way_made = to_go - distance_to_go(north, east, boat.passed, gates)
    succeeded, failed = boat.outcome == SUCCESS, boat.outcome in FAILED
    paid = reward(world, way_made, int(passes), succeeded, failed, throttle, throttle_rate, angle_rate)
    return paid - further_costs(world, boat.state, gate) if world.costs_further else paid


@compiled
def sense(boat: Any, p: Any, world: Any, gates: Any, everything: Any) -> None:
    """Fill `everything` (SENSED,) with what the boat senses now."""
    look(sensed_pose(boat, p, world.step), boat.state, boat.passed, gates, everything)
    everything[SENSED_YAW_RATE] += p.gyro_bias
    if world.looks_further:
        look_further(boat, p, world, everything)


@compiled(entry=True)
def sail_range(
    first: int,
    last: int,
    boats: Any,
    params: Any,
    asked: Any,
    shared: Any,
    rewards: Any,
    observations: Any,
) -> int:
    """`sail_all` for the boats from first to the one before last."""
    world, tank, gates, buoys, places = shared
    thrusters = boats[first].command.shape[0] // 2
    jets, room = np.empty((3, thrusters, JET)), np.empty(2 * thrusters)
    everything = np.empty(SENSED)
    ended = 0
    for i in range(first, last):
        boat, p = boats[i], params[i]
        rewards[i] = 0.0
        if boat.outcome == RUNNING and not boat.fresh:
            rewards[i] = sail(boat, p, asked[i], world[0], tank, gates, buoys, jets, room)
        boat.fresh = False
        ended += boat.outcome != RUNNING
        sense(boat, p, world[0], gates, everything)
        for j in range(places.shape[0]):
            observations[i, j] = everything[places[j]]
    return ended


def sail_all(boats: Any, params: Any, asked: Any, shared: Any, rewards: Any, observations: Any) -> int:
    """Sail n boats for a step in place, those that are running and not fresh; return how many have ended.

    boats (n,) of `boat_record`; params (n,): the simulator's; asked (n, 2): throttle, angle; shared: world
    (1,) of `world_record`, the simulator's tank, gates (G, 5), buoys (2G, 2) of the course, and places (d,)
    of what is observed. Fills rewards (n,) and observations (n, d).
    """
    return sail_range(0, boats.shape[0], boats, params, asked, shared, rewards, observations)


@compiled(parallel=True)
def sail_all_parallel(
    boats: Any, params: Any, asked: Any, shared: Any, rewards: Any, observations: Any
) -> int:
    """As `sail_all`, spread over the processor's cores."""
    n = boats.shape[0]
    ended = 0
    for chunk in numba.prange((n + CHUNK - 1) // CHUNK):
        first, last = chunk * CHUNK, min((chunk + 1) * CHUNK, n)
        ended += sail_range(first, last, boats, params, asked, shared, rewards, observations)
    return ended


@compiled(entry=True)
def look_all(boats: Any, params: Any, chosen: Any, shared: Any, observations: Any) -> None:
    """Fill the rows `chosen` (m,) of observations (n, d) with what those boats sense now."""
    world, _, gates, _, places = shared
    everything = np.empty(SENSED)
    for i in chosen:
        sense(boats[i], params[i], world[0], gates, everything)
        for j in range(places.shape[0]):
            observations[i, j] = everything[places[j]]


@compiled(entry=True)
def sense_all(boats: Any, params: Any, step: float, poses: Any) -> None:
    """Fill poses (n, 3) with what the sensors of n boats report now."""
    for i in range(boats.shape[0]):
        poses[i, 0], poses[i, 1], poses[i, 2] = sensed_pose(boats[i], params[i], step)


@compiled(entry=True)
def survey(boats: Any, params: Any, gates: Any, to_go: Any, wind: Any, current: Any) -> None:
    """Fill the distance to go (n,) [m], and the true velocity of the air and of the current (n, 2), north and
    east [m/s], of n boats."""
    for i in range(boats.shape[0]):
        state = boats[i].state
        to_go[i] = distance_to_go(state[NORTH], state[EAST], boats[i].passed, gates)
        from_north, from_east = wind_now(state, params[i])
        wind[i, 0], wind[i, 1] = -from_north, -from_east
        current[i, 0], current[i, 1] = current_at(state[TIME], params[i])

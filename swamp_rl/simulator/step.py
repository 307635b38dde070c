"""One control step of one boat or of a batch: the same compiled function, hence the same bits."""

import math
from typing import Any

import numba
import numpy as np

from swamp_rl.physics.compile import compiled, still_used, uncounted
from swamp_rl.physics.force_curve import ANGLE_OF_THRUSTER, JET, LEVEL_OF_THRUSTER
from swamp_rl.physics.motion import constants_of, runge_kutta_step, water_velocity
from swamp_rl.physics.noise import normal_pair
from swamp_rl.physics.propulsion import actuator_output, throttle_limits, worn
from swamp_rl.physics.thrusters import (
    alive,
    azimuth_after,
    level_after,
    level_at_start,
    put_output,
    supply,
)
from swamp_rl.simulator.delay import delayed_command
from swamp_rl.simulator.state import (
    ACTUATORS,
    EAST,
    GUST_DIRECTION,
    GUST_SPEED,
    HEADING,
    NORTH,
    SURGE,
    SWAY,
    TIME,
    YAW_RATE,
)

CHUNK = (
    64  # boats that one task of the parallel loop steps, so that scratch memory is made once for all of them
)


SUBSTEP = 0.1  # s, the longest Runge-Kutta step: under a centimetre off after half a minute of hard steering


@compiled
def update_gusts(state: Any, seed: Any, dt: float, p: Any) -> None:
    """Ornstein-Uhlenbeck gusts on the wind's speed and direction, exact over a step, stationary at once."""
    if p.gust_speed_std == 0.0 and p.gust_direction_std == 0.0:
        return
    step_number = round(state[TIME] / dt)
    first, second = normal_pair(seed, step_number)
    keep = math.exp(-dt / p.gust_time_constant) if step_number > 0 else 0.0
    fresh = math.sqrt(1.0 - keep * keep)
    state[GUST_SPEED] = keep * state[GUST_SPEED] + fresh * p.gust_speed_std * first
    state[GUST_DIRECTION] = keep * state[GUST_DIRECTION] + fresh * p.gust_direction_std * second


@compiled
def wind_now(state: Any, p: Any) -> tuple[float, float]:
    """North and east component [m/s] of where the wind comes from, gusts included; zero without wind."""
    speed = max(p.wind_speed + state[GUST_SPEED], 0.0)
    if speed == 0.0:
        return 0.0, 0.0
    coming_from = p.wind_from + state[GUST_DIRECTION]
    return speed * math.cos(coming_from), speed * math.sin(coming_from)


@compiled
def take_weather(p: Any, row: Any) -> None:
    """Put a row (3,) of measured weather into the record p: wind speed [m/s], direction it comes from [rad],
    depth in draughts [1]; what is NaN stays as it is."""
    if math.isfinite(row[0]):
        p.wind_speed = row[0]
        p.wind_from = row[1]
    if math.isfinite(row[2]):
        p.depth_over_draught = row[2]


@compiled
def commanded(k: int, time: float, command: Any, p: Any) -> tuple[float, float]:
    """Azimuth or rudder [rad] and throttle [1] or revolutions [rps] asked of thruster k, within its limits.

    A kick overrides the pilot.
    """
    thrusters = command.shape[0] // 2
    channel = int(p.channel[k])
    azimuth = p.azimuth_sign[k] * command[channel]
    throttle = p.throttle_sign[k] * command[thrusters + channel]
    low, high = throttle_limits(k, p)
    if p.kick_time[k] <= time < p.kick_time[k] + p.kick_duration[k]:
        azimuth, throttle = p.kick_azimuth[k], p.kick_throttle[k] * high
    azimuth = min(max(azimuth, p.azimuth_min[k]), p.azimuth_max[k])
    return azimuth, min(max(throttle, low), high)


@compiled
def move_actuators(state: Any, command: Any, h: float, jets: Any, p: Any) -> None:
    """Let the actuators follow the command for h [s]; jets (3, K, JET) takes their outputs, angles [rad]
    and levels at 0, h/2 and h.

    Where an actuator is as it was a moment before, its output in jets stands: call `forget_outputs` before
    the first step of a boat.
    """
    thrusters = jets.shape[1]
    for k in range(thrusters):
        azimuth_command, throttle_command = commanded(k, state[TIME], command, p)
        azimuth, throttle = state[ACTUATORS + k], state[ACTUATORS + thrusters + k]
        angle, level = azimuth, throttle
        works = alive(k, state[TIME], h, p)
        wears = works < 1.0 or p.thrust_sag != 0.0
        for i in range(3):
            if i == 0 or angle != azimuth_command or level != throttle_command or wears:
                time = 0.5 * h * i
                angle = azimuth_after(
                    azimuth, azimuth_command, p.azimuth_time_constant[k], p.azimuth_rate[k], time
                )
                if i == 0:
                    level = level_at_start(throttle, throttle_command, h, k, p)
                else:
                    level = level_after(throttle, throttle_command, time, k, p)
            before = jets[(i + 2) % 3, k]
            if wears or angle != before[ANGLE_OF_THRUSTER] or level != before[LEVEL_OF_THRUSTER]:
                first, second = actuator_output(angle, level, k, p)
                if wears:
                    first, second = worn(first, second, works * supply(state[TIME] + 0.5 * h * i, p), k, p)
                put_output(first, second, jets, i, k, p)
                jets[i, k, ANGLE_OF_THRUSTER], jets[i, k, LEVEL_OF_THRUSTER] = angle, level
            else:
                for c in range(JET):
                    jets[i, k, c] = before[c]
        state[ACTUATORS + k], state[ACTUATORS + thrusters + k] = angle, level


@compiled
def forget_outputs(jets: Any) -> None:
    """Let `move_actuators` take nothing in jets (3, K, JET), scratch or another boat's, for an output."""
    for k in range(jets.shape[1]):
        jets[2, k, ANGLE_OF_THRUSTER] = math.nan


@compiled
def step_boat(
    state: Any, p: Any, tank: Any, command: Any, seed: Any, dt: float, substeps: int, jets: Any
) -> None:
    """Advance one boat by dt [s] in place, as `continue_boat`, whatever jets (3, K, JET) holds."""
    forget_outputs(jets)
    continue_boat(state, p, tank, command, seed, dt, substeps, jets, constants_of(p, tank))


@compiled
def continue_boat(
    state: Any,
    p: Any,
    tank: Any,
    command: Any,
    seed: Any,
    dt: float,
    substeps: int,
    jets: Any,
    constants: Any,
) -> None:
    """Advance one boat by dt [s] in place.

    state: (S,), see `swamp_rl.simulator.state`; p: its parameter record; tank: `tank_table`;
    command: (2K,) azimuths [rad] then throttles [1], held over the step: what has arrived, so where commands
    act late it comes from `delayed_command`; seed: of its gusts;
    jets: (3, K, JET), as the last step of this boat left it, or after `forget_outputs`;
    constants: `constants_of(p, tank)`.
    """
    h = dt / substeps
    update_gusts(state, seed, dt, p)
    held = wind_now(state, p), constants
    motion = through_water(state, state[TIME], p)
    for _ in range(substeps):
        move_actuators(state, command, h, jets, p)
        motion = runge_kutta_step(motion, state[TIME], h, jets, held, p, tank)
        state[TIME] += h
    put_over_ground(motion, state[TIME], p, state)


@compiled
def continue_alike(
    state: Any,
    rigid: Any,
    p: Any,
    tank: Any,
    command: Any,
    seed: Any,
    dt: float,
    substeps: int,
    jets: Any,
    constants: Any,
) -> None:
    """As `continue_boat`, for boats that differ in their rigid motion (V, 6) alone, the first six numbers of
    a state: time, gusts and actuators of all of them stand in `state` (S,), and are computed once.
    """
    h = dt / substeps
    update_gusts(state, seed, dt, p)
    held = wind_now(state, p), constants
    for v in range(rigid.shape[0]):
        put_motion(through_water(rigid[v], state[TIME], p), rigid[v])
    for _ in range(substeps):
        move_actuators(state, command, h, jets, p)
        for v in range(rigid.shape[0]):
            motion = runge_kutta_step(rigid_motion(rigid[v]), state[TIME], h, jets, held, p, tank)
            put_motion(motion, rigid[v])
        state[TIME] += h
    for v in range(rigid.shape[0]):
        put_over_ground(rigid_motion(rigid[v]), state[TIME], p, rigid[v])


@compiled
def rigid_motion(state: Any) -> Any:
    """The first six numbers of a state (S,)."""
    return state[NORTH], state[EAST], state[HEADING], state[SURGE], state[SWAY], state[YAW_RATE]


@compiled
def put_motion(motion: Any, state: Any) -> None:
    """Six numbers into a state (S,)."""
    state[NORTH], state[EAST], state[HEADING] = motion[0], motion[1], motion[2]
    state[SURGE], state[SWAY], state[YAW_RATE] = motion[3], motion[4], motion[5]


@compiled
def through_water(state: Any, time: float, p: Any) -> Any:
    """The rigid motion of a state (S,) at `time` [s], its surge and sway relative to the water."""
    north, east = water_velocity(time, p)
    cos, sin = math.cos(state[HEADING]), math.sin(state[HEADING])
    surge, sway = state[SURGE] - (north * cos + east * sin), state[SWAY] - (east * cos - north * sin)
    return state[NORTH], state[EAST], state[HEADING], surge, sway, state[YAW_RATE]


@compiled
def put_over_ground(motion: Any, time: float, p: Any, state: Any) -> None:
    """A motion relative to the water at `time` [s] into a state (S,), relative to the ground."""
    put_motion(motion, state)
    north, east = water_velocity(time, p)
    if north != 0.0 or east != 0.0:
        cos, sin = math.cos(motion[2]), math.sin(motion[2])
        state[SURGE] = motion[3] + north * cos + east * sin
        state[SWAY] = motion[4] + east * cos - north * sin


@compiled(entry=True)
def step(state: Any, params: Any, tank: Any, commands: Any, seeds: Any, dt: float, substeps: int) -> None:
    """Advance n boats by dt [s] in place; state (n, S), params (n,), commands (n, 2K), seeds uint64 (n,)."""
    room = np.empty((3, commands.shape[1] // 2, JET))
    jets, boats, curves, given = uncounted(room), uncounted(state), uncounted(tank), uncounted(commands)
    for i in range(state.shape[0]):
        forget_outputs(jets)
        constants = constants_of(params[i], curves)
        continue_boat(boats[i], params[i], curves, given[i], seeds[i], dt, substeps, jets, constants)
    still_used(room)


@compiled(parallel=True)
def step_parallel(
    state: Any, params: Any, tank: Any, commands: Any, seeds: Any, dt: float, substeps: int
) -> None:
    """As `step`, spread over the processor's cores: faster for a thousand boats or more."""
    boats = state.shape[0]
    for chunk in numba.prange((boats + CHUNK - 1) // CHUNK):
        jets = np.empty((3, commands.shape[1] // 2, JET))
        for i in range(chunk * CHUNK, min((chunk + 1) * CHUNK, boats)):
            step_boat(state[i], params[i], uncounted(tank), commands[i], seeds[i], dt, substeps, jets)


def simulate(params: Any, tank: Any, start: Any, commands: Any, seeds: Any, dt: float, substeps: int) -> Any:
    """Tracks of n boats under given commands, which act late where `command_delay` says so.

    start: (n, S) states, not changed; commands: (n, T, 2K), each row held for dt [s].
    Returns (n, T + 1, S), the start first.
    """
    return simulate_in_weather(params, tank, start, commands, np.empty((0, 0, 3)), seeds, dt, substeps)


def simulate_in_weather(
    params: Any, tank: Any, start: Any, commands: Any, weather: Any, seeds: Any, dt: float, substeps: int
) -> Any:
    """As `simulate`, with measured weather (n or 0, T, 3): rows of `take_weather`, each held for dt [s]."""
    # contiguous: numba would compile every other order of the same numbers anew, which takes seconds
    start, commands, weather, seeds = map(np.ascontiguousarray, (start, commands, weather, seeds))
    return _simulated(params, tank, start, commands, weather, seeds, dt, substeps)


@compiled(entry=True)
def _simulated(
    params: Any, tank: Any, start: Any, commands: Any, weather: Any, seeds: Any, dt: float, substeps: int
) -> Any:
    boats, steps = commands.shape[0], commands.shape[1]
    track = np.empty((boats, steps + 1, start.shape[1]))
    room, row = np.empty((3, commands.shape[2] // 2, JET)), np.empty(commands.shape[2])
    jets, arrived, curves, given = uncounted(room), uncounted(row), uncounted(tank), uncounted(commands)
    own, states, measured = params.copy(), uncounted(track), uncounted(weather)
    for i in range(boats):
        forget_outputs(jets)
        for c in range(start.shape[1]):  # no slice: numba would compile its error's text as well
            states[i, 0, c] = start[i, c]
        constants = constants_of(own[i], curves)
        for j in range(steps):
            for c in range(start.shape[1]):
                states[i, j + 1, c] = states[i, j, c]
            if weather.shape[0] > 0:
                take_weather(own[i], measured[i, j])
                constants = constants_of(own[i], curves)
            delayed_command(given[i], j, params[i].command_delay / dt, arrived)
            continue_boat(states[i, j + 1], own[i], curves, arrived, seeds[i], dt, substeps, jets, constants)
    still_used(room)
    still_used(row)
    return track

"""Rows of a driven run, and the way back: the same run sailed again from what was stored, bit for bit."""

import math
from collections.abc import Sequence

import numpy as np

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.applicable import refuse_inapplicable
from swamp_rl.effects import apply_effects, parse_effects
from swamp_rl.runs import Run
from swamp_rl.simulator import parameters, tank
from swamp_rl.simulator.delay import delayed_command
from swamp_rl.simulator.replay import fixed_thrusters
from swamp_rl.simulator.state import ACTUATORS, HEADING, NORTH, TIME, YAW_RATE, state_size
from swamp_rl.simulator.step import step as sail
from swamp_rl.simulator.substeps import substeps_of
from swamp_rl.teleop.craft import Array, Instant, Weather

MOTION = ("north", "east", "heading", "surge", "sway", "yaw_rate")
LEVERS = ("joy_thrust", "joy_angle")
WIND = ("wind_speed", "wind_from")
WITH_PILOT = ("driver", "pilot_thrust", "pilot_angle")
"Where a pilot was aboard: who drove, 0 the person and 1 the pilot, and what the pilot wanted."


def columns_of(boat: Boat, simulated: bool, with_pilot: bool) -> list[str]:
    """The columns of a run in their order; of a simulated one actuators and wind too."""
    commands = [name for name in _channels(boat) if name is not None]
    known = (*(f"applied_{name}" for name in commands), *WIND) if simulated else ()
    return ["time", *MOTION, *LEVERS, *commands, *known, *(WITH_PILOT if with_pilot else ())]


def row_of(
    boat: Boat, instant: Instant, weather: Weather | None, pilot: tuple[float, float, float] | None
) -> list[float]:
    """One row in the order of `columns_of`; weather: None for a boat that is not simulated."""
    state = instant.state
    motion = state[NORTH : YAW_RATE + 1].copy()
    motion[2] = wrapped(motion[2])
    turning = [k for k, name in enumerate(_channels(boat)) if name is not None]
    known: list[float] = []
    if weather is not None:
        wind = weather[:2]
        known = [*state[ACTUATORS:][turning].tolist(), math.hypot(*wind), math.atan2(wind[1], wind[0])]
    commands = instant.commands[turning].tolist()
    return [float(state[TIME]), *motion.tolist(), *instant.levers, *commands, *known, *(pilot or ())]


def initial_state(boat: Boat, state: Array) -> dict[str, float]:
    """The whole state (S,) by name: full turns, gusts and all actuators are not in the first row."""
    return dict(zip(_state_names(boat), state.tolist(), strict=True))


def disturbed(run: Run, boat: Boat) -> Array:
    """(1,) the parameter record of the boat, disturbed as the run was."""
    params = parameters(boat)
    effects = parse_effects(run.meta.disturbances or [], run.name, boat.thruster_names)
    apply_effects(params, effects, boat.thruster_names)
    return params


def sailed_again(run: Run, boat: Boat) -> Array:
    """Track (T, S) from the run's initial state under its commands, disturbed as it was.

    Exactly what the recorder sailed: the same compiled step from the same numbers.
    """
    effects = parse_effects(run.meta.disturbances or [], run.name, boat.thruster_names)
    refuse_inapplicable(boat, (entry.effect for entry in effects), f"run {run.name}: disturbances")
    params = disturbed(run, boat)
    start = run.meta.initial_state or {}
    state = np.array([[start[name] for name in _state_names(boat)]])
    seed = np.array([run.meta.model_dump().get("gust_seed", 0)], dtype=np.uint64)
    commands = run.commands(boat.thruster_names, fixed_thrusters(boat))
    step = 1.0 / round(1.0 / float(np.median(np.diff(run.time))), 6)
    curves, substeps = tank(boat), substeps_of(step, boat)
    track = np.empty((len(commands), state_size(len(boat.thrusters))))
    for row, command in enumerate(_arrived(run, boat, commands, float(params["command_delay"][0]) / step)):
        track[row] = state[0]
        sail(state, params, curves, command[None], seed, step, substeps)
    return track


def _arrived(run: Run, boat: Boat, commands: Array, delay: float) -> Array:
    """(T, 2K) what reaches the thrusters in each step, of commands (T, 2K) that act `delay` steps late."""
    # What recorders that kept a run only from the first gate on had asked before.
    stored = run.meta.model_dump().get("earlier_commands", {})
    earlier = np.array([stored[name] for name in _channel_names(boat)]).T if stored else commands[:0]
    asked, arrived = np.vstack([earlier, commands]), np.empty_like(commands)
    for row in range(len(commands)):
        delayed_command(asked, len(earlier) + row, delay, arrived[row])
    return arrived


def largest_difference(run: Run, boat: Boat | str) -> float:
    """How far the run sailed again is from the recorded one, over motion and actuators; nought if exact."""
    boat = load_boat(boat) if isinstance(boat, str) else boat
    track = sailed_again(run, boat)
    track[:, HEADING] = wrapped(track[:, HEADING])
    names = [*MOTION, *(f"applied_{name}" for name in _channels(boat) if name is not None)]
    places = [
        *range(NORTH, YAW_RATE + 1),
        *(ACTUATORS + k for k, name in enumerate(_channels(boat)) if name is not None),
    ]
    return float(np.abs(track[:, places] - run.stacked(names)).max())


def _channels(boat: Boat) -> Sequence[str | None]:
    """Column of each of the 2K commands: angles, None where one does not turn, then throttles."""
    angles, levels = zip(*(thruster.command_columns for thruster in boat.thrusters), strict=True)
    return [*angles, *levels]


def _channel_names(boat: Boat) -> list[str]:
    return [name or f"azimuth_{k}" for k, name in enumerate(_channels(boat))]


def _state_names(boat: Boat) -> list[str]:
    applied = [f"applied_{name}" for name in _channel_names(boat)]
    return [*MOTION, "time", "gust_speed", "gust_direction", *applied]

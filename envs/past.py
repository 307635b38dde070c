"""What a boat must remember where its commands act late or its sensors report something else than its pose.

Only the records of such boats have the fields, so which functions serve a boat is decided when they are
compiled: a boat without such effects pays nothing for them.
"""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from swamp_rl.effects import Effect
from swamp_rl.effects.limits import LONGEST_DELAY
from swamp_rl.physics.compile import by_field, compiled
from swamp_rl.simulator.delay import delayed_command
from swamp_rl.simulator.sensors.live import keep_position, reported_pose
from swamp_rl.simulator.state import EAST, HEADING, NORTH

COMMANDS, POSITIONS = "past_commands", "past_positions"


def past_fields(effects: Iterable[Effect], thrusters: int, step: float) -> tuple[tuple[Any, ...], ...]:
    """Fields of a boat's record that those effects call for; K thrusters, step [s]. Rings, by tick."""
    rows = math.ceil(LONGEST_DELAY / step) + 2
    effects = list(effects)
    fields: list[tuple[Any, ...]] = []
    if any(effect.name == "command_delay" for effect in effects):
        fields.append((COMMANDS, np.float64, (rows, 2 * thrusters)))
    if any(effect.acts_on == "sensor" for effect in effects):
        fields.append((POSITIONS, np.float64, (rows, 2)))  # of the antenna: north, east [m]
    return tuple(fields)


@compiled
def command_of_before(boat: Any, p: Any, step: float, room: Any) -> Any:
    """As `arrived_command`, where commands may act late; fills and returns `room` (2K,)."""
    row = boat.tick % boat.past_commands.shape[0]
    for c in range(boat.command.shape[0]):
        boat.past_commands[row, c] = boat.command[c]
    delayed_command(boat.past_commands, boat.tick, p.command_delay / step, room)
    return room


@compiled
def command_of_now(boat: Any, p: Any, step: float, room: Any) -> Any:
    """As `arrived_command`, where commands act at once."""
    return boat.command


@compiled
def keep_measured(boat: Any, p: Any) -> None:
    """As `keep_pose`, where the sensors report something else than the pose."""
    keep_position(boat.past_positions, boat.tick, boat.state, p)


@compiled
def keep_nothing(boat: Any, p: Any) -> None:
    """As `keep_pose`, where the sensors report the pose."""


@compiled
def measured_pose(boat: Any, p: Any, step: float) -> tuple[float, float, float]:
    """As `sensed_pose`, where the sensors report something else than the pose."""
    return reported_pose(boat.past_positions, boat.tick, boat.state, step, p)


@compiled
def true_pose(boat: Any, p: Any, step: float) -> tuple[float, float, float]:
    """As `sensed_pose`, where the sensors report the pose."""
    return boat.state[NORTH], boat.state[EAST], boat.state[HEADING]


# The command (2K,) that reaches the thrusters in the step that begins now.
arrived_command = by_field(COMMANDS, command_of_before, command_of_now)

# Remember the pose for what the sensors will say of it later; once a step, after it.
keep_pose = by_field(POSITIONS, keep_measured, keep_nothing)

# North, east [m] and heading [rad, not wrapped] as the sensors report them now.
sensed_pose = by_field(POSITIONS, measured_pose, true_pose)


@compiled
def begin_at_rest(boats: Any, params: Any) -> None:
    """Let n boats of `past_positions` have lain where they are since long ago."""
    for i in range(boats.shape[0]):
        for row in range(boats[i].past_positions.shape[0]):
            keep_position(boats[i].past_positions, row, boats[i].state, params[i])

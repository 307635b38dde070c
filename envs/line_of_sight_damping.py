"""The damping of a line-of-sight pilot that suits a boat, from how far its bow turns on."""

from typing import Any

import numpy as np
from swamp_rl.envs.aboard import Measured

from swamp_rl.boat import Boat
from swamp_rl.constants import SWAMP_LENGTH
from swamp_rl.manoeuvres.under_way import under_way
from swamp_rl.pilots.line_of_sight import DAMPING, LineOfSightPilot, LineOfSightSettings
from swamp_rl.simulator import parameters, simulate, tank
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.state import HEADING, YAW_RATE
from swamp_rl.simulator.substeps import substeps_of

OVERSHOOT = 0.1  # rad that the bow may turn on beyond the point aimed at
TURNING, STOPPING = 8.0, 20.0  # lengths at top speed L/U: of the turn, and in which it has to end


def suited(pilot: Any, boat: Boat, step: float) -> Any:
    """The pilot, with the boat's damping if it is a line-of-sight pilot without one."""
    if not isinstance(pilot, LineOfSightPilot) or pilot.options.damping is not None:
        return pilot
    return LineOfSightPilot(with_damping(pilot.options, boat, step))


def with_damping(settings: LineOfSightSettings, boat: Boat, step: float) -> LineOfSightSettings:
    """The settings, with the boat's damping D [s/rad] where they leave it out; step between decisions [s].

    The pilot reverses the lever at the bearing (D / gain) r. The bow then turns on by ψ, so that

        D = max(DAMPING √(L / L_SWAMP), gain (ψ - OVERSHOOT) / r).
    """
    if settings.damping is not None:
        return settings
    least = DAMPING * (boat.length / SWAMP_LENGTH) ** 0.5
    rate, angle = turned_on(boat, step)
    needed = settings.gain * (angle - OVERSHOOT) / rate if rate > 0.0 else 0.0
    return settings.model_copy(update={"damping": max(least, needed)})


def turned_on(boat: Boat, step: float) -> tuple[float, float]:
    """Yaw rate r [rad/s] of a turn at full throttle and full lever, and the angle ψ [rad] by which the bow
    turns on once the lever is reversed. The turn begins at top speed; step [s] between two commands."""
    levers = Measured(boat=boat, step=step).commands
    to_starboard, to_port = levers((1.0, 1.0)), levers((1.0, -1.0))
    begin, end = (
        1 + int(lengths * boat.length / reference_of(boat).speed / step) for lengths in (TURNING, STOPPING)
    )
    params, start = under_way(boat, parameters(boat), 1, levers((1.0, 0.0)))
    commands = np.concatenate([np.tile(to_starboard, (begin, 1)), np.tile(to_port, (end, 1))])
    track = simulate(
        params, tank(boat), start, commands[None], np.zeros(1, np.uint64), step, substeps_of(step, boat)
    )[0]
    after = track[begin:]
    over = after[:, YAW_RATE] <= 0.0
    stop = int(np.argmax(over)) if over.any() else len(after) - 1
    heading = np.unwrap(after[:, HEADING])
    return float(after[0, YAW_RATE]), float(heading[stop] - heading[0])

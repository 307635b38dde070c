"""How likely wirings of the commands are by equation error: moment and force as the thrusters are placed."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat_fit.equation_error import Asked, answers_of, log_likelihood, smoothed, window_of
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.doctor.layout import demanded, places_of
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]


def wiring_likelihoods(run_set: RunSet, boats: Sequence[Boat], offset: float) -> Array:
    """(W,) log likelihood of the motion with each boat's wiring, but for a constant.

    offset: seconds by which the motion follows the commands, as `command_offset` finds them. What a wiring
    asks for, each of two laws of thrust, has a coefficient that is not negative.
    """
    rows, shift = window_of(run_set.boat, run_set.dt), round(offset / run_set.dt)
    answers = answers_of(run_set)
    return np.array(
        [log_likelihood(answers, _asked(run_set, boat, rows), shift, rows, least=0.0) for boat in boats]
    )


def _asked(run_set: RunSet, boat: Boat, rows: int) -> list[Asked]:
    """Yaw moment and force ahead (T, 2) of each run, by two laws of thrust, smoothed as the motion is."""
    wired = parameters(boat)[0]
    channel, found = wired["channel"].astype(int), []
    for commands, length in zip(run_set.commands, run_set.lengths, strict=True):
        angles, levels = np.split(commands[:length], 2, axis=1)
        columns = {}
        for k, thruster in enumerate(boat.thrusters):
            angle, level = thruster.command_columns
            columns[level] = wired["throttle_sign"][k] * levels[:, channel[k]]
            if angle is not None:
                columns[angle] = wired["azimuth_sign"][k] * angles[:, channel[k]]
        force, moment = demanded(columns, places_of(boat, columns))
        found.append((smoothed(moment, rows, 0, run_set.dt), smoothed(force, rows, 0, run_set.dt)))
    return found

"""Offset between the clocks of commands and receiver by equation error, under any wiring of the thrusters.

The thrust of every thruster, ahead and across, has a free coefficient: an exchanged channel, a wrong sign or
a wrong coefficient does not move the offset of the greatest likelihood.
"""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, PropellerRudder
from swamp_rl.boat_fit.equation_error import answers_of, log_likelihood, smoothed, window_of
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.doctor.response import LIKELIER

Array = NDArray[np.float64]

LONGEST = 3.0  # s, to either side
GRID = 0.1  # s


def command_offset(run_set: RunSet) -> float:
    """Seconds by which the motion follows the commands, negative where it precedes them.

    The lags of actuators are part of it. 0 where no offset is clearly the likeliest, or it is at the end of
    the search.
    """
    dt = run_set.dt
    rows, answers = window_of(run_set.boat, dt), answers_of(run_set)
    asked = [
        (both := smoothed(thrusts(run_set.commands[run, :length], run_set.boat), rows, 0, dt), both)
        for run, length in enumerate(run_set.lengths)
    ]
    step = max(1, round(GRID / dt))
    most = round(LONGEST / dt)
    shifts = np.arange(-most, most + 1, step)
    found = np.array([log_likelihood(answers, asked, int(shift), rows) for shift in shifts])
    best, none = int(np.argmax(found)), int(np.argmin(np.abs(shifts)))
    at_end = best in (0, len(shifts) - 1)
    return 0.0 if at_end or found[best] - found[none] < LIKELIER else float(shifts[best] * dt)


def thrusts(commands: Array, boat: Boat) -> Array:
    """(T, N) levels and squared levels with their sign, ahead and across, of commands (T, 2K): curves of
    thrust lie between the two.
    """
    count = len(boat.thrusters)
    angle, level = commands[:, :count], commands[:, count:]
    full = np.array([max(abs(t.throttle_min), t.throttle_max) for t in boat.thrusters])
    across = np.array([isinstance(t, PropellerRudder) or t.kind == "azimuth" for t in boat.thrusters])
    ahead = [isinstance(t, PropellerRudder) for t in boat.thrusters]
    cosine, sine = np.where(ahead, 1.0, np.cos(angle)), np.sin(angle)[:, across]
    laws = level / full, level * np.abs(level) / full**2
    return np.hstack([part for law in laws for part in (law * cosine, law[:, across] * sine)])

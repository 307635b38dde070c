"""How a boat's yaw rate answers a small steering angle, and the gain of a yaw rate loop that it bears."""

import math

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.manoeuvres.controller import Order, Trial
from swamp_rl.manoeuvres.steering import commands_of
from swamp_rl.manoeuvres.under_way import under_way
from swamp_rl.simulator import parameters, step, tank
from swamp_rl.simulator.state import SURGE, YAW_RATE
from swamp_rl.simulator.substeps import substeps_of

Array = NDArray[np.float64]

SMALL = 0.02  # rad of steering angle, within which rate limits hardly count
WATCHED = 0.5  # lengths sailed, before the boat's own motion decides
LEAST = 3  # samples that are watched
SIMC = 0.5  # gain times slope times delay, at which overshoot is small


def stable_gain(boat: Boat, trial: Trial, dt: float) -> float:
    """Largest gain [s] from yaw rate to steering angle at the trial's throttle, for a loop sampled every dt
    [s]; infinite for a boat that does not answer.

    K = 0.5 / (slope (delay + dt / 2)), of an integrating process with delay (Skogestad, Simple analytic
    rules for model reduction and PID controller tuning, J. Process Control 13, 2003, with the closed loop as
    fast as the delay). Slope [1/s²] and delay [s] are those of the steepest tangent of the step response.
    """
    turning = _step_response(boat, trial, dt)
    slopes = np.diff(turning) / dt
    steepest = int(np.argmax(slopes))
    slope, middle = slopes[steepest], 0.5 * (turning[steepest] + turning[steepest + 1])
    if slope <= 0.0:
        return math.inf
    delay = (steepest + 0.5) * dt - middle / slope
    return SIMC / float(slope * (max(delay, 0.0) + 0.5 * dt))


def _step_response(boat: Boat, trial: Trial, dt: float) -> Array:
    """(T,) yaw rate per steering angle [1/s] after a small step to either side, at the speed of the trial's
    throttle.
    """
    orders = commands_of(boat, "opposed" if trial.pattern == "parallel" else trial.pattern)
    amidships = orders(Order(0.0, trial.throttle))
    params, state = under_way(boat, parameters(boat), 2, amidships, trial.throttle)
    commands = np.stack([orders(Order(side * SMALL, trial.throttle)) for side in (1.0, -1.0)])
    samples = max(LEAST, math.ceil(WATCHED * boat.length / state[0, SURGE] / dt))
    turning, seeds = np.zeros(samples + 1), np.zeros(2, np.uint64)
    for k in range(samples):
        step(state, params, tank(boat), commands, seeds, dt, substeps_of(dt, boat))
        turning[k + 1] = (state[0, YAW_RATE] - state[1, YAW_RATE]) / (2.0 * SMALL)
    return turning

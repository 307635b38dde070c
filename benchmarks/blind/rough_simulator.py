"""Runs of another simulator than the one that is fitted: what a model of a real boat leaves over (level R).

Heun's method in steps of `STEP` in place of Runge-Kutta's of order four, actuators by Euler's, every curve in
error by `CURVE_ERROR` (thrust of each thruster against throttle, the hull's forces against speed, drift angle
and yaw rate), and Gauss-Markov forces. The errors have a mean of zero over a curve: no effect is in them.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.synthetic.cases import (
    DT,
    Case,
    Voyage,
    drivers,
    hook_of,
    true_record,
)
from swamp_rl.experiments.synthetic.draws import RUNS, Rng
from swamp_rl.experiments.synthetic.drivers import Array, Driver

from swamp_rl.boat import Boat, load_boat
from swamp_rl.physics.compile import compiled
from swamp_rl.physics.force_curve import ANGLE_OF_THRUSTER, JET
from swamp_rl.physics.hull import hull_forces
from swamp_rl.physics.motion import external_forces, water_velocity
from swamp_rl.physics.propulsion import actuator_output, propulsion_forces
from swamp_rl.physics.resistance import towing
from swamp_rl.physics.rigid_body import accelerations, inverse_inertia
from swamp_rl.physics.thrusters import alive, put_output, supply
from swamp_rl.simulator import initial_state, tank
from swamp_rl.simulator.delay import delayed_command
from swamp_rl.simulator.sensors import rows_ahead
from swamp_rl.simulator.state import ACTUATORS, TIME
from swamp_rl.simulator.step import commanded, wind_now

STEP = 0.02  # s
CURVE_ERROR = 0.03  # root mean square of every curve's relative error
# periods of the errors: of speed [m/s], drift angle [rad], yaw rate [rad/s], throttle [1]
PERIODS = np.array([0.8, math.pi, 0.5, 0.5])
HULL_CURVES = 3
PROCESS_NOISE = np.array([0.3, 0.3, 0.1])  # standard deviation of its forces [N, N, N m]: 5 % of a jet's
NOISE_TIME = 3.0  # s, its correlation time


@compiled
def in_error(x: float, curve: Any) -> float:
    """Factor [1] of a curve at x; curve: wave number and two phases of a ripple of unit variance."""
    ripple = math.sin(curve[0] * x + curve[1]) + math.sin(2.0 * curve[0] * x + curve[2])
    return 1.0 + CURVE_ERROR * ripple


@compiled
def turn_actuators(state: Any, command: Any, h: float, jets: Any, curves: Any, p: Any) -> None:
    """Move the actuators by h [s] (Euler); jets (1, K, JET) takes their outputs then."""
    thrusters = jets.shape[1]
    for k in range(thrusters):
        azimuth, throttle = commanded(k, state[TIME], command, p)
        angle, level = state[ACTUATORS + k], state[ACTUATORS + thrusters + k]
        slowest = max(p.azimuth_time_constant[k], h)
        rate = min(max((azimuth - angle) / slowest, -p.azimuth_rate[k]), p.azimuth_rate[k])
        angle += h * rate
        level += h * (throttle - level) / max(p.pump_time_constant[k], h)
        state[ACTUATORS + k], state[ACTUATORS + thrusters + k] = angle, level
        first, second = actuator_output(angle, level, k, p)
        left = alive(k, state[TIME], h, p) * supply(state[TIME], p)
        left *= in_error(level, curves[HULL_CURVES + k])
        put_output(left * first, left * second, jets, 0, k, p)
        jets[0, k, ANGLE_OF_THRUSTER] = angle


@compiled
def rough_rates(
    motion: Any, state: Any, jets: Any, push: Any, curves: Any, p: Any, tank: Any, rate: Any
) -> None:
    """Fill rate (6,) of motion (6,), velocities relative to the water; push: (3,) forces on the hull."""
    u, v, r = motion[3], motion[4], motion[5]
    cos, sin = math.cos(motion[2]), math.sin(motion[2])
    north, east = water_velocity(state[TIME], p)
    surge, sway, yaw = hull_forces(u, v, r, p, tank, towing(p, tank))
    surge *= in_error(math.hypot(u, v), curves[0])
    sway *= in_error(math.atan2(v, u), curves[1])
    yaw *= in_error(r, curves[2])
    x_jets, y_jets, n_jets = propulsion_forces(jets, 0, u, v, r, p)
    over_ground = u + north * cos + east * sin, v + east * cos - north * sin
    wind = wind_now(state, p)
    x_out, y_out, n_out = external_forces(cos, sin, over_ground[0], over_ground[1], state[TIME], wind, p)
    surge, sway, yaw = surge + x_jets + x_out, sway + y_jets + y_out, yaw + n_jets + n_out
    surge, sway, yaw = surge + push[0], sway + push[1], yaw + push[2]
    rate[3], rate[4], rate[5] = accelerations(u, v, r, surge, sway, yaw, inverse_inertia(p), p)
    rate[0], rate[1], rate[2] = u * cos - v * sin + north, u * sin + v * cos + east, r


@compiled
def rough_row(
    state: Any, p: Any, tank: Any, command: Any, push: Any, curves: Any, count: int, h: float
) -> None:
    """Advance one boat (S,) in place by `count` steps of h [s] of Heun's method."""
    jets = np.empty((1, command.shape[0] // 2, JET))
    first, second, motion = np.empty(6), np.empty(6), np.empty(6)
    for _ in range(count):
        north, east = water_velocity(state[TIME], p)
        cos, sin = math.cos(state[2]), math.sin(state[2])
        motion[:] = state[:6]
        motion[3] -= north * cos + east * sin
        motion[4] -= east * cos - north * sin
        turn_actuators(state, command, h, jets, curves, p)
        rough_rates(motion, state, jets, push, curves, p, tank, first)
        state[TIME] += h
        rough_rates(motion + h * first, state, jets, push, curves, p, tank, second)
        motion += 0.5 * h * (first + second)
        north, east = water_velocity(state[TIME], p)
        cos, sin = math.cos(motion[2]), math.sin(motion[2])
        state[:6] = motion
        state[3] += north * cos + east * sin
        state[4] += east * cos - north * sin


def curves_in_error(rng: Rng, thrusters: int) -> Array:
    """(3 + K, 3) wave number and phases of each curve's error, of the hull's and of each thruster's."""
    waves = 2.0 * math.pi / np.concatenate([PERIODS[:HULL_CURVES], np.full(thrusters, PERIODS[HULL_CURVES])])
    return np.column_stack([waves, rng.uniform(0.0, 2.0 * math.pi, (len(waves), 2))])


def process_noise(rng: Rng, rows: int) -> Array:
    """(rows, 3) Gauss-Markov forces, a row a step of `DT`."""
    keep = math.exp(-DT / NOISE_TIME)
    found = rng.standard_normal((rows, 3))
    for row in range(1, rows):
        found[row] = keep * found[row - 1] + math.sqrt(1.0 - keep * keep) * found[row]
    return np.asarray(found * PROCESS_NOISE)


def sail_roughly(
    boat: Boat, case: Case, driver: Driver, start: Array, steps: int, curves: Array, rng: Rng
) -> Voyage:
    """A run from a start at rest: north, east [m], heading [rad], as `sail` has it."""
    params: NDArray[Any] = true_record(boat, case)
    every = steps + rows_ahead(params, steps * DT, DT)
    true, hook = params.copy(), hook_of(case.outside, boat)
    state = initial_state(params, start[None])[0]
    push = process_noise(rng, every)
    asked, arrived = np.zeros((every + 1, 2 * len(boat.thrusters))), np.zeros(2 * len(boat.thrusters))
    track = np.zeros((every + 1, len(state)))
    track[0] = state
    for row in range(every):
        asked[row] = driver(row * DT, state)
        delayed_command(asked, row, float(params["command_delay"][0]) / DT, arrived)
        hook(params, state, arrived)
        rough_row(state, params[0], tank(boat), arrived, push[row], curves, round(DT / STEP), STEP)
        track[row + 1] = state
    asked[steps] = asked[steps - 1]
    return Voyage(track, asked[: steps + 1], true)


def rough_voyages(case: Case, rng: Rng, runs: int = RUNS, seconds: float = 80.0) -> list[Voyage]:
    """The runs of a case, all of one boat with the same errors of its curves."""
    boat = load_boat("swamp")
    curves = curves_in_error(rng, len(boat.thrusters))
    return [
        sail_roughly(boat, case.of_run(run), driver, start, round(seconds / DT), curves, rng)
        for run, (driver, start) in enumerate(drivers(case, rng, runs))
    ]

"""Refusal of boats whose simulated motion diverges, by a few steps from rest and at speed."""

import hashlib
import math
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.constants import GRAVITY
from swamp_rl.errors import UserError
from swamp_rl.physics.compile import cache_folder
from swamp_rl.simulator.state import ACTUATORS, SURGE, YAW_RATE, state_size
from swamp_rl.simulator.step import SUBSTEP, simulate

Array = NDArray[np.float64]

FROUDE = 0.5  # of the runs at speed
SPAN = 10.0  # duration of a run over sqrt(length / g)
MOST_STEPS = 100
FINER = 8  # times shorter are the steps that the result is set against
APART = 0.2  # of the reference speed that the two results may differ by
FASTEST = 20.0  # reference speeds that no boat of this size reaches
BEYOND = 1e9  # a command that every thruster's own limit cuts off
LOOK_AT = (
    ("surge", "the resistance, the thrust, mass and added_mass_surge"),
    ("sway", "hull.y_v, hull.c_d, mass and added_mass_sway"),
    ("yaw", "hull.n_v, hull.n_r, hull.c_rn, inertia_z and added_inertia_yaw"),
)


class DivergenceError(UserError):
    """A boat whose simulated motion diverges; what: from which start, how and when; keys: of the file to
    check."""

    def __init__(self, name: str, what: str, keys: str) -> None:
        super().__init__(f"boat {name}: {what}; check {keys}, and their units")
        self.what = what


def refuse_divergence(name: str, params: NDArray[Any], tank: Array) -> None:
    """DivergenceError unless a few steps of the boat `name` stay bounded and agree with finer steps.

    params: (1,) parameter record, effects left out; tank: of `tank_table`. From rest and from a Froude number
    of 0.5 with drift and turn, under full thrust ahead, the port side's alone and hard over, and none. That a
    record passed is kept beside the machine code, so that each boat is tried once.
    """
    digest = hashlib.sha256(params.tobytes() + tank.tobytes() + str(params.dtype).encode()).hexdigest()
    kept = cache_folder()
    passed = None if kept is None else kept / f"bounded-{digest[:32]}"
    if passed is not None and passed.exists():
        return
    length = float(params["length"][0])
    speed = FROUDE * math.sqrt(GRAVITY * length)
    steps = min(math.ceil(SPAN * math.sqrt(length / GRAVITY) / SUBSTEP), MOST_STEPS)
    scale = speed * np.array([1.0, 1.0, 1.0 / length])
    start = np.zeros((6, 3))
    start[1::2] = scale * np.array([1.0, 0.2, 0.2])
    coarse = _velocities(params, tank, start, steps, SUBSTEP)
    finest = _velocities(params, tank, start, FINER * steps, SUBSTEP / FINER)
    fine = finest[:, FINER - 1 :: FINER]
    with np.errstate(invalid="ignore", over="ignore"):
        unbounded = ~(np.abs(coarse) < FASTEST * scale)
        wrong = unbounded | ~(np.abs(coarse - fine) < APART * scale)
    if wrong.any():
        step = int(np.argmax(wrong.any(axis=(0, 2))))
        run = int(np.argmax(wrong[:, step].any(axis=1)))
        quickest = np.argmax(np.nan_to_num(np.abs(finest[run, 0] - start[run]) / scale, nan=np.inf))
        motion, keys = LOOK_AT[quickest]
        what = "diverges" if unbounded.any() else f"changes faster than steps of {SUBSTEP:g} s follow"
        begun = f"{speed:.3g} m/s" if run % 2 else "rest"
        when = f"within {(step + 1) * SUBSTEP:.1f} s, {motion} first"
        raise DivergenceError(name, f"simulated from {begun}, its motion {what} {when}", keys)
    if passed is not None:
        with suppress(OSError):
            passed.touch()


def _velocities(params: NDArray[Any], tank: Array, start: Array, steps: int, dt: float) -> Array:
    """(6, steps, 3) surge, sway, yaw rate from `start` (6, 3): two runs ahead, hard over, and adrift."""
    x, y = params["thruster_x"][0], params["thruster_y"][0]
    count = len(x)
    state = np.zeros((6, state_size(count)))
    state[:, SURGE : YAW_RATE + 1] = start
    state[:, ACTUATORS : ACTUATORS + count] = np.clip(0.0, params["azimuth_min"], params["azimuth_max"])
    commands = np.zeros((6, steps, 2 * count))
    commands[:2, :, count:] = BEYOND
    commands[2:4, :, :count] = np.sign(x) * 0.5 * math.pi
    commands[2:4, :, count:] = np.where(y <= 0.0, BEYOND, 0.0)
    track = simulate(np.repeat(params, 6), tank, state, commands, np.zeros(6, np.uint64), dt, 1)
    return np.asarray(track[:, 1:, SURGE : YAW_RATE + 1])

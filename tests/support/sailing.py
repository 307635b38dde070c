"""Runs of a boat whose truth is known, short and with little noise, to identify it from."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.runs import Run, append_run, create_dataset
from swamp_rl.runs.schema import DatasetMeta
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.sensors import observe

RATE = 0.1  # s
NOISE = np.array([0.03, 0.03, 0.01, 0.03, 0.03, 0.02])


def steps_of_thrust(
    boat: Boat, rows: int, rng: np.random.Generator, low: float, longest: float, high: float = 1.0
) -> NDArray[np.float64]:
    """(rows, 2K) commands that step at random, throttles from `low` to `high`, each for `longest` [s] at
    most.
    """
    commands = np.zeros((rows, 2 * len(boat.thrusters)))
    for k in range(len(boat.thrusters)):
        row = 0
        while row < rows:
            held = max(1, int(rng.uniform(0.1, 1.0) * longest / RATE))
            commands[row : row + held, len(boat.thrusters) + k] = rng.uniform(low, high)
            row += held
    return commands


def sailed_dataset(
    folder: Path,
    start: Path,
    truth: Boat,
    seed: int = 0,
    count: int = 3,
    seconds: float = 60.0,
    low: float = -1.0,
    idle: Collection[str] = (),
    noise: float = 1.0,
    high: float = 1.0,
    steered: float = 0.0,
) -> Path:
    """A dataset of runs that `truth` sailed, which names the file `start` as its boat; idle: thrusters that
    are not commanded; noise: of the sensors, over NOISE; steered: greatest azimuth [rad] of thrusters that
    turn, which all take the same.
    """
    rng = np.random.default_rng(seed)
    rows = int(seconds / RATE)
    meta: dict[str, Any] = {
        "mass": truth.mass,
        "draught": truth.draught,
        "water_density": truth.water_density,
    }
    create_dataset(folder, DatasetMeta(vehicle=str(start), sample_rate=1.0 / RATE, source="scripted", **meta))
    for number in range(count):
        commands = steps_of_thrust(truth, rows, rng, low, 8.0, high)
        commands[:, [len(truth.thrusters) + truth.thruster_names.index(name) for name in idle]] = 0.0
        if steered > 0.0:
            orders = rng.uniform(-steered, steered, rows // 50 + 1)
            commands[:, : len(truth.thrusters)] = np.repeat(orders, 50)[:rows, None]
        record = parameters(truth)
        begin = initial_state(record, np.zeros((1, 3)))
        track = simulate(record, tank(truth), begin, commands[None], np.zeros(1, np.uint64), RATE, 1)
        measured = observe(track, record, RATE)[0, :rows] + noise * NOISE * rng.standard_normal((rows, 6))
        measured[:, 2] = np.pi - np.mod(np.pi - measured[:, 2], 2.0 * np.pi)
        names = ("north", "east", "heading", "surge", "sway", "yaw_rate")
        columns = {"time": RATE * np.arange(rows), **dict(zip(names, measured.T, strict=True))}
        for k, name in enumerate(truth.thruster_names):
            columns[f"throttle_{name}"] = commands[:, len(truth.thrusters) + k]
            if truth.thrusters[k].kind == "azimuth":
                columns[f"azimuth_{name}"] = commands[:, k]
        append_run(folder, Run(f"run{number}", columns))
    return folder

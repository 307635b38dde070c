"""The stream of a monitor's trial: a boat that sails with noisy sensors, and something that begins."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.synthetic.cases import DT, RTK, SUBSTEP
from swamp_rl.experiments.synthetic.drivers import RICH, Driver

from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import apply_effects, parse_effects
from swamp_rl.link import Sample
from swamp_rl.simulator import initial_state, parameters, step, tank

Array = NDArray[np.float64]

LEG = 80.0  # s after which another manoeuvre begins
BOAT = load_boat("swamp")


@dataclass(frozen=True)
class Fault:
    """What begins at a time [s]. effect: as a boat file has it; ramp: seconds over which it grows; frozen:
    channels that repeat their reading; name: what a monitor should say.
    """

    name: str
    time: float
    effect: dict[str, Any] | None = None
    ramp: float = 0.0
    frozen: tuple[int, ...] = ()


def drive(rng: np.random.Generator) -> Driver:
    """One manoeuvre of all four thrusters after another."""
    drivers: list[Driver] = []

    def command(time: float, state: Array) -> Array:
        leg = int(time // LEG)
        while len(drivers) <= leg:
            drivers.append(RICH[rng.integers(len(RICH))](rng))
        return drivers[leg](time - leg * LEG, state)

    return command


def sea(rng: np.random.Generator, rough: bool) -> list[dict[str, Any]]:
    """Effects of a steady current; where rough, also of a gusty wind."""
    angle = rng.uniform(-np.pi, np.pi)
    speed = rng.uniform(0.0, 0.2)
    effects: list[dict[str, Any]] = [
        {"effect": "current", "north": speed * np.cos(angle), "east": speed * np.sin(angle)}
    ]
    if rough:
        wind = {"effect": "wind", "speed": rng.uniform(1.0, 4.0), "from": rng.uniform(-np.pi, np.pi)}
        effects += [wind, {"effect": "gusts", "speed_std": 0.5, "direction_std": 0.1}]
    return effects


def record_of(boat: Boat, effects: Sequence[dict[str, Any]]) -> NDArray[Any]:
    """(1,) parameters of the boat with these effects."""
    record = parameters(boat)
    entries = parse_effects(list(effects), "benchmark", boat.thruster_names)
    apply_effects(record, entries, boat.thruster_names)
    return record


def stream(seed: int, seconds: float, rough: bool = False, fault: Fault | None = None) -> Iterator[Sample]:
    """Samples of a boat that sails on and on, from its seed."""
    rng = np.random.default_rng([seed, int(rough)])
    driver, effects = drive(rng), sea(rng, rough)
    state = initial_state(parameters(BOAT), np.zeros((1, 3)))
    now, gusts = record_of(BOAT, effects), np.full(1, seed, np.uint64)
    held: Array | None = None
    substeps = round(DT / SUBSTEP)
    for row in range(round(seconds / DT)):
        time = row * DT
        if fault is not None and fault.effect is not None and time >= fault.time:
            now = record_of(BOAT, [*effects, _grown(fault, time)])
        command = driver(time, state[0])
        senses = state[0, :6] + RTK * rng.standard_normal(6)
        senses[2] += now["heading_bias"][0]
        senses[5] += now["gyro_bias"][0]
        if fault is not None and fault.frozen and time >= fault.time:
            held = senses.copy() if held is None else held
            senses[list(fault.frozen)] = held[list(fault.frozen)]
        yield Sample(time, command, senses)
        step(state, now, tank(BOAT), command[None], gusts, DT, substeps)


def _grown(fault: Fault, time: float) -> dict[str, Any]:
    """The effect as large as it is by then; what has no ramp is there at once."""
    assert fault.effect is not None
    if fault.ramp <= 0.0:
        return fault.effect
    share = min(1.0, (time - fault.time) / fault.ramp)
    return {
        name: value * share if isinstance(value, float) else value for name, value in fault.effect.items()
    }

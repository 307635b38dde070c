"""A controller in closed loop on what the boat's sensors report, until it is done, as a run."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat.applicable import refuse_inapplicable
from swamp_rl.effects import LIBRARY, load_disturbances, parse_effects
from swamp_rl.guidance.loop import Controller, closed_loop, seen_of
from swamp_rl.runs import Run, RunMeta
from swamp_rl.simulator import initial_state, parameters
from swamp_rl.simulator.reference import size_of
from swamp_rl.simulator.replay import run_of
from swamp_rl.simulator.sensors import CHANNELS, observe
from swamp_rl.simulator.state import NORTH, YAW_RATE

Array = NDArray[np.float64]

STEP = 0.1  # s
SENSOR_FIELDS = tuple(p.field for e in LIBRARY.values() if e.acts_on == "sensor" for p in e.parameters)


class Ending(Controller, Protocol):
    """A controller that knows when it has come to its end."""

    over: bool


@dataclass(frozen=True)
class Flight:
    """T rows of `STEP`: states (T, S), measured channels (T, 6), commands (T, 2K).

    completed: whether the end was reached.
    """

    boat: Boat
    track: Array
    measured: Array
    commands: Array
    completed: bool

    @property
    def time(self) -> Array:
        """(T,) [s]."""
        return np.arange(len(self.track), dtype=np.float64) * STEP

    def run(self, name: str, seed: int, drawn: list[dict[str, Any]], more: dict[str, Any]) -> Run:
        """The run, with what was drawn of the disturbances and `more` in its meta."""
        first = dict(zip(CHANNELS, self.measured[0].tolist(), strict=True))
        meta = {
            "seed": seed,
            "initial_state": first,
            "outcome": "success" if self.completed else "incomplete",
        }
        source = Run(name, {"time": self.time} | command_columns(self.boat, self.commands))
        found = run_of(self.track, self.measured, self.time, source, self.boat)
        given = meta | ({"disturbances": drawn} if drawn else {}) | more
        return Run(name, found.columns, RunMeta.model_validate(given))


def command_columns(boat: Boat, commands: Array) -> dict[str, Array]:
    """Commands (T, 2K) as the columns of a run."""
    angles, levels = np.split(commands, 2, axis=1)
    columns: dict[str, Array] = {}
    for k, thruster in enumerate(boat.thrusters):
        angle, level = thruster.command_columns
        if angle is not None:
            columns[angle] = angles[:, k]
        columns[level] = levels[:, k]
    return columns


def of_one_clock(params: NDArray[Any]) -> NDArray[Any]:
    """The records (n,) without an error of the receiver's clock, which acts on the times of another recorder
    alone.
    """
    params = params.copy()
    params["clock_offset"] = params["clock_drift"] = 0.0
    return params


def sensing(params: NDArray[Any], dt: float) -> Callable[[list[Array]], Array]:
    """From the states (n, S) so far to what sensors on board of boats with those records report (n, 6)."""
    exact = not any(params[name].any() for name in SENSOR_FIELDS)
    tail = 2 + math.ceil(float(params["position_delay"].max()) / dt)
    on_board = of_one_clock(params)

    def channels(states: list[Array]) -> Array:
        if exact:
            return states[-1][:, NORTH : YAW_RATE + 1]
        return observe(np.stack(states[-tail:], axis=1), on_board, dt)[:, -1]

    return channels


def flown(
    boat: Boat, controller: Ending, pose: tuple[float, float, float], longest: float, seed: int = 0
) -> Flight:
    """The boat with its effects from rest at a pose [m, m, rad], until the controller is over or after
    `longest` [s]; seed: of the gusts."""
    params = parameters(boat)
    sensed, steps = sensing(params, STEP), round(longest / STEP)

    def decide(states: list[Array]) -> tuple[Array, bool]:
        tick = len(states) - 1
        seen = seen_of(tick * STEP, states[-1][0], sensed(states)[0])
        return controller.act(seen, STEP)[None], controller.over or tick >= steps

    state = initial_state(params, np.array([pose]))
    track, commands = closed_loop(boat, params, state, decide, np.array([seed], np.uint64), STEP)
    return Flight(boat, track[0], observe(track, params, STEP)[0], commands[0], controller.over)


def in_sea(
    boat: Boat, disturbances: Any, sea: list[dict[str, Any]], seed: int
) -> tuple[Boat, Array, list[dict[str, Any]]]:
    """The boat in a sea; offsets (3,) of its start [m, m, rad]; and the effects that were drawn.

    disturbances: as for `load_disturbances`; sea: further effects with numbers, which follow the drawn ones.
    """
    level = load_disturbances(disturbances, boat.thruster_names, size_of(boat))
    uniforms = np.random.default_rng(seed).random(level.draw_count)
    drawn = [*level.drawn(uniforms), *sea]
    effects = parse_effects(drawn, "the sea", boat.thruster_names)
    refuse_inapplicable(boat, (entry.effect for entry in effects), f"disturbances {level.name}")
    with_them = boat.model_copy(update={"effects": (*boat.effects, *effects)})
    return with_them, level.start(uniforms[None])[0], drawn

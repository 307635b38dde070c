"""Blind cases for model criticism: runs of a boat with something wrong, and apart from them what it was.

A case is drawn from a seed: what is wrong, its sign and size, manoeuvres, noise, dropped samples. The data
go to one folder in the run format, the truth to a file elsewhere, so that who diagnoses sees only the data.
"""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.synthetic.drivers import RICH, Array, Driver, gate_run, straight

from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import apply_effects, parse_effects
from swamp_rl.files import write_yaml
from swamp_rl.runs import DatasetMeta, RunMeta
from swamp_rl.runs.table import write_table
from swamp_rl.simulator import initial_state, parameters, step, tank
from swamp_rl.simulator.delay import delayed_command
from swamp_rl.simulator.sensors import add_noise, observe
from swamp_rl.simulator.state import EAST, HEADING, NORTH

DT = 0.1
SUBSTEP = 0.05  # s
HULL = ("x_vr", "y_v", "y_r", "n_v", "n_r")
HULL_SPREAD = 0.1  # standard deviation of their scales at level D
LEVELS = ("A", "B", "C", "D")
POWER = "P"  # as A, single effects of any size down to nothing
SMALL = (3e-4, 0.1)  # sizes of its effects
KINDS = ("single", "pair", "clean", "outside", "confounded")
DEGREE = math.pi / 180
# standard deviations of north, east [m], heading [rad], surge, sway [m/s], yaw rate [rad/s]
RTK = np.array([0.05, 0.05, 0.5 * DEGREE, 0.03, 0.03, 0.3 * DEGREE])
PLAIN = np.array([0.5, 0.5, 1.0 * DEGREE, np.inf, np.inf, 0.6 * DEGREE])
DROPPED = 0.02  # share of the rows that are lost
STEADY = 60.0  # s of straight running before a confounded case is recorded, so that it no longer gathers way

Rng = np.random.Generator
Hook = Callable[[NDArray[Any], Array, Array], None]


@dataclass(frozen=True)
class Case:
    """The truth.

    effects: as a boat file has them; outside: what no library effect is; size: of the effect against a
    typical one; hull: scale of each linear derivative.
    """

    level: str
    kind: str
    effects: list[dict[str, Any]]
    size: float = 1.0
    outside: dict[str, Any] | None = None
    hull: dict[str, float] = field(default_factory=dict)


def signed(rng: Rng, typical: float, size: float) -> float:
    """+- typical times size."""
    return float(rng.choice([-1.0, 1.0]) * typical * size)


def thruster(rng: Rng, level: str) -> str:
    """One that the data can show: gate runs use the bow's alone."""
    return str(rng.choice(["bs", "bp"] if level == "C" else ["bs", "bp", "ss", "sp"]))


def polar(rng: Rng, length: float) -> dict[str, float]:
    """A vector of that length in any direction."""
    angle = rng.uniform(-math.pi, math.pi)
    return {"north": length * math.cos(angle), "east": length * math.sin(angle)}


def drift(rng: Rng, size: float) -> dict[str, float]:
    """A current that turns into another within a run."""
    rates = polar(rng, 0.003 * size)
    return polar(rng, 0.08) | {"north_rate": rates["north"], "east_rate": rates["east"]}


def swap(rng: Rng) -> list[str]:
    """Two thrusters."""
    return [str(name) for name in rng.choice(["bs", "bp", "ss", "sp"], 2, replace=False)]


def scale(rng: Rng, share: float, size: float) -> float:
    """A scale that departs from 1 by a share either way."""
    return math.exp(signed(rng, share, size))


Draw = Callable[[Rng, float, str], dict[str, Any]]
EFFECTS: dict[str, Draw] = {
    "current": lambda g, s, _: polar(g, 0.12 * s),
    "drifting_current": lambda g, s, _: drift(g, s),
    "wind": lambda g, s, _: {"speed": 5.0 * s, "from": float(g.uniform(-math.pi, math.pi))},
    "waves": lambda g, s, _: {
        "force": 4.0 * s,
        "frequency": float(g.uniform(0.1, 0.5)),
        "from": float(g.uniform(-math.pi, math.pi)),
    },
    "shallow_water": lambda g, s, _: {"depth_over_draught": 1.0 + 1.2 / min(s, 1.5)},
    "thruster_gain": lambda g, s, v: {"thruster": thruster(g, v), "gain": 1.0 + max(signed(g, 0.3, s), -0.9)},
    "thruster_failure": lambda g, s, v: {"thruster": thruster(g, v), "time": float(g.uniform(15.0, 60.0))},
    "azimuth_offset": lambda g, s, v: {
        "thruster": "all" if g.random() < 0.4 else thruster(g, v),
        "offset": signed(g, 0.15, s),
    },
    "azimuth_lag": lambda g, s, _: {"time_constant": 0.1 + 0.6 * s},
    "command_delay": lambda g, s, _: {"delay": 0.5 * s},
    "pump_lag": lambda g, s, _: {"time_constant": 0.8 * s},
    "channel_swap": lambda g, s, _: {"thruster": swap(g)},
    "thrust_scale": lambda g, s, _: {"scale": scale(g, 0.2, s)},
    "advance_thrust_loss": lambda g, s, _: {"factor": 0.8 * s},
    "crossflow_thrust_loss": lambda g, s, _: {"coefficient": 12.0 * s},
    "thrust_deduction": lambda g, s, _: {"low": 1.0 - 0.4 * s, "high": 1.0 - 0.1 * s},
    "thrust_sag": lambda g, s, _: {"rate": 0.004 * s},
    "resistance": lambda g, s, _: {"scale": scale(g, 0.35, s)},
    "linear_drag": lambda g, s, _: {"coefficient": 6.0 * s},
    "mass": lambda g, s, _: {"mass": 58.0 * scale(g, 0.2, s)},
    "centre_of_gravity": lambda g, s, _: {"x_g": signed(g, 0.08, s)},
    "yaw_inertia": lambda g, s, _: {"scale": scale(g, 0.4, s)},
    "sway_drag": lambda g, s, _: {"scale": scale(g, 0.4, s)},
    "yaw_damping": lambda g, s, _: {"scale": scale(g, 0.5, s)},
    "demihull_spacing": lambda g, s, _: {"spacing": 0.8 * scale(g, 0.5, s)},
    "hull_asymmetry": lambda g, s, _: {"yaw_moment": signed(g, 2.0, s)},
    "external_force": lambda g, s, _: polar(g, 2.0 * s),
    "heading_bias": lambda g, s, _: {"bias": signed(g, 0.1, s)},
    "position_delay": lambda g, s, _: {"delay": 0.5 * s},
    "position_lever_arm": lambda g, s, _: (lambda p: {"x": p["north"], "y": p["east"]})(polar(g, 0.4 * s)),
}
# both bow thrusters obey the same lever, which is nearly always at its end
NOT_IN_GATE_RUNS = ("channel_swap", "dead_zone")
ONE_PURPOSE = (
    ("current", "drifting_current"),
    ("resistance", "shallow_water"),
    ("channel_swap", "thruster_gain"),
)


def draw_case(
    rng: Rng, level: str, kind: str, names: tuple[str, ...] = (), size: float | None = None
) -> Case:
    """A case at random. names: the effects, else drawn; size: against a typical one, else 0.5 to 1.5."""
    if size is None:
        size = float(np.exp(rng.uniform(*np.log(SMALL))) if level == POWER else rng.uniform(0.5, 1.5))
    hull = {name: float(rng.normal(1.0, HULL_SPREAD)) for name in HULL} if level == "D" else {}
    if kind == "outside":
        possible = [name for name in OUTSIDE if level != "C" or name not in NOT_IN_GATE_RUNS]
        return Case(level, kind, [], size, OUTSIDE[str(rng.choice(possible))](rng, size, level), hull)
    if kind == "confounded":
        names = (str(rng.choice(["thrust_scale", "resistance"])),)
    count = {"clean": 0, "pair": 2}.get(kind, 1)
    while len(names) < count:
        possible = [n for n in EFFECTS if level != "C" or n not in NOT_IN_GATE_RUNS]
        drawn = tuple(str(n) for n in rng.choice(possible, count, replace=False))
        names = () if any(set(drawn) == set(pair) for pair in ONE_PURPOSE) else drawn
    effects = [{"effect": name} | EFFECTS[name](rng, size, level) for name in names]
    return Case(level, kind, effects, size, None, hull)


def mooring(rng: Rng, size: float, level: str) -> dict[str, Any]:
    """A slack line to a point near the start: it pulls with its stretch."""
    return {
        "what": "mooring",
        "length": 4.0,
        "stiffness": 2.0 * size,
        "variables": ["position", "north", "east"],
    }


def sector(rng: Rng, size: float, level: str) -> dict[str, Any]:
    """A push along the hull while the bow is in one half of the compass."""
    angle = float(rng.uniform(-math.pi, math.pi))
    return {"what": "sector", "centre": angle, "force": signed(rng, 5.0, size), "variables": ["heading"]}


def dead_zone(rng: Rng, size: float, level: str) -> dict[str, Any]:
    """Thrusters that do not start below some throttle, and above it push as they should."""
    name = thruster(rng, level)
    return {
        "what": "dead_zone",
        "thruster": name,
        "below": 0.35 + 0.2 * size,
        "variables": [f"throttle_{name}", f"thrust_{name}", "throttle", "thrust"],
    }


OUTSIDE: dict[str, Callable[[Rng, float, str], dict[str, Any]]] = {
    "mooring": mooring,
    "sector": sector,
    "dead_zone": dead_zone,
}


def hook_of(outside: Mapping[str, Any] | None, boat: Boat) -> Hook:
    """What is done to the record (1,) and the arrived command (2K,) before each step, from the state (S,)."""
    if outside is None:
        return lambda params, state, command: None
    if outside["what"] == "mooring":

        def pull(params: NDArray[Any], state: Array, command: Array) -> None:
            distance = math.hypot(state[NORTH], state[EAST])
            force = outside["stiffness"] * max(distance - outside["length"], 0.0) / max(distance, 1e-9)
            params["external_force_north"], params["external_force_east"] = -force * state[[NORTH, EAST]]

        return pull
    if outside["what"] == "sector":

        def push(params: NDArray[Any], state: Array, command: Array) -> None:
            inside = math.cos(state[HEADING] - outside["centre"]) > 0.0
            force = outside["force"] * inside
            params["external_force_north"] = force * math.cos(state[HEADING])
            params["external_force_east"] = force * math.sin(state[HEADING])

        return push

    column = len(boat.thrusters) + boat.thruster_names.index(outside["thruster"])

    def stall(params: NDArray[Any], state: Array, command: Array) -> None:
        if command[column] < outside["below"]:
            command[column] = 0.0

    return stall


@dataclass(frozen=True)
class Voyage:
    """A run as it truly was, T + 1 rows of `DT` or another step.

    track: (T + 1, S) states; commands: (T + 1, 2K) as asked; record: (1,) of the true boat.
    """

    track: Array
    commands: Array
    record: NDArray[Any]


def sail(
    boat: Boat, case: Case, driver: Driver, start: Array, steps: int, before: int = 0, tick: float = DT
) -> Voyage:
    """A run from a start at rest: north, east [m], heading [rad]; before: steps that are not recorded;
    tick [s]: of one step.
    """
    params = true_record(boat, case)
    true, hook = params.copy(), hook_of(case.outside, boat)
    state = initial_state(params, start[None])
    every = before + steps
    asked, arrived = np.zeros((every + 1, 2 * len(boat.thrusters))), np.zeros(2 * len(boat.thrusters))
    track = np.zeros((every + 1, state.shape[1]))
    track[0] = state[0]
    for row in range(every):
        asked[row] = driver(row * tick, state[0])
        delayed_command(asked, row, float(params["command_delay"][0]) / tick, arrived)
        hook(params, state[0], arrived)
        step(state, params, tank(boat), arrived[None], np.zeros(1, np.uint64), tick, round(tick / SUBSTEP))
        track[row + 1] = state[0]
    asked[-1] = asked[-2]
    return Voyage(track[before:], asked[before:], true)


def true_record(boat: Boat, case: Case) -> NDArray[Any]:
    """(1,) parameter record of the boat with what is wrong with it."""
    params = parameters(boat)
    apply_effects(params, parse_effects(case.effects, "truth", boat.thruster_names), boat.thruster_names)
    for name, value in case.hull.items():
        params[name] *= value
    return params


def voyages(case: Case, rng: Rng, runs: int = 5, seconds: float = 80.0) -> list[Voyage]:
    """The runs of a case as they truly were."""
    boat, steps = load_boat("swamp"), round(seconds / DT)
    before = round(STEADY / DT) if case.kind == "confounded" else 0
    return [sail(boat, case, driver, start, steps, before) for driver, start in drivers(case, rng, runs)]


def deviations(level: str) -> Array:
    """(6,) standard deviations of the noise, infinite where a channel is not measured."""
    return PLAIN if level == "B" else RTK


def drivers(case: Case, rng: Rng, runs: int) -> list[tuple[Driver, Array]]:
    """How each run is driven and where it starts: north, east [m], heading [rad]."""
    if case.level == "C":
        return [gate_run(rng) for _ in range(runs)]
    starts = [np.array([*rng.uniform(-5, 5, 2), rng.uniform(-math.pi, math.pi)]) for _ in range(runs)]
    if case.kind == "confounded":  # steady straight running at one throttle shows no difference
        return [(straight(0.7), start) for start in starts]
    order = rng.permutation(len(RICH))
    return [(RICH[order[i % len(RICH)]](rng), start) for i, start in enumerate(starts)]


def write_case(
    case: Case,
    rng: Rng,
    data: Path,
    truth: Path,
    runs: int = 5,
    seconds: float = 80.0,
    velocities: bool = True,
) -> None:
    """Sail the case and write its runs into the folder `data` and what is wrong into the file `truth`."""
    boat, noise = load_boat("swamp"), deviations(case.level)
    data.mkdir(parents=True)
    listed = []
    for number, voyage in enumerate(voyages(case, rng, runs, seconds)):
        measured, kept = measure(voyage, noise, rng)
        columns = table(boat, measured, voyage.commands, velocities and case.level != "B")
        name = f"run_{number}.csv"
        write_table(data / name, {key: values[kept] for key, values in columns.items()})
        listed.append(RunMeta(file=name, rows=int(kept.sum())))
    meta = DatasetMeta(
        vehicle="swamp",
        mass=boat.mass,
        draught=boat.draught,
        water_density=boat.water_density,
        sample_rate=1 / DT,
        source="measured",
        runs=listed,
    )
    write_yaml(data / "dataset.yaml", meta.model_dump(exclude_defaults=True))
    truth.parent.mkdir(parents=True, exist_ok=True)
    truth.write_text(json.dumps(vars(case), indent=1))


def measure(voyage: Voyage, noise: Array, rng: Rng) -> tuple[Array, NDArray[np.bool_]]:
    """(T + 1, 6) channels with noise of those deviations, and (T + 1,) which rows are kept."""
    seen = observe(voyage.track[None], voyage.record, DT)[0]
    measured = add_noise(seen, np.where(np.isfinite(noise), noise, 0.0), rng)
    kept = rng.random(len(measured)) >= DROPPED
    kept[[0, -1]] = True
    return measured, kept


def table(boat: Boat, measured: Array, asked: Array, velocities: bool) -> dict[str, Array]:
    """Columns of a run of `measured` (T, 6) channels under the commands `asked` (T, 2K)."""
    columns = {"time": DT * np.arange(len(measured)), "north": measured[:, 0], "east": measured[:, 1]}
    columns["heading"] = np.pi - np.mod(np.pi - measured[:, 2], 2 * np.pi)
    if velocities:
        columns |= {"surge": measured[:, 3], "sway": measured[:, 4]}
    columns["yaw_rate"] = measured[:, 5]
    names = [f"{kind}_{name}" for kind in ("azimuth", "throttle") for name in boat.thruster_names]
    return columns | dict(zip(names, asked.T, strict=True))

"""Blind cases for model criticism: runs of a boat with something wrong, and apart from them what it was.

A case is drawn from a seed: what is wrong, its sign and size, manoeuvres, noise, dropped samples. The data
go to one folder in the run format, the truth to a file elsewhere, so that who diagnoses sees only the data.
"""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.synthetic.draws import (
    EFFECTS,
    NOT_BESIDE_WEATHER,
    RUNS,
    WEATHER,
    Rng,
    signed,
    thruster,
    weather_by_run,
)
from swamp_rl.experiments.synthetic.drivers import RICH, Array, Driver, gate_run, straight

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import apply_effects, parse_effects
from swamp_rl.files import write_yaml
from swamp_rl.runs import RunMeta
from swamp_rl.runs.schema import Source, meta_of
from swamp_rl.runs.table import write_table
from swamp_rl.simulator import initial_state, parameters, step, tank
from swamp_rl.simulator.delay import delayed_command
from swamp_rl.simulator.sensors import add_noise, observe, rows_ahead
from swamp_rl.simulator.state import EAST, HEADING, NORTH, SURGE

DT = 0.1
SUBSTEP = 0.05  # s
HULL = ("x_vr", "y_v", "y_r", "n_v", "n_r")
HULL_SPREAD = 0.1  # standard deviation of their scales at level D
LEVELS = ("A", "B", "C", "D")
POWER = "P"  # as A, single effects of any size down to nothing
SMALL = (3e-4, 0.1)  # sizes of its effects
EACH_RUN = "E"  # as A, another wind or current in each run, alone or beside one effect
ROUGH = "R"  # as A, sailed by another simulator: `benchmarks.blind.rough_simulator`
TRIPLE = "T"  # as A, three effects
KINDS = ("single", "pair", "triple", "clean", "outside", "confounded")
DEGREE = math.pi / 180
# standard deviations of north, east [m], heading [rad], surge, sway [m/s], yaw rate [rad/s]
RTK = np.array([0.05, 0.05, 0.5 * DEGREE, 0.03, 0.03, 0.3 * DEGREE])
PLAIN = np.array([0.5, 0.5, 1.0 * DEGREE, np.inf, np.inf, 0.6 * DEGREE])
DROPPED = 0.02  # share of the rows that are lost
STEADY = 60.0  # s of straight running before a confounded case is recorded, so that it no longer gathers way

Hook = Callable[[NDArray[Any], Array, Array], None]


@dataclass(frozen=True)
class Case:
    """The truth.

    effects: as a boat file has them; outside: what no library effect is; size: of the effect against a
    typical one; hull: scale of each linear derivative; by_run: effects of each run alone, none where all runs
    are alike.
    """

    level: str
    kind: str
    effects: list[dict[str, Any]]
    size: float = 1.0
    outside: dict[str, Any] | None = None
    hull: dict[str, float] = field(default_factory=dict)
    by_run: list[list[dict[str, Any]]] = field(default_factory=list)

    def of_run(self, run: int) -> "Case":
        """The truth of one run, as that of a case of its own."""
        own = self.by_run[run] if self.by_run else []
        return replace(self, effects=[*self.effects, *own], by_run=[])

    @property
    def names(self) -> list[str]:
        """Of every effect, in order; one that each run has is named once."""
        own = {effect["effect"] for run in self.by_run for effect in run}
        return sorted([*(effect["effect"] for effect in self.effects), *own])


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
    count, by_run = {"clean": 0, "pair": 2, "triple": 3}.get(kind, 1), []
    if level == EACH_RUN:
        weather = str(rng.choice(sorted(WEATHER)))
        by_run, count = weather_by_run(rng, weather, size), count - 1
    while len(names) < count:
        without = {"C": NOT_IN_GATE_RUNS, EACH_RUN: NOT_BESIDE_WEATHER}.get(level, ())
        possible = [name for name in EFFECTS if name not in without]
        drawn = tuple(str(n) for n in rng.choice(possible, count, replace=False))
        names = () if any(set(pair) <= set(drawn) for pair in ONE_PURPOSE) else drawn
    effects = [{"effect": name} | EFFECTS[name](rng, size, level) for name in names]
    return Case(level, kind, effects, size, None, hull, by_run)


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


def drogue(rng: Rng, size: float, level: str) -> dict[str, Any]:
    """Something in tow at midship: a drag against the motion over ground, with the square of its speed."""
    return {"what": "drogue", "coefficient": 10.0 * size, "variables": ["speed", "surge", "sway"]}


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

    if outside["what"] == "drogue":

        def drag(params: NDArray[Any], state: Array, command: Array) -> None:
            ahead, aside = state[SURGE], state[SURGE + 1]
            cos, sin = math.cos(state[HEADING]), math.sin(state[HEADING])
            over_ground = np.array([ahead * cos - aside * sin, ahead * sin + aside * cos])
            force = -outside["coefficient"] * math.hypot(ahead, aside) * over_ground
            params["external_force_north"], params["external_force_east"] = force

        return drag

    column = _throttle_column(outside, boat)

    def stall(params: NDArray[Any], state: Array, command: Array) -> None:
        if command[column] < outside["below"]:
            command[column] = 0.0

    return stall


@dataclass(frozen=True)
class Voyage:
    """A run as it truly was, T + 1 rows of `DT` or another step.

    track: (T + 1, S) states, and more where a receiver's clock is behind; commands: (T + 1, 2K) as asked;
    record: (1,) of the true boat.
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
    after = rows_ahead(params, (before + steps) * tick, tick)
    true, hook, curves = params.copy(), hook_of(case.outside, boat), tank(boat)
    state = initial_state(params, start[None])
    every = before + steps + after
    asked, arrived = np.zeros((every + 1, 2 * len(boat.thrusters))), np.zeros(2 * len(boat.thrusters))
    track = np.zeros((every + 1, state.shape[1]))
    track[0] = state[0]
    for row in range(every):
        asked[row] = driver(row * tick, state[0])
        delayed_command(asked, row, float(params["command_delay"][0]) / tick, arrived)
        hook(params, state[0], arrived)
        step(state, params, curves, arrived[None], np.zeros(1, np.uint64), tick, round(tick / SUBSTEP))
        track[row + 1] = state[0]
    asked[before + steps] = asked[before + steps - 1]
    return Voyage(track[before:], asked[before : before + steps + 1], true)


def acting_share(case: Case, boat: Boat, voyage: Voyage) -> float:
    """Share of a run's rows in which what no library effect is does anything. Of a dead zone, the share in
    which its thruster runs where that is less: one that never runs has failed, which the library has.
    """
    hook, acts, plain = hook_of(case.outside, boat), 0, voyage.record.tobytes()
    for state, command in zip(voyage.track, voyage.commands, strict=False):
        params, arrived = voyage.record.copy(), command.copy()
        hook(params, state, arrived)
        acts += params.tobytes() != plain or bool((arrived != command).any())
    acting = acts / len(voyage.commands)
    if case.outside and case.outside["what"] == "dead_zone":
        throttle = voyage.commands[:, _throttle_column(case.outside, boat)]
        return min(acting, float((throttle >= case.outside["below"]).mean()))
    return acting


def _throttle_column(dead_zone: Mapping[str, Any], boat: Boat) -> int:
    """The column of the commands that a dead zone acts on."""
    return len(boat.thrusters) + boat.thruster_names.index(dead_zone["thruster"])


def true_record(boat: Boat, case: Case) -> NDArray[Any]:
    """(1,) parameter record of the boat with what is wrong with it."""
    params = parameters(boat)
    apply_effects(params, parse_effects(case.effects, "truth", boat.thruster_names), boat.thruster_names)
    for name, value in case.hull.items():
        params[name] *= value
    return params


def voyages(case: Case, rng: Rng, runs: int = RUNS, seconds: float = 80.0) -> list[Voyage]:
    """The runs of a case as they truly were."""
    boat, steps = load_boat("swamp"), round(seconds / DT)
    before = round(STEADY / DT) if case.kind == "confounded" else 0
    driven = enumerate(drivers(case, rng, runs))
    return [sail(boat, case.of_run(run), driver, start, steps, before) for run, (driver, start) in driven]


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
    runs: int = RUNS,
    seconds: float = 80.0,
    velocities: bool = True,
    sailed: Callable[[Case, Rng, int, float], list[Voyage]] | None = None,
) -> None:
    """Sail the case and write its runs into the folder `data` and what is wrong into the file `truth`.

    sailed: another simulator than `voyages`.
    """
    boat, noise = load_boat("swamp"), deviations(case.level)
    tables = []
    for voyage in (sailed or voyages)(case, rng, runs, seconds):
        measured, kept = measure(voyage, noise, rng)
        columns = table(boat, measured, voyage.commands, velocities and case.level != "B")
        tables.append({key: values[kept] for key, values in columns.items()})
    data.mkdir(parents=True)
    write_runs(data, "swamp", boat, tables, "measured", "csv")
    truth.parent.mkdir(parents=True, exist_ok=True)
    truth.write_text(json.dumps(vars(case), indent=1))


def write_runs(
    data: Path,
    vehicle: str,
    boat: Boat,
    tables: list[dict[str, NDArray[Any]]],
    source: Source,
    suffix: str,
    rate: float = 1 / DT,
) -> None:
    """A file of that suffix for each run into the folder `data`, and the `dataset.yaml` of them all.

    rate: rows a second.
    """
    listed = []
    for number, columns in enumerate(tables):
        name = f"run_{number}.{suffix}"
        write_table(data / name, columns)
        listed.append(RunMeta(file=name, rows=len(columns["time"])))
    meta = meta_of(boat, vehicle, rate, source, runs=listed)
    write_yaml(data / "dataset.yaml", meta.model_dump(exclude_defaults=True))


def measure(voyage: Voyage, noise: Array, rng: Rng) -> tuple[Array, NDArray[np.bool_]]:
    """(T + 1, 6) channels with noise of those deviations, and (T + 1,) which rows are kept."""
    seen = observe(voyage.track[None], voyage.record, DT)[0, : len(voyage.commands)]
    measured = add_noise(seen, np.where(np.isfinite(noise), noise, 0.0), rng)
    kept = rng.random(len(measured)) >= DROPPED
    kept[[0, -1]] = True
    return measured, kept


def table(boat: Boat, measured: Array, asked: Array, velocities: bool) -> dict[str, Array]:
    """Columns of a run of `measured` (T, 6) channels under the commands `asked` (T, 2K)."""
    columns = {"time": DT * np.arange(len(measured)), "north": measured[:, 0], "east": measured[:, 1]}
    columns["heading"] = wrapped(measured[:, 2])
    if velocities:
        columns |= {"surge": measured[:, 3], "sway": measured[:, 4]}
    columns["yaw_rate"] = measured[:, 5]
    names = [thruster.command_columns[kind] for kind in (0, 1) for thruster in boat.thrusters]
    return columns | {name: values for name, values in zip(names, asked.T, strict=True) if name}

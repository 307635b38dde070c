"""Blind cases of another kind (level X), to detect overfitting of the method to the other levels.

Other boats, two to twelve runs of half a minute to five at 2 to 20 Hz, other manoeuvres, some with thrusters
that hardly run, commands that change between two rows, Gauss-Markov position noise, outliers, gaps,
velocities measured or not.
"""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.synthetic.cases import (
    DEGREE,
    Array,
    Case,
    Voyage,
    acting_share,
    draw_case,
    mooring,
    sail,
    sector,
    write_runs,
)
from swamp_rl.experiments.synthetic.draws import Rng, polar, scale, signed
from swamp_rl.experiments.synthetic.drivers import Driver

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat, PropellerRudder, load_boat
from swamp_rl.criticism.data.run_set import CHANNELS
from swamp_rl.simulator.sensors import observe

VARIANT = "X"
KINDS = ("single",) * 6 + ("pair", "pair", "clean", "clean", "outside")
TICK = 0.05  # s, of commands and of the truth
MOST = 3000  # rows of all runs, but for two that there always are
LEAST_ACTING = 0.1  # share of the time of all runs in which a force outside the library acts
LEAST_SHOWN = 0.01  # standard deviations of the white noise by which an effect moves a recorded channel
POSE = 3  # channels that every case records: north, east, heading

# What may be wrong with the model ship; forces against its own, which weigh four times SWAMP's
SHIP: dict[str, Callable[[Rng, float], dict[str, Any]]] = {
    "current": lambda g, s: polar(g, 0.08 * s),
    "wind": lambda g, s: {"speed": 3.0 * s, "from": float(g.uniform(-math.pi, math.pi))},
    "external_force": lambda g, s: polar(g, 1.0 * s),
    "thrust_scale": lambda g, s: {"scale": scale(g, 0.2, s)},
    "command_delay": lambda g, s: {"delay": min(0.8 * s, 2.0)},
    "thrust_sag": lambda g, s: {"rate": 0.002 * s},
    "resistance": lambda g, s: {"scale": scale(g, 0.35, s)},
    "linear_drag": lambda g, s: {"coefficient": 2.0 * s},
    "mass": lambda g, s: {"mass": 244.6 * scale(g, 0.2, s)},
    "sway_drag": lambda g, s: {"scale": scale(g, 0.4, s)},
    "yaw_inertia": lambda g, s: {"scale": scale(g, 0.4, s)},
    "yaw_damping": lambda g, s: {"scale": scale(g, 0.4, s)},
    "hull_asymmetry": lambda g, s: {"yaw_moment": signed(g, 2.0, s)},
    "heading_bias": lambda g, s: {"bias": signed(g, 0.1, s)},
    "position_delay": lambda g, s: {"delay": 0.6 * s},
    "position_lever_arm": lambda g, s: {"x": signed(g, 0.4, s), "y": signed(g, 0.2, s)},
}


@dataclass(frozen=True)
class Instruments:
    """rate: rows a second; white: (6,) standard deviations; wander: standard deviation of the Gauss-Markov
    position noise [m], `memory` its time constant [s]; outliers, lost: shares of rows; stretches: gaps of
    each run; between: whether commands also change between two rows.
    """

    rate: float
    white: Array
    wander: float
    memory: float
    outliers: float
    lost: float
    stretches: int
    channels: tuple[str, ...]
    between: bool


def draw_instruments(rng: Rng) -> Instruments:
    """Instruments from survey grade to a telephone's."""
    worse = float(np.exp(rng.uniform(0.0, math.log(8.0))))
    white = np.array([0.05 * worse, 0.05 * worse, 0.5 * DEGREE * worse**0.5, 0.03, 0.03, 0.3 * DEGREE])
    channels: tuple[str, ...] = ("surge", "sway", "yaw_rate") if rng.random() < 0.5 else ("yaw_rate",)
    if rng.random() < 0.2:
        channels = ()
    return Instruments(
        rate=float(rng.choice([2.0, 5.0, 10.0, 20.0])),
        white=white,
        wander=float(rng.choice([0.0, 0.0, 0.1, 0.5])),
        memory=float(rng.uniform(20.0, 120.0)),
        outliers=float(rng.choice([0.0, 0.0, 0.003])),
        lost=float(rng.choice([0.0, 0.02, 0.05])),
        stretches=int(rng.choice([0, 0, 2])),
        channels=channels,
        between=bool(rng.random() < 0.4),
    )


def write_variant(rng: Rng, data: Path, truth: Path) -> None:
    """Simulate a case of level X; write its runs into the folder `data`, its causes into the file `truth`.

    A case outside the library that hardly acts is drawn again, and one with an effect that no recorded
    channel shows, as an exchange of two thrusters whose commands are equal.
    """
    name = str(rng.choice(["swamp", "swamp-light", "esso_osaka"], p=[0.4, 0.35, 0.25]))
    boat, instruments = load_boat(name), draw_instruments(rng)
    case = draw_variant(rng, boat)
    runs = int(rng.integers(2, 13))
    lengths = rng.uniform(100.0 if is_ship(boat) else 30.0, 300.0, runs)
    lengths = lengths[: max(2, int((np.cumsum(lengths) * instruments.rate <= MOST).sum()))]
    tables = []
    acting, shown = 0.0, np.zeros(len(case.effects), dtype=bool)
    for length in lengths:
        start = np.array([*rng.uniform(-5, 5, 2), rng.uniform(-math.pi, math.pi)])
        driver = driver_of(boat, rng)
        driver = driver if instruments.between else held(driver, 1.0 / instruments.rate)
        voyage = sail(boat, case, driver, start, round(length / TICK), tick=TICK)
        acting += length * acting_share(case, boat, voyage)
        if not shown.all():
            shown |= effects_shown(case, boat, voyage, instruments)
        tables.append(rows_of(boat, voyage, instruments, rng))
    if not shown.all() or (case.outside and acting < LEAST_ACTING * lengths.sum()):
        write_variant(rng, data, truth)
        return
    data.mkdir(parents=True)
    write_runs(data, name, boat, tables, "measured", "csv", instruments.rate)
    truth.parent.mkdir(parents=True, exist_ok=True)
    entries = vars(instruments) | {"white": instruments.white.tolist()}
    truth.write_text(json.dumps(vars(case) | {"boat": name, "instruments": entries}, indent=1))


def effects_shown(case: Case, boat: Boat, voyage: Voyage, instruments: Instruments) -> NDArray[np.bool_]:
    """(E,) whether a recorded channel would differ by `LEAST_SHOWN` without each effect of a case."""
    recorded = [i for i, name in enumerate(CHANNELS) if i < POSE or name in instruments.channels]
    least = LEAST_SHOWN * instruments.white[recorded]

    def again(time: float, state: Array) -> Array:
        return voyage.commands[min(round(time / TICK), len(voyage.commands) - 1)]

    found = np.zeros(len(case.effects), dtype=bool)
    for i, effect in enumerate(case.effects):
        less = replace(case, effects=[one for one in case.effects if one is not effect])
        steps = len(voyage.commands) - 1
        without = sail(boat, less, again, voyage.track[0, :3], steps, tick=TICK)
        moved = (measured_at(voyage) - measured_at(without))[:, recorded]
        found[i] = (np.abs(moved) > least).any()
    return found


def measured_at(voyage: Voyage, every: int = 1) -> Array:
    """(T, 6) CHANNELS of every so many commands' rows, as instruments without errors measure them."""
    return observe(voyage.track[None], voyage.record, TICK)[0, : len(voyage.commands) : every]


def is_ship(boat: Boat) -> bool:
    """Whether it has a propeller with a rudder."""
    return isinstance(boat.thrusters[0], PropellerRudder)


def draw_variant(rng: Rng, boat: Boat) -> Case:
    """The causes; as at level A, except those that a boat cannot have."""
    kind, size = str(rng.choice(KINDS)), float(rng.uniform(0.5, 2.0))
    if kind == "outside" and is_ship(boat):
        pull = (mooring if rng.random() < 0.5 else sector)(rng, 0.3 * size, VARIANT)
        return Case(VARIANT, kind, [], size, pull)
    if not is_ship(boat):
        case = draw_case(rng, VARIANT, kind, size=size)
        for effect in case.effects:
            if effect["effect"] == "mass":
                effect["mass"] *= boat.mass / 58.0
        return case
    count = {"clean": 0, "pair": 2}.get(kind, 1)
    names = [str(name) for name in rng.choice(sorted(SHIP), count, replace=False)]
    return Case(VARIANT, kind, [{"effect": name} | SHIP[name](rng, size) for name in names], size)


def driver_of(boat: Boat, rng: Rng) -> Driver:
    """A manoeuvre: random commands, zig-zags, spirals, station keeping."""
    ways = (
        (random_walk, zig_zag, spiral) if is_ship(boat) else (random_walk, zig_zag, spiral, station_keeping)
    )
    drive = ways[int(rng.integers(len(ways)))](rng)
    bow_only = rng.random() < 0.3
    if is_ship(boat):
        return lambda time, state: ship_command(boat, drive(time, state))

    def jets(time: float, state: Array) -> Array:
        throttle, angle, stern = drive(time, state)
        behind = 0.0 if bow_only else throttle
        return np.array([angle, angle, stern, stern, throttle, throttle, behind, behind])

    return jets


def held(driver: Driver, period: float) -> Driver:
    """The driver's commands, each held for a period [s]."""
    last: list[tuple[int, Array]] = []

    def drive(time: float, state: Array) -> Array:
        row = math.floor(time / period + 1e-6)
        if not last or last[0][0] != row:
            last[:] = [(row, driver(time, state))]
        return last[0][1]

    return drive


def ship_command(boat: Boat, action: tuple[float, float, float]) -> Array:
    """Rudder [rad] and revolutions [rps] from throttle and angle; the rudder within its limit."""
    throttle, angle, _ = action
    ship = boat.thrusters[0]
    assert isinstance(ship, PropellerRudder)
    return np.array([np.clip(0.5 * angle, -ship.rudder_max, ship.rudder_max), 14.0 * (0.3 + 0.7 * throttle)])


Actions = Callable[[float, Array], tuple[float, float, float]]


def random_walk(rng: Rng) -> Actions:
    """Random throttle and angles, now and then zero."""
    knots = np.arange(0.0, 320.0, float(rng.uniform(1.0, 5.0)))
    throttle = np.clip(0.55 + np.cumsum(rng.normal(0.0, 0.15, len(knots))) % 1.0 - 0.5, 0.0, 1.0)
    throttle *= rng.random(len(knots)) > 0.1
    angle, stern = (np.clip(rng.normal(0.0, 0.5, len(knots)), -1.5, 1.5) for _ in range(2))
    return lambda time, state: tuple(np.interp(time, knots, one) for one in (throttle, angle, stern))  # type: ignore[return-value]


def zig_zag(rng: Rng) -> Actions:
    """Zig-zags of a random period, the throttle changed now and then."""
    period, angle, phase = rng.uniform(6.0, 40.0), rng.uniform(0.2, 0.9), rng.uniform(0.0, 1.0)
    throttles = rng.uniform(0.2, 1.0, 20)

    def action(time: float, state: Array) -> tuple[float, float, float]:
        over = angle if (time / period + phase) % 1.0 < 0.5 else -angle
        return float(throttles[int(time // 20.0)]), over, -over

    return action


def spiral(rng: Rng) -> Actions:
    """The angle goes slowly from one side to the other and back."""
    period, most, throttle = rng.uniform(60.0, 160.0), rng.uniform(0.4, 1.2), rng.uniform(0.3, 1.0)

    def action(time: float, state: Array) -> tuple[float, float, float]:
        over = most * math.sin(2.0 * math.pi * time / period)
        return float(throttle), over, -over

    return action


def station_keeping(rng: Rng) -> Actions:
    """Station keeping: short pushes towards one place, azimuths over the full turn."""
    centre, gain = rng.uniform(-3.0, 3.0, 2), rng.uniform(0.1, 0.3)

    def action(time: float, state: Array) -> tuple[float, float, float]:
        north, east = centre - state[:2]
        bearing = wrapped(math.atan2(east, north) - state[2])
        push = min(gain * math.hypot(north, east), 1.0) * (time % 6.0 < 4.0)
        return push, bearing, bearing

    return action


def rows_of(boat: Boat, voyage: Voyage, instruments: Instruments, rng: Rng) -> dict[str, Array]:
    """The columns of a run as its instruments measure them."""
    every = round(1.0 / (instruments.rate * TICK))
    measured = measured_at(voyage, every)
    rows = len(measured)
    measured += instruments.white * rng.standard_normal(measured.shape)
    measured[:, :2] += position_noise(rng, rows, instruments)
    far = rng.random((rows, 3)) < instruments.outliers
    measured[:, :3] += far * rng.normal(0.0, 1.0, (rows, 3)) * [4.0, 4.0, 0.7]
    kept = rng.random(rows) >= instruments.lost
    for _ in range(instruments.stretches):
        first, length = int(rng.integers(1, rows)), int(instruments.rate * rng.uniform(1.0, 5.0))
        kept[first : first + length] = False
    kept[[0, -1]] = True
    columns = {"time": TICK * every * np.arange(rows), "north": measured[:, 0], "east": measured[:, 1]}
    columns["heading"] = wrapped(measured[:, 2])
    for index, name in enumerate(CHANNELS[POSE:], POSE):
        if name in instruments.channels:
            columns[name] = measured[:, index]
    columns |= commands_of(boat, voyage.commands[::every])
    return {name: values[kept] for name, values in columns.items()}


def commands_of(boat: Boat, commands: NDArray[np.float64]) -> dict[str, Array]:
    """Columns of commands (T, 2K), each at the instant of its row."""
    found = {}
    for k, thruster in enumerate(boat.thrusters):
        angle, level = thruster.command_columns
        if angle:
            found[angle] = commands[:, k]
        found[level] = commands[:, len(boat.thrusters) + k]
    return found


def position_noise(rng: Rng, rows: int, instruments: Instruments) -> Array:
    """(rows, 2) Gauss-Markov position noise."""
    keep = math.exp(-1.0 / (instruments.rate * instruments.memory))
    found = np.zeros((rows, 2))
    found[0] = rng.standard_normal(2)
    for row in range(1, rows):
        found[row] = keep * found[row - 1] + math.sqrt(1.0 - keep * keep) * rng.standard_normal(2)
    return instruments.wander * found

"""Sound runs with sensor noise, and the faults that are seeded in them."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.experiments.synthetic.cases import PLAIN, RTK

from swamp_rl.angles import turned, wrapped
from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import boat_file
from swamp_rl.constants import KNOT, SWAMP_LENGTH
from swamp_rl.files import write_yaml
from swamp_rl.pilots.record import record_scripted
from swamp_rl.runs import Run, read_dataset
from swamp_rl.simulator.replay import replay

Array = NDArray[np.float64]
Columns = dict[str, Array]
Rng = np.random.Generator

BOATS = {"swamp": (1.0, 8, "standard"), "swamp-light": (1.0, 8, "standard"), "esso_osaka": (4.0, 2, None)}
"""Scale of the course, runs of one dataset (some 200 s for SWAMP, 400 s for the ship), disturbances."""
CHANNELS = ("north", "east", "heading", "surge", "sway", "yaw_rate")
NOISES = {"RTK": RTK, "plain GPS": PLAIN}
SHIP = math.sqrt(3.0 / SWAMP_LENGTH)
"""Time of the ship model relative to SWAMP's by Froude's law, from their lengths [m]."""
SECONDS = 60.0  # of a run under commands that wander
WANDER, MEMORY = 1.0, 60.0
"""m and s of the Gauss-Markov error of a plain receiver's position, beside its white noise."""


def sound_runs(boat: str, count: int, seed: int, folder: Path) -> list[Run]:
    """Noise-free runs of the scripted driver, who is neither quick nor clean."""
    course = folder / "course.yaml"
    course.write_text(f"extends: camogli\nscale: {BOATS[boat][0]}\n")

    def boats(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
        return GatesVectorEnv(
            n, boat=boat, course=str(course), disturbances=BOATS[boat][2], observation=senses
        )

    made = folder / boat
    record_scripted(
        boats, made, boat=boat, course=str(course), count=count, failed=0, seed=seed, skills=["novice"]
    )
    return read_dataset(made).runs


def twin_boat(folder: Path) -> Boat:
    """Two fixed thrusters that reverse."""
    path = folder / "twin.yaml"
    write_yaml(path, boat_file("twin", "twin-fixed", 1.2, 0.8, 30.0, 60.0))
    return load_boat(path)


def smooth_runs(boat: Boat, count: int, seed: int) -> list[Run]:
    """Noise-free runs: each throttle and azimuth a Gauss-Markov process of its own."""
    rng, step = np.random.default_rng(seed), 0.1
    time = np.arange(round(SECONDS / step) + 1) * step
    runs = []
    for number in range(count):
        columns = {"time": time} | {name: np.zeros(len(time)) for name in CHANNELS}
        for thruster in boat.thrusters:
            angle, level = wander(time, rng, 0.5, 4.0), wander(time, rng, 0.25, 4.0)
            if thruster.command_columns[0] is not None:
                columns[f"azimuth_{thruster.name}"] = angle
            columns[f"throttle_{thruster.name}"] = np.clip(0.6 + level, thruster.throttle_min, 1.0)
        runs.append(replay(boat, Run(f"smooth-{number}", columns)))
    return runs


def steered_runs(boat: Boat, count: int, seed: int) -> list[Run]:
    """Noise-free runs: throttles of both sides whose difference is a sine of 5 to 15 s, of equal sum."""
    rng, step = np.random.default_rng(seed), 0.1
    time = np.arange(round(SECONDS / step) + 1) * step
    runs = []
    for number in range(count):
        apart = 0.2 * np.sin(2.0 * np.pi * time / rng.uniform(5.0, 15.0) + rng.uniform(0.0, 2.0 * np.pi))
        columns = {"time": time} | {name: np.zeros(len(time)) for name in CHANNELS}
        columns |= {"throttle_port": 0.5 + apart, "throttle_starboard": 0.5 - apart}
        runs.append(replay(boat, Run(f"steered-{number}", columns)))
    return runs


def measured(run: Run, noise: str, rng: Rng) -> Run:
    """The run as sensors measured it; without velocities where the noise has none."""
    columns = {name: values for name, values in run.columns.items() if not name.startswith("applied_")}
    for name, deviation in zip(CHANNELS, NOISES[noise], strict=True):
        if math.isinf(deviation):
            columns.pop(name, None)
            continue
        columns[name] = columns[name] + deviation * rng.standard_normal(len(run.time))
    if noise == "plain GPS":
        for name in ("north", "east"):
            columns[name] = columns[name] + wander(run.time, rng, WANDER, MEMORY)
    columns["heading"] = wrapped(columns["heading"])
    return Run(run.name, columns)


def wander(time: Array, rng: Rng, deviation: float, memory: float) -> Array:
    """A Gauss-Markov process (T,) of that standard deviation and time constant [s]."""
    keep = math.exp(-float(np.median(np.diff(time))) / memory)
    found = np.empty(len(time))
    found[0] = deviation * rng.standard_normal()
    for i, kick in enumerate(rng.standard_normal(len(time) - 1), 1):
        found[i] = keep * found[i - 1] + deviation * math.sqrt(1.0 - keep * keep) * kick
    return found


@dataclass(frozen=True)
class Seed:
    """A fault: what it does to the columns of a run, the codes by which it may be found, and whether it makes
    a difference to the runs of a dataset."""

    name: str
    codes: tuple[str, ...]
    change: Callable[[Columns, Rng], Columns]
    differs: Callable[[list[Run]], bool] = lambda runs: True


def has(*names: str) -> Callable[[list[Run]], bool]:
    """Whether the runs have columns that begin so."""
    return lambda runs: all(any(c.startswith(n) for c in runs[0].columns) for n in names)


def times(prefix: str, factor: float) -> Callable[[Columns, Rng], Columns]:
    """Columns that begin so, times a factor."""
    return lambda columns, rng: {n: v * factor if n.startswith(prefix) else v for n, v in columns.items()}


def exchanged(columns: Columns, pairs: list[tuple[str, str]]) -> Columns:
    """Columns whose names hold one or the other, exchanged."""
    found = dict(columns)
    for one, other in pairs:
        for kind in ("azimuth_", "throttle_"):
            if kind + one in columns:
                found[kind + one], found[kind + other] = columns[kind + other], columns[kind + one]
    return found


def heading(change: Callable[[Array], Array]) -> Callable[[Columns, Rng], Columns]:
    """Another heading."""
    return lambda columns, rng: {**columns, "heading": wrapped(change(columns["heading"]))}


def stuck(*names: str) -> Callable[[Columns, Rng], Columns]:
    """A quarter of the run at one value, from the middle on."""

    def change(columns: Columns, rng: Rng) -> Columns:
        rows = len(columns["time"])
        first, count = rows // 2, rows // 4
        return columns | {
            name: np.concatenate([v[:first], np.full(count, v[first]), v[first + count :]])
            for name in names
            if (v := columns.get(name)) is not None
        }

    return change


def smoothed(*names: str) -> Callable[[Columns, Rng], Columns]:
    """A first-order filter of 0.5 s."""

    def change(columns: Columns, rng: Rng) -> Columns:
        found = dict(columns)
        share = 1.0 - math.exp(-float(np.median(np.diff(columns["time"]))) / 0.5)
        for name in names:
            values = np.unwrap(columns[name]) if name == "heading" else columns[name]
            now, kept = float(values[0]), []
            for value in values.tolist():
                now += share * (value - now)
                kept.append(now)
            found[name] = wrapped(np.array(kept)) if name == "heading" else np.array(kept)
        return found

    return change


def is_command(name: str) -> bool:
    """Of a thruster or the joypad."""
    return name.startswith(("azimuth_", "throttle_", "rudder_", "propeller_", "joy_"))


def shifted(seconds: float) -> Callable[[Columns, Rng], Columns]:
    """Commands logged so much before (negative) or after the motion that they cause; longer for the ship."""

    def change(columns: Columns, rng: Rng) -> Columns:
        longer = SHIP if "rudder_main" in columns else 1.0
        rows = round(longer * abs(seconds) / float(np.median(np.diff(columns["time"]))))
        early, late = slice(None, -rows), slice(rows, None)
        mine, theirs = (late, early) if seconds > 0.0 else (early, late)
        found = {n: v[mine] if is_command(n) else v[theirs] for n, v in columns.items()}
        return found | {"time": columns["time"][:-rows]}

    return change


def frozen(columns: Columns, rng: Rng) -> Columns:
    """Commands that never vary."""
    return {n: np.full(len(v), 0.4) if is_command(n) else v for n, v in columns.items()}


def rows_lost(columns: Columns, rng: Rng) -> Columns:
    """Two seconds of rows."""
    first = len(columns["time"]) // 3
    kept = np.r_[:first, first + 20 : len(columns["time"])]
    return {n: v[kept] for n, v in columns.items()}


def repeated(columns: Columns, rng: Rng) -> Columns:
    """A time that comes twice."""
    time = columns["time"].copy()
    time[50] = time[49]
    return columns | {"time": time}


def varied(runs: list[Run]) -> bool:
    """Whether throttles take many values."""
    return all(len(np.unique(run.columns.get("throttle_bs", np.zeros(1)))) > 100 for run in runs)


def clipped(columns: Columns, rng: Rng) -> Columns:
    """Throttles cut off at 0.7."""
    return {n: np.minimum(v, 0.7) if n.startswith("throttle_") else v for n, v in columns.items()}


def wired_wrongly(columns: Columns, rng: Rng) -> Columns:
    """Throttles of twin thrusters exchanged, and that of port with the opposite sign."""
    return times("throttle_port", -1.0)(exchanged(columns, [("port", "starboard")]), rng)


def speed_as_surge(columns: Columns, rng: Rng) -> Columns:
    """The magnitude of the velocity in place of its component along the heading."""
    return columns | {"surge": np.hypot(columns["surge"], columns["sway"])}


def drifting(runs: list[Run]) -> bool:
    """Whether speed and surge are known and differ by more than the noise of surge."""
    if not has("surge", "sway")(runs):
        return False
    both = [(np.hypot(run.columns["surge"], run.columns["sway"]), run.columns["surge"]) for run in runs]
    difference = np.concatenate([speed - surge for speed, surge in both])
    return float(np.sqrt(np.mean(difference**2))) > RTK[3]


def quaternion_misread(columns: Columns, rng: Rng) -> Columns:
    """The heading of a quaternion whose w, x, y, z are taken for x, y, z, w; the boat rolls."""
    half, roll = 0.5 * columns["heading"], 0.02 * rng.standard_normal(len(columns["time"]))
    w, x, y, z = np.cos(half), roll * np.cos(half), roll * np.sin(half), np.sin(half)
    return columns | {"heading": np.arctan2(2.0 * (z * y + w * x), 1.0 - 2.0 * (x**2 + y**2))}


def velocity_exchanged(columns: Columns, rng: Rng) -> Columns:
    """Surge and sway of a velocity whose north and east are exchanged."""
    north, east = turned(columns["surge"], columns["sway"], columns["heading"])
    surge, sway = turned(east, north, -columns["heading"])
    return columns | {"surge": surge, "sway": sway}


PORT_AND_STARBOARD = [("bs", "bp"), ("ss", "sp")]
BOW_AND_STERN = [("bs", "ss"), ("bp", "sp")]
HEADING = ("heading_flipped", "heading_offset", "heading_enu", "axes_exchanged")
UNRELATED = ("heading_unrelated",)
COMMANDS = ("commands_exchanged", "angles_flipped", "levels_flipped")
SEEDS = [
    Seed("heading counterclockwise", HEADING, heading(lambda psi: -psi)),
    Seed("heading of an ENU frame", HEADING, heading(lambda psi: 0.5 * math.pi - psi)),
    Seed("heading from east, clockwise", HEADING, heading(lambda psi: psi - 0.5 * math.pi)),
    Seed("heading of the stern", HEADING, heading(lambda psi: psi + math.pi)),
    Seed("north and east exchanged", HEADING, lambda c, rng: {**c, "north": c["east"], "east": c["north"]}),
    Seed("heading of a misread quaternion", UNRELATED, quaternion_misread),
    Seed("heading by sine and cosine of degrees", (*UNRELATED, "unit"), heading(np.degrees)),
    Seed("velocity of exchanged north and east", ("velocity_disagrees",), velocity_exchanged, has("surge")),
    Seed("yaw rate counterclockwise", ("yaw_rate_flipped",), times("yaw_rate", -1.0)),
    Seed("yaw rate in degrees a second", ("unit",), times("yaw_rate", 180.0 / math.pi)),
    Seed("surge in knots", ("unit",), times("surge", 1.0 / KNOT), has("surge")),
    Seed("surge in km/h", ("unit",), times("surge", 3.6), has("surge")),
    Seed("speed over ground as surge", ("surge_is_speed",), speed_as_surge, drifting),
    Seed("throttles in percent", ("unit",), times("throttle_", 100.0), has("throttle_")),
    Seed("azimuths in degrees", ("unit",), times("azimuth_", 180.0 / math.pi), has("azimuth_")),
    Seed("rudder in degrees", ("unit",), times("rudder_", 180.0 / math.pi), has("rudder_")),
    Seed("heading stuck", ("stuck",), stuck("heading")),
    Seed("position stuck", ("stuck",), stuck("north", "east")),
    Seed("yaw rate stuck", ("stuck",), stuck("yaw_rate")),
    Seed("position smoothed", ("filtered",), smoothed("north", "east")),
    Seed("heading smoothed", ("filtered",), smoothed("heading")),
    Seed("rows lost", ("time_jump",), rows_lost),
    Seed("a time twice", ("time_repeated",), repeated),
    Seed("motion 1.5 s after the commands", ("latency",), shifted(-1.5)),
    Seed("motion 1.5 s before the commands", ("latency",), shifted(1.5)),
    Seed("commands constant", ("commands_constant",), frozen),
    Seed("bow and stern exchanged", COMMANDS, lambda c, rng: exchanged(c, BOW_AND_STERN), has("azimuth_")),
    Seed("port and starboard exchanged", COMMANDS, lambda c, rng: exchanged(c, PORT_AND_STARBOARD), varied),
    Seed("port throttle flipped", COMMANDS, times("throttle_port", -1.0), has("throttle_port")),
    Seed("port and starboard exchanged, port flipped", COMMANDS, wired_wrongly, has("throttle_port")),
    Seed("throttles cut off", ("command_clipped",), clipped, varied),
    Seed("azimuths flipped", COMMANDS, times("azimuth_", -1.0), has("azimuth_")),
    Seed("rudder flipped", COMMANDS, times("rudder_", -1.0), has("rudder_")),
]

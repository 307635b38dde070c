"""The published figures of SWAMP's sea trials, the runs they come from, and the fit of a model to them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.candidates import Atom, Hypothesis
from swamp_rl.physics.resistance import resistance_of_tank, towing
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.state import EAST, HEADING, SURGE, SWAY, YAW_RATE

Array = NDArray[np.float64]
Record = NDArray[Any]

DT = 0.1  # s
RUN_UP = 2.0  # s from rest, straight ahead, before the azimuths are turned
SETTLED = 20.0  # s at a run's end that a steady figure is the mean of


@dataclass(frozen=True)
class Run:
    """bow, stern: azimuths [degrees]; throttles: of bs, bp, ss, sp [1]; seconds after the run-up; stops: how
    many of them, at the end, with the thrusters off.
    """

    bow: float
    stern: float
    throttles: tuple[float, float, float, float]
    seconds: float = 80.0
    stops: float = 0.0


@dataclass(frozen=True)
class Figure:
    """What a trial tells. what: a key of READ; value, error: as published, one standard deviation; said: the
    source's words.
    """

    name: str
    run: Run
    what: str
    value: float
    error: float
    said: str = ""


@dataclass(frozen=True)
class Model:
    """A departure from the boat file. apply: the record (1,) of a boat with numbers x (p,); start, low, high:
    (p,) where a fit begins and its bounds; prior: (p,) precision about `start`.
    """

    name: str
    numbers: tuple[str, ...]
    start: Array
    low: Array
    high: Array
    apply: Callable[[Boat, Array], Record]
    prior: Array


@dataclass(frozen=True)
class Fitted:
    """A model at its best: x (p,), chi2 with its prior."""

    model: Model
    x: Array
    chi2: float


def sailed(boat: Boat, record: Record, run: Run) -> Array:
    """(T + 1, S) states of the run after its run-up, begun at the origin and heading north."""
    up, driven, adrift = (round(s / DT) for s in (RUN_UP, run.seconds - run.stops, run.stops))
    ahead = np.concatenate([np.zeros(4), run.throttles])
    turned = np.concatenate([np.radians([run.bow, run.bow, run.stern, run.stern]), run.throttles])
    start = initial_state(record, np.zeros((1, 3)))
    seeds = np.zeros(1, np.uint64)
    state = simulate(record, tank(boat), start, np.tile(ahead, (1, up, 1)), seeds, DT, 1)[0, -1:].copy()
    state[:, : HEADING + 1] = 0.0
    off = np.concatenate([turned[:4], np.zeros(4)])
    rows = np.concatenate([np.tile(turned, (driven, 1)), np.tile(off, (adrift, 1))])
    return simulate(record, tank(boat), state, rows[None], seeds, DT, 1)[0]


def speed(track: Array, boat: Boat, record: Record, run: Run) -> float:
    """Steady speed [m/s]."""
    last = track[-round(SETTLED / DT) :]
    return float(np.hypot(last[:, SURGE], last[:, SWAY]).mean())


def speed_at_end(track: Array, boat: Boat, record: Record, run: Run) -> float:
    """Speed at the very end [m/s]."""
    return float(np.hypot(track[-1, SURGE], track[-1, SWAY]))


def tactical_diameter(track: Array, boat: Boat, record: Record, run: Run) -> float:
    """Way across the first course when the heading has changed by half a turn [m]; 50 where it never does."""
    turned = np.abs(track[:, HEADING])
    if turned[-1] < math.pi:
        return 50.0
    i = int(np.argmax(turned >= math.pi))
    share = (math.pi - turned[i - 1]) / (turned[i] - turned[i - 1])
    return float(abs(track[i - 1, EAST] + share * (track[i, EAST] - track[i - 1, EAST])))


def steady_diameter(track: Array, boat: Boat, record: Record, run: Run) -> float:
    """Of the circle that the boat ends up on [m], at most 50."""
    rate = math.radians(yaw_rate(track, boat, record, run))
    return 2.0 * speed(track, boat, record, run) / max(rate, 1e-9) if rate > 0.01 else 50.0


def yaw_rate(track: Array, boat: Boat, record: Record, run: Run) -> float:
    """Steady yaw rate [degrees/s]."""
    return float(np.degrees(np.abs(track[-round(SETTLED / DT) :, YAW_RATE].mean())))


def apparent_factor(track: Array, boat: Boat, record: Record, run: Run) -> float:
    """(1 - t) as the thesis got it (7.3): the tank's resistance at the speed reached, over bollard pull."""
    nominal = parameters(boat)
    ahead = speed(track, boat, record, run)
    drag = -resistance_of_tank(ahead, 0.0, nominal[0], tank(boat), towing(nominal[0], tank(boat)))
    pull = sum(boat.thrusters[k].thrust_quadratic * run.throttles[k] ** 2 for k in range(4))
    return drag / pull


def bollard_pull(track: Array, boat: Boat, record: Record, run: Run) -> float:
    """Pull [N] on a line that holds the boat back, from its acceleration from rest."""
    start = initial_state(record, np.zeros((1, 3)))
    start[0, -8:] = [0, 0, 0, 0, *run.throttles]
    command = np.tile(np.concatenate([np.zeros(4), run.throttles]), (1, 1, 1))
    short = 1e-3
    gained = simulate(record, tank(boat), start, command, np.zeros(1, np.uint64), short, 1)[0, -1, SURGE]
    return float(gained / short * (record["mass"][0] - record["added_mass_surge"][0]))


READ: Mapping[str, tuple[str, Callable[[Array, Boat, Record, Run], float]]] = {
    "speed": ("m/s", speed),
    "speed at the end": ("m/s", speed_at_end),
    "tactical diameter": ("m", tactical_diameter),
    "steady diameter": ("m", steady_diameter),
    "yaw rate": ("degrees/s", yaw_rate),
    "(1 - t)": ("1", apparent_factor),
    "pull": ("N", bollard_pull),
}

ALL60 = (0.6,) * 4
STRAIGHT = {p: Run(0, 0, (p,) * 4, 120.0) for p in (0.3, 0.6, 1.0)}
CIRCLE = {angle: Run(angle, -angle, ALL60) for angle in (30, 60)}
PUBLISHED = (
    Figure(
        "2 bow thrusters, 100 %",
        Run(0, 0, (1, 1, 0, 0), 120.0),
        "speed",
        1.20,
        0.03,
        "up to 1.20 m/s (7.3.2)",
    ),
    Figure("straight, 60 %", STRAIGHT[0.6], "speed", 1.0, 0.05, "about 1 m/s (7.3.5)"),
    Figure("straight, 30 %", STRAIGHT[0.3], "(1 - t)", 0.30, 0.05, "around 0.3 (7.3.5)"),
    Figure("straight, 100 %", STRAIGHT[1.0], "(1 - t)", 0.75, 0.05, "0.75 (7.3.5)"),
    Figure("circle, 30 degrees", CIRCLE[30], "tactical diameter", 8.8, 0.3, "almost 9 m"),
    Figure("circle, 30 degrees", CIRCLE[30], "speed", 0.95, 0.05, "almost 1 m/s"),
    Figure("circle, 60 degrees", CIRCLE[60], "tactical diameter", 1.8, 0.2, "less than 2 m"),
    Figure("circle, 60 degrees", CIRCLE[60], "speed", 0.47, 0.04, "almost 0.5 m/s"),
)


def predicted(boat: Boat, record: Record, figures: Sequence[Figure]) -> Array:
    """(n,) what the record's boat would make of the figures; each run is sailed once."""
    tracks: dict[Run, Array] = {}
    found = []
    for figure in figures:
        if figure.run not in tracks:
            tracks[figure.run] = sailed(boat, record, figure.run)
        found.append(READ[figure.what][1](tracks[figure.run], boat, record, figure.run))
    return np.nan_to_num(np.array(found), nan=1e3, posinf=1e3, neginf=-1e3)


def residuals(boat: Boat, model: Model, x: Array, figures: Sequence[Figure]) -> Array:
    """(n + p,) in standard deviations: figures, then the prior."""
    given = np.array([(figure.value, figure.error) for figure in figures]).T
    off = (predicted(boat, model.apply(boat, x), figures) - given[0]) / given[1]
    return np.concatenate([off, np.sqrt(model.prior) * (x - model.start)])


def fitted(boat: Boat, model: Model, figures: Sequence[Figure], wide: bool = True) -> Fitted:
    """The model's numbers by least squares within their bounds, from its start and, if `wide`, from both
    sides of it.
    """
    from scipy.optimize import least_squares

    if not len(model.start):
        chi2 = float((residuals(boat, model, model.start, figures) ** 2).sum())
        return Fitted(model, model.start, chi2)
    best = None
    for share in (0.0, 0.25, -0.25) if wide else (0.0,):
        towards = model.high if share > 0 else model.low
        begin = model.start + abs(share) * (np.clip(towards, -1e3, 1e3) - model.start)
        found = least_squares(
            lambda x: residuals(boat, model, x, figures),
            np.clip(begin, model.low + 1e-9, model.high - 1e-9),
            bounds=(model.low, model.high),
            x_scale=np.maximum(np.abs(model.start), 0.1),
            diff_step=1e-3,
            max_nfev=30,
        )
        if best is None or found.cost < best.cost:
            best = found
    assert best is not None
    return Fitted(model, best.x, 2.0 * float(best.cost))


def of_atom(atom: Atom) -> Model:
    """An effect of the library as a model."""
    hypothesis = Hypothesis((atom,))
    low, high = hypothesis.bounds()
    _, precision = hypothesis.prior()
    start = np.array(atom.starts[0] if atom.starts else atom.grid[0], dtype=float)
    names = atom.effect.parameter_names
    return Model(
        atom.label, names, start, low, high, lambda boat, x: hypothesis.records(boat, x[None]), precision
    )


def with_even_factor(inner: Model | None, name: str) -> Model:
    """A model with the same (1 - t), a number of its own, at every throttle, in place of the curve.

    At most 1: the boat cannot be pushed harder than the thrusters were measured to push on a bench.
    """

    def apply(boat: Boat, x: Array) -> Record:
        record = parameters(boat) if inner is None else inner.apply(boat, x[1:])
        record["deduction_factor_low"] = record["deduction_factor_high"] = x[0]
        return record

    none = np.zeros(0)
    start, low, high, prior = (inner.start, inner.low, inner.high, inner.prior) if inner else (none,) * 4
    return Model(
        name,
        ("(1 - t)", *(inner.numbers if inner else ())),
        np.append(0.7, start),
        np.append(0.1, low),
        np.append(1.0, high),
        apply,
        np.append(0.0, prior),
    )


NONE = np.zeros(0)
NOTHING = Model("boat file", (), NONE, NONE, NONE, lambda boat, x: parameters(boat), NONE)

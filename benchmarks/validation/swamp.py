"""SWAMP in the simulator against the numbers that its sources print: the rows of docs/validation.md."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.resistance import ResistanceCurve, TankResistance
from swamp_rl.identification.deduction import bollard_of_all, resistance_at
from swamp_rl.identification.motion import motions_of
from swamp_rl.identification.yaw_model import NAMES, PUBLISHED, YawModel, by_pseudo_inverse, by_rollout
from swamp_rl.manoeuvres.analysis.analyse import analyse_run
from swamp_rl.manoeuvres.analysis.figure import Result
from swamp_rl.manoeuvres.captive import captive_point, self_propulsion
from swamp_rl.manoeuvres.controller import Trial
from swamp_rl.manoeuvres.execute import execute
from swamp_rl.manoeuvres.record import run_of_trial
from swamp_rl.physics.resistance import surge_resistance, towing
from swamp_rl.physics.thrusters import bollard_thrust
from swamp_rl.runs import Run
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.state import SURGE

FULL, LIGHT = "swamp", "swamp-light"  # 58 kg and 48 kg
THEIRS = "swamp-thesis"  # as the simulator of chapter 8 had it
TANK_DENSITY = 1001.0  # kg/m3
DESIGN_THRUST = 12.5  # N of a jet, table 4.1
FULL_RPM, TESTED_RPM = 1185.0, 1179.0  # of the pump: table 5.5, and the test of 12.3 N
LARGE = 0.10
"""Share of a printed number that a computed one may differ by."""
FIT_THROTTLE = 0.6
"""Of the runs that the yaw model is fitted to: 1600 rpm, see configs/trials/ittc_swamp.yaml."""

THRUST_TABLE = (  # table 5.5: RPM%, N
    *((10, 0.1), (15, 0.3), (20, 0.5), (25, 0.8), (30, 1.1), (35, 1.5), (40, 2.0), (45, 2.5), (50, 3.1)),
    *((55, 3.7), (60, 4.4), (65, 5.2), (70, 6.0), (75, 6.9), (80, 7.8), (85, 8.8), (90, 9.9), (95, 11.0)),
    (100, 12.2),
)
TABLE_8_1 = (  # RPM%, N
    *((10, 0.12), (20, 0.49), (30, 1.10), (40, 1.95), (50, 3.05), (60, 4.39), (70, 5.98), (80, 7.81)),
    *((90, 9.88), (100, 12.20)),
)
SLOW = "table 4.7 prints 9.68 N at 0.99 m/s, of the same hull in the same tank."
FAST = (
    "table 4.7 prints 40.30 N at 1.49 m/s, and the design thrust of 5.3.1, 12.3 N, is a quarter of 1.2 times "
    "the resistance at this speed, which is 41 N; 49 N is 1.2 times as much."
)


@dataclass(frozen=True)
class Row:
    """A printed number: where it stands and what it says; the simulator's for 58 kg and for 48 kg.

    comparable: which of the two the source is about; limit: printed as one, so that less is no mismatch.
    width: tolerated as a difference, half a unit of the last printed digit, where that is more than `LARGE`.
    reading_of, reason, contradicted: as in `benchmarks.validation.check.Check`.
    """

    what: str
    source: str
    printed: str
    value: float
    full: float
    light: float
    comparable: str
    limit: bool = False
    reading_of: str = ""
    width: float = 0.0
    reason: str = ""
    contradicted: bool = False

    @property
    def mismatch(self) -> float:
        """Of the comparable one, as a share of the printed number."""
        off = (self.full if self.comparable == FULL else self.light) / self.value - 1.0
        return max(off, 0.0) if self.limit else off

    @property
    def met(self) -> bool:
        """Whether the comparable one is within the tolerance."""
        return abs(self.mismatch) <= max(LARGE, self.width / abs(self.value))


def straight_speed(boat: Boat, throttles: Sequence[float], depth_over_draught: float | None = None) -> float:
    """Speed [m/s] after two minutes straight ahead, the boat kept from turning by symmetry."""
    params = parameters(boat)
    if depth_over_draught is not None:
        params["depth_over_draught"] = depth_over_draught
    count = len(boat.thrusters)
    command = np.tile(np.concatenate([np.zeros(count), throttles]), (1200, 1))
    state = initial_state(params, np.zeros((1, 3)))
    track = simulate(params, tank(boat), state, command[None], np.zeros(1, np.uint64), 0.1, 1)
    return float(track[0, -1, SURGE])


@lru_cache
def trial(boat: str, kind: str, angle: float, throttle: float) -> Result:
    """The figures of one trial after a steady approach; angle [deg], also of the zig-zag's heading."""
    (run,) = trial_runs(boat, ((kind, angle, throttle),))
    return analyse_run(run, load_boat(boat))


@lru_cache
def trial_runs(boat: str, asked: tuple[tuple[str, float, float], ...]) -> tuple[Run, ...]:
    """The runs of trials: kind, angle [deg], throttle each."""
    trials = [
        Trial(kind, throttle, math.radians(angle), abs(math.radians(angle)))  # type: ignore[arg-type]
        for kind, angle, throttle in asked
    ]
    loaded = load_boat(boat)
    executed = execute(loaded, trials)
    return tuple(run_of_trial(one, loaded, f"{i}", i) for i, one in enumerate(executed))


def both(of: Callable[[Boat], float]) -> tuple[float, float]:
    """A number of the boat at 58 kg and at 48 kg."""
    return of(load_boat(FULL)), of(load_boat(LIGHT))


def speed_rows() -> list[Row]:
    """Speeds that the thesis gives."""
    bow, cruise, most = (1.0, 1.0, 0.0, 0.0), (0.6,) * 4, (1.0,) * 4
    found = [
        Row(
            "two bow thrusters at 100 %",
            "7.3.2, small payload",
            "up to 1.20 m/s",
            1.2,
            *both(lambda b: straight_speed(b, bow)),
            LIGHT,
        ),
        Row(
            "four thrusters at 60 %",
            "7.3.5, 48 kg; 002 at 1600 rpm",
            "about 1 m/s",
            1.0,
            *both(lambda b: straight_speed(b, cruise)),
            LIGHT,
        ),
    ]
    found += maximum_speed_rows()
    light = load_boat(LIGHT)
    shallow = (
        straight_speed(load_boat(FULL), most, 1.5),
        straight_speed(light, most, 0.2 / light.draught),
    )
    found.append(Row("maximum speed in 200 mm of water", "4.2.1", "1 m/s", 1.0, *shallow, FULL))
    return found


def maximum_speed_rows() -> list[Row]:
    """The greatest speed in deep water: under way, and as the design has it, without loss of thrust."""
    towed = load_boat(FULL).model_copy(update={"water_density": TANK_DENSITY})
    designed = brentq(lambda speed: resistance_at(towed, speed) - 4.0 * DESIGN_THRUST, 1.0, 1.74)
    number, nan = "maximum speed, deep", math.nan
    under_way = both(lambda boat: straight_speed(boat, (1.0,) * 4))
    message = f"{number}: where the tank's resistance is 4 × {DESIGN_THRUST:g} N, the thrust of table 4.1"
    return [
        Row(what, "4.2.1, table 4.1", "1.6 m/s", 1.6, full, light, FULL, reading_of=number)
        for what, full, light in ((number, *under_way), (message, designed, nan))
    ]


def turning_rows() -> list[Row]:
    """Circles and the zig-zag that the thesis gives, sailed here after a steady approach."""
    almost_9, under_2 = ("almost 9 m", 9.0, False), ("under 2 m", 2.0, True)
    found = circle_rows(30, almost_9, ("almost 1 m/s", 1.0, False))
    found += circle_rows(60, under_2, ("almost 0.5 m/s", 0.5, False))
    for throttle in (0.6, 0.9):
        name = f"zig-zag 20°/20°, {100 * throttle:.0f} %: first overshoot, deg"
        results = [trial(boat, "zig-zag", 20.0, throttle) for boat in (FULL, LIGHT)]
        full, light = (result.figures["first_overshoot"].value for result in results)
        source = "8.1.4, their simulator, RPM not stated"
        found.append(Row(name, source, "almost 10°", 10.0, full, light, FULL, reading_of="zig-zag"))
    theirs = trial(THEIRS, "zig-zag", 20.0, 0.9).figures["first_overshoot"].value
    name = f"zig-zag 20°/20°, 90 %: the same, by `{THEIRS}`, that simulator's numbers"
    found.append(Row(name, source, "almost 10°", 10.0, theirs, math.nan, FULL, reading_of="zig-zag"))
    return found


def circle_rows(angle: int, diameter: tuple[str, float, bool], speed: tuple[str, float, bool]) -> list[Row]:
    """The rows of one circle of 7.3.5; what is printed for it: text, number, whether that is a limit."""
    results = [trial(boat, "turning-circle", float(angle), 0.6) for boat in (FULL, LIGHT)]
    found = []
    for name, figure, (printed, value, limit) in (
        ("tactical diameter", "tactical_diameter", diameter),
        ("steady diameter, against the same number", "steady_diameter", diameter),
        ("speed in the turn", "steady_speed", speed),
    ):
        full, light = (result.figures[figure].value for result in results)
        what = f"circle at ±{angle}°, 60 %: {name}"
        reading_of = f"diameter at {angle}°" if "diameter" in name else ""
        found.append(Row(what, "7.3.5", printed, value, full, light, LIGHT, limit, reading_of))
    return found


@dataclass(frozen=True)
class TankRow:
    """A depth of the towing tank: how many points, and errors of the resistance as shares.

    errors: the largest; with this depth left out of the table the largest, and the root mean square; NaN for
    the shallowest and the deepest, which no other depths enclose.
    """

    depth: str
    points: int
    errors: tuple[float, float, float]


def tank_rows() -> list[TankRow]:
    """Every depth of the tank, with the model that knows it and with one that does not."""
    boat = load_boat(FULL).model_copy(update={"water_density": TANK_DENSITY})
    assert isinstance(boat.resistance, TankResistance)
    curves, found = boat.resistance.table, []
    for i, curve in enumerate(curves):
        known = errors_at(boat, curve)
        unseen = np.array([math.nan])
        if 0 < i < len(curves) - 1:
            others = boat.resistance.model_copy(update={"table": (*curves[:i], *curves[i + 1 :])})
            unseen = errors_at(boat.model_copy(update={"resistance": others}), curve)
        errors = (float(np.abs(known).max()), float(np.abs(unseen).max()), float(np.sqrt(np.mean(unseen**2))))
        found.append(TankRow(f"h/T = {curve.h_over_t:g}", len(known), errors))
    return found


def errors_at(boat: Boat, curve: ResistanceCurve) -> NDArray[np.float64]:
    """Errors of the boat's resistance at the points of a curve, as shares of what was measured."""
    pairs = zip(curve.speed, curve.resistance, strict=True)
    return np.array([resistance_in(boat, speed, curve.h_over_t) / drag - 1.0 for speed, drag in pairs])


def resistance_in(boat: Boat, speed: float, depth_over_draught: float) -> float:
    """Resistance [N] of a boat towed straight at a speed [m/s] in that depth."""
    params = parameters(boat)
    params["depth_over_draught"] = depth_over_draught
    record, curves = params[0], tank(boat)
    return float(-surge_resistance(speed, 0.0, record, curves, towing(record, curves)))


def force_rows() -> list[Row]:
    """Resistances and thrusts that the text prints beside its tables."""
    boat = load_boat(FULL)
    towed = boat.model_copy(update={"water_density": TANK_DENSITY})
    record = parameters(boat)[0]
    four = boat.thruster_names
    pulls = [captive_point(boat, 0.0, throttle, four).thrust for throttle in (0.6, 1.0)]
    required = 1.2 * resistance_at(towed, 1.5) / 4.0

    def one(what: str, source: str, printed: str, value: float, ours: float, reason: str = "") -> Row:
        against = bool(reason)
        return Row(what, source, printed, value, ours, math.nan, FULL, reason=reason, contradicted=against)

    def at(share: float) -> float:
        return float(bollard_thrust(share, 0, record))

    worst_percent, worst = max(TABLE_8_1, key=lambda pair: abs(at(pair[0] / 100.0) / pair[1] - 1.0))
    found = [
        one("resistance at 1 m/s, deep", "7.3.4", "about 12.4 N", 12.4, resistance_at(towed, 1.0), SLOW),
        one("resistance at 1.5 m/s, deep", "4.4.1", "49 N", 49.0, resistance_at(towed, 1.5), FAST),
        one("resistance at 1 m/s, h/T = 1.5", "4.4.1", "about 49 N", 49.0, resistance_in(towed, 1.0, 1.5)),
        one("thrust of one pump-jet, 100 %", "table 4.1", "12.5 N", DESIGN_THRUST, at(1.0)),
        one(
            f"thrust of one pump-jet at {TESTED_RPM:.0f} RPM",
            "5.5.2",
            "12.3 N, sd 0.26",
            12.3,
            at(TESTED_RPM / FULL_RPM),
        ),
        one(
            f"thrust at {worst_percent} % of the RPM, the worst of {len(TABLE_8_1)} points",
            "table 8.1",
            f"{worst:g} N",
            worst,
            at(worst_percent / 100.0),
        ),
        one("four jets on a bollard, 60 %", "7.3.4", "17.6 N", 17.6, pulls[0]),
        one("four jets on a bollard, 100 %", "7.3.4", "48.8 N", 48.8, pulls[1]),
        one("design thrust of a jet, 1.2 R / 4 at 1.5 m/s", "5.3.1, figure 5.14", "12.3 N", 12.3, required),
    ]
    for name, pair in (("bow", ("bs", "bp")), ("stern", ("ss", "sp"))):
        factor = captive_point(towed, 1.0, 0.7, pair).thrust_factor
        what = f"1 − t, two {name} thrusters at 70 %, 1 m/s"
        found.append(one(what, "7.3.4, tank", "0.68", 0.68, factor))
    held = 100.0 * self_propulsion(towed, 1.0, ("ss", "sp"))
    found.append(one("two stern jets hold 1 m/s, %", "7.3.4, tank", "85 %", 85.0, held))
    return found


def thrust_errors() -> tuple[float, float]:
    """Largest and root mean square difference [N] of the bollard thrust from table 5.5."""
    record = parameters(load_boat(FULL))[0]
    errors = np.array([float(bollard_thrust(p / 100.0, 0, record)) - thrust for p, thrust in THRUST_TABLE])
    return float(np.abs(errors).max()), float(np.sqrt(np.mean(errors**2)))


@lru_cache
def deduction_rows() -> list[tuple[int, float, float]]:
    """RPM%, speed [m/s] and 1 − t by eq. 7.3 of the simulated boat at 48 kg, as 7.3.5 measured it."""
    boat = load_boat(LIGHT)
    found = []
    for percent in (30, 40, 50, 60, 70, 80, 90, 100):
        speed = straight_speed(boat, (percent / 100.0,) * 4)
        found.append((percent, speed, resistance_at(boat, speed) / bollard_of_all(boat, percent / 100.0)))
    return found


@dataclass(frozen=True)
class YawRow:
    """A yaw model of 002's form; what follows from it at 1 m/s, and in a turn of that surge, sway [m/s]."""

    name: str
    model: YawModel
    surge: float
    sway: float

    @property
    def cells(self) -> list[str]:
        """For a table."""
        settle = self.model.time_constant(1.0)
        rate = math.degrees(self.model.steady_rate(math.radians(30.0), self.surge, self.sway))
        return [
            self.name,
            *(f"{getattr(self.model, name):.2f}" for name in NAMES),
            f"{self.model.damping(1.0):.2f}",
            f"{settle:.2f}" if math.isfinite(settle) else "unstable",
            f"{rate:.1f}" if math.isfinite(rate) else "unstable",
        ]


@lru_cache
def yaw_rows() -> list[YawRow]:
    """Table III, and the same model fitted to the simulator's runs of tables I and II at 1600 rpm."""
    boat = load_boat(LIGHT)
    angles = (20.0, 30.0, 40.0, 50.0, 60.0)
    asked = [("turning-circle", side * angle, FIT_THROTTLE) for angle in angles for side in (1.0, -1.0)]
    asked += [("zig-zag", angle, FIT_THROTTLE) for angle in (10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0)]
    motion = motions_of(trial_runs(LIGHT, tuple(asked)), boat, 0.0)
    inverted, _ = by_pseudo_inverse(motion, PUBLISHED.inertia)
    models = {
        "002, table III": PUBLISHED,
        "simulator, pseudo-inverse": inverted,
        "simulator, rollouts of 10 s": by_rollout(motion, inverted),
    }
    circle = trial(LIGHT, "turning-circle", 30.0, FIT_THROTTLE).figures
    speed, drift = circle["steady_speed"].value, math.radians(circle["drift_angle"].value)
    turn = speed * math.cos(drift), speed * math.sin(drift)
    return [YawRow(name, model, *turn) for name, model in models.items()]

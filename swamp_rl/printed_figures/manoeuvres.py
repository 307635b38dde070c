"""The tests that a printed figure can come from, and the figure that a boat gives in each."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.constants import GRAVITY
from swamp_rl.effects import EffectEntry
from swamp_rl.identification.motion import motions_of
from swamp_rl.identification.yaw_model import YawModel, by_pseudo_inverse
from swamp_rl.manoeuvres.analysis.analyse import analyse_run
from swamp_rl.manoeuvres.captive import command_of, forces_of, resistance_at, thrust_at_rest
from swamp_rl.manoeuvres.controller import Order, Trial
from swamp_rl.manoeuvres.execute import execute
from swamp_rl.manoeuvres.record import run_of_trial
from swamp_rl.manoeuvres.steering import Steering, commands_of
from swamp_rl.physics.hull import hull_forces
from swamp_rl.physics.resistance import towing
from swamp_rl.runs import Run
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.state import EAST, HEADING, SURGE, SWAY, YAW_RATE

Array = NDArray[np.float64]

DT = 0.1  # s
PART = 60.0  # times √(L/g): duration of a part of a test; parts follow until the motion is steady
STEADY = 1e-7  # change of speed in a part, as a share
MOST_PARTS = 20
LARGEST = 1e3  # lengths: the diameter of a boat that does not turn
TOUCH = 1e-4  # m/s and rad/s by which straight running is disturbed
DISTURBED = 0.5  # s after which the disturbance is evaluated
CIRCLES = (20.0, 30.0, 40.0, 50.0, 60.0)  # deg, to either side: table I of 002
ZIG_ZAGS = (10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0)  # deg: its table II


@dataclass(frozen=True, eq=False)
class Loaded:
    """A boat at a load, with the tables that its tests need."""

    boat: Boat

    @cached_property
    def plain(self) -> NDArray[Any]:
        """(1,) its parameter record."""
        return parameters(self.boat)

    @cached_property
    def curves(self) -> Array:
        """Its towing tank."""
        return tank(self.boat)

    @cached_property
    def steer(self) -> Steering:
        """Bow and stern azimuths opposed."""
        return commands_of(self.boat, "opposed")

    @cached_property
    def _captive(self) -> dict[tuple[float, tuple[str, ...]], tuple[Array, float]]:
        return {}

    def captive(self, throttle: float, thrusters: tuple[str, ...]) -> tuple[Array, float]:
        """The settled command (2K,) of thrusters that push along the hull, and their thrust [N] at rest."""
        if (throttle, thrusters) not in self._captive:
            command = command_of(self.boat, throttle, thrusters or self.boat.thruster_names)
            self._captive[throttle, thrusters] = command, thrust_at_rest(self.boat, command)
        return self._captive[throttle, thrusters]


@dataclass(frozen=True, eq=False)
class Test:
    """One test of a boat with effects.

    at: the boat as its file has it; entries: the effects; record: (1,) of the boat with them;
    speed [m/s] of a carriage; angle [rad]; thrusters: that run, all where none is named.
    """

    at: Loaded
    entries: tuple[EffectEntry, ...]
    record: NDArray[Any]
    throttle: float = 0.0
    thrusters: tuple[str, ...] = ()
    speed: float = 0.0
    angle: float = 0.0

    @property
    def boat(self) -> Boat:
        """At the test's load."""
        return self.at.boat

    @property
    def running(self) -> list[bool]:
        """Thruster by thruster, whether it runs."""
        return [not self.thrusters or name in self.thrusters for name in self.boat.thruster_names]

    def command(self, angle: float) -> Array:
        """(2K,) with the bow's azimuths at `angle` [rad], the stern's opposed."""
        asked = self.at.steer(Order(angle, self.throttle))
        return asked * np.array(2 * self.running, float)

    @property
    def part(self) -> int:
        """Steps of a part of the test."""
        return round(PART * math.sqrt(self.boat.length / GRAVITY) / DT)

    def sailed(self, start: Array, angle: float, steps: int) -> Array:
        """(steps + 1, S) states from `start` (1, S) under a constant command."""
        rows = np.broadcast_to(self.command(angle), (1, steps, 2 * len(self.running))).copy()
        seeds = np.zeros(1, np.uint64)
        return np.asarray(simulate(self.record, self.at.curves, start, rows, seeds, DT, 1)[0])

    def settled(self, start: Array, angle: float) -> Array:
        """(T + 1, S) states from `start` (1, S) until the motion is steady, or MOST_PARTS are over."""
        parts = [start]
        for _ in range(MOST_PARTS):
            parts.append(self.sailed(parts[-1][-1:], angle, self.part)[1:])
            before, after = parts[-2][-1], parts[-1][-1]
            changed = abs(after[SURGE] - before[SURGE]) + abs(after[SWAY] - before[SWAY])
            changed += self.boat.length * abs(after[YAW_RATE] - before[YAW_RATE])
            if changed <= STEADY * math.hypot(after[SURGE], after[SWAY]):
                break
        return np.concatenate(parts)

    @cached_property
    def straight(self) -> Array:
        """(1, S) the state of steady straight running."""
        start = initial_state(self.record, np.zeros((1, 3)))
        return self.settled(start, 0.0)[-1:].copy()

    @cached_property
    def turn(self) -> Array:
        """(T + 1, S) states from the execute on, after a steady approach from the origin to the north."""
        start = self.straight.copy()
        start[:, : HEADING + 1] = 0.0
        return self.settled(start, self.angle)

    @property
    def circle(self) -> Array:
        """(T, S) states of the steady end of the turn."""
        return self.turn[-self.part :]

    def towed_thrust(self, speed: float) -> float:
        """Surge force [N] of the running thrusters, straight ahead, at a speed [m/s] through the water."""
        command, _ = self.at.captive(self.throttle, self.thrusters)
        return forces_of(self.record, self.at.curves, speed, command)[0] + self.resistance(speed)

    def resistance(self, speed: float) -> float:
        """Of the hull alone [N], towed at a speed [m/s]."""
        record, curves = self.record[0], self.at.curves
        return -float(hull_forces(speed, 0.0, 0.0, record, curves, towing(record, curves))[0])

    @property
    def expected_thrust(self) -> float:
        """Thrust [N] of the running thrusters at rest by the boat file's curve, without deduction."""
        return self.at.captive(self.throttle, self.thrusters)[1]

    @cached_property
    def yaw_model(self) -> YawModel:
        """The yaw model of paper 002 (eqs 1 and 2) of circles and zig-zags sailed in closed loop."""
        both = np.radians([side * angle for angle in CIRCLES for side in (1.0, -1.0)]).tolist()
        trials = [Trial("turning-circle", self.throttle, angle) for angle in both]
        trials += [Trial("zig-zag", self.throttle, angle, angle) for angle in np.radians(ZIG_ZAGS).tolist()]
        return by_pseudo_inverse(motions_of(self.closed_loop(trials), self.boat, 0.0), self.boat.inertia_z)[0]

    def closed_loop(self, trials: list[Trial]) -> list[Run]:
        """The runs of manoeuvres after a steady approach, as `swamp-rl trial` executes them."""
        boat = self.boat.model_copy(update={"effects": (*self.boat.effects, *self.entries)})
        executed = execute(boat, trials)
        return [run_of_trial(one, boat, str(number), number) for number, one in enumerate(executed)]


def pull(test: Test) -> float:
    """Force [N] on a line that holds the boat back."""
    return test.towed_thrust(0.0)


def towed_one_minus_t(test: Test) -> float:
    """1 − t = (R − F_D) / T_bollard (thesis eq. 7.1), F_D the towing force beside the running thrusters."""
    return test.towed_thrust(test.speed) / test.expected_thrust


def towed_resistance(test: Test) -> float:
    """Towing force [N] with the thrusters stopped."""
    return test.resistance(test.speed)


def straight_speed(test: Test) -> float:
    """Steady speed [m/s]."""
    return float(np.hypot(test.straight[0, SURGE], test.straight[0, SWAY]))


def free_one_minus_t(test: Test) -> float:
    """1 − t = R(U) / T_bollard (thesis eq. 7.3), R by the boat file at the speed that is reached."""
    return resistance_at(test.boat, straight_speed(test)) / test.expected_thrust


def yaw_growth_rate(test: Test) -> float:
    """Rate [1/s] at which a small disturbance of straight running grows; negative where it decays.

    The largest real part of the eigenvalues of sway and yaw rate, from their transition over DISTURBED.
    """
    channels, steps = [SWAY, YAW_RATE], round(DISTURBED / DT)
    columns = []
    for channel in channels:
        ends = []
        for side in (1.0, -1.0):
            start = test.straight.copy()
            start[0, channel] += side * TOUCH
            ends.append(test.sailed(start, 0.0, steps)[-1, channels])
        columns.append((ends[0] - ends[1]) / (2.0 * TOUCH))
    largest = np.abs(np.linalg.eigvals(np.column_stack(columns))).max()
    return float(np.log(largest) / (steps * DT))


def steady_speed(test: Test) -> float:
    """Speed [m/s] on the steady circle."""
    return float(np.hypot(test.circle[:, SURGE], test.circle[:, SWAY]).mean())


def turning_rate(test: Test) -> float:
    """Yaw rate [deg/s] on the steady circle, positive to the side that was steered to."""
    side = math.copysign(1.0, test.angle)
    return side * math.degrees(test.circle[:, YAW_RATE].mean())


def steady_diameter(test: Test) -> float:
    """Diameter [m] of the steady circle, at most LARGEST."""
    rate, most = abs(math.radians(turning_rate(test))), LARGEST * test.boat.length
    return min(2.0 * steady_speed(test) / max(rate, 1e-12), most)


def tactical_diameter(test: Test) -> float:
    """Way [m] across the first course at half a turn after a steady approach, at most LARGEST."""
    turned = np.abs(test.turn[:, HEADING])
    if turned.max() < math.pi:
        return LARGEST * test.boat.length
    after = int(np.argmax(turned >= math.pi))
    place = np.interp(math.pi, turned[after - 1 : after + 1], test.turn[after - 1 : after + 1, EAST])
    return abs(float(place))


def diameter_difference(test: Test) -> float:
    """Steady diameter [m] of the turn to the side of the angle less that of the turn to the other side."""
    other = replace(test, angle=-test.angle)
    return steady_diameter(test) - steady_diameter(other)


def first_overshoot(test: Test) -> float:
    """First overshoot [deg] of a zig-zag that reverses at its angle."""
    angle = test.angle
    (run,) = test.closed_loop([Trial("zig-zag", test.throttle, angle, abs(angle), executes=2)])
    return analyse_run(run, test.boat).figures["first_overshoot"].value


def yaw_coefficient(name: str) -> Callable[[Test], float]:
    """Reader of a coefficient of the yaw model by its name."""
    return lambda test: float(getattr(test.yaw_model, name))


Reader = Callable[[Test], float]
READERS: dict[str, dict[str, tuple[str, Reader]]] = {
    "bollard": {"pull": ("N", pull)},
    "towed": {"one_minus_t": ("1", towed_one_minus_t), "resistance": ("N", towed_resistance)},
    "straight": {
        "speed": ("m/s", straight_speed),
        "one_minus_t": ("1", free_one_minus_t),
        "yaw_growth_rate": ("1/s", yaw_growth_rate),
    },
    "turning-circle": {
        "steady_diameter": ("m", steady_diameter),
        "tactical_diameter": ("m", tactical_diameter),
        "diameter_difference": ("m", diameter_difference),
        "steady_speed": ("m/s", steady_speed),
        "turning_rate": ("deg/s", turning_rate),
    },
    "zig-zag": {"first_overshoot": ("deg", first_overshoot)},
    "yaw-model": {
        "k_r": ("N m s", yaw_coefficient("k_r")),
        "c_ru": ("N s2", yaw_coefficient("c_ru")),
        "c_rv": ("N s2", yaw_coefficient("c_rv")),
        "b_r": ("N m/rad", yaw_coefficient("b_r")),
    },
}
FIGURES = {name: {figure: unit for figure, (unit, _) in known.items()} for name, known in READERS.items()}
KEYS = {  # what a figure of a manoeuvre must say of its commands
    "bollard": {"throttle"},
    "towed": {"speed"},
    "straight": {"throttle"},
    "turning-circle": {"throttle", "angle_deg"},
    "zig-zag": {"throttle", "angle_deg"},
    "yaw-model": {"throttle"},
}
NEEDED = {"one_minus_t": {"throttle"}}  # what a figure must say besides, which is a share of the thrust
OPTIONAL = {  # and what it may
    "bollard": {"thrusters"},
    "towed": {"throttle", "thrusters", "depth_over_draught"},
    "straight": {"thrusters", "depth_over_draught"},
    "turning-circle": {"thrusters"},
    "zig-zag": set[str](),
    "yaw-model": set[str](),
}

"""A mission flown in simulation: its track, and power, current and charge of each battery pack."""

import logging
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat.battery import Battery
from swamp_rl.boat.drawn import refuse_without_battery
from swamp_rl.energy.charge import Discharge, charge_at, discharge, stored_energy
from swamp_rl.energy.depth import Aground, depths, refuse_depths, touched
from swamp_rl.energy.mission import Mission
from swamp_rl.energy.pilot import MissionPilot
from swamp_rl.energy.power import supplied, thrust_left, thruster_power
from swamp_rl.errors import UserError
from swamp_rl.guidance.loop import closed_loop, truth
from swamp_rl.simulator import initial_state, parameters
from swamp_rl.simulator.ground import set_depth
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.state import ACTUATORS, NORTH, SURGE, SWAY

Array = NDArray[np.float64]

LOG = logging.getLogger(__name__)
STEP = 0.5  # s between two decisions
TOLD = 600  # steps between two lines of progress
CHECKED = 2  # steps between two looks at the batteries
PATIENCE, TURNING = (
    3.0,
    120.0,
)  # multiple of a leg's time at its speed, and s more, after which it is given up
SETTLED, SLOWER = 60.0, 0.97  # s at the end of a leg in which at least that share of its speed must be made


@dataclass(frozen=True)
class Flight:
    """A mission as it went, T steps of `STEP`.

    states: (T + 1, S), see `swamp_rl.simulator.state`; leg: (T,) number of the leg of each step; packs:
    power, energy, charge, voltage and current of each pack; thrusters: (T, K) power [W] of each; emptied:
    time [s] at which a pack was empty, None where the mission was flown to its end; aground: where it touched
    ground, None where it did not.
    """

    boat: Boat
    mission: Mission
    states: Array
    leg: NDArray[np.int64]
    packs: Discharge
    thrusters: Array
    emptied: float | None
    aground: Aground | None = None

    @property
    def time(self) -> Array:
        """(T + 1,) [s]."""
        return np.asarray(np.arange(len(self.states)) * STEP, dtype=np.float64)

    @property
    def way(self) -> Array:
        """(T + 1,) distance over ground so far [m]."""
        steps = np.hypot(*np.diff(self.states[:, NORTH : NORTH + 2], axis=0).T)
        return np.concatenate([[0.0], np.cumsum(steps)]).astype(np.float64)

    @property
    def speed(self) -> Array:
        """(T + 1,) over ground [m/s]."""
        return np.asarray(np.hypot(self.states[:, SURGE], self.states[:, SWAY]))


def reserve_of(boat: Boat, mission: Mission) -> float:
    """State of charge [1] that the mission must leave."""
    refuse_without_battery(boat)
    assert boat.battery is not None
    return 1.0 - boat.battery.depth_of_discharge if mission.reserve is None else mission.reserve


def fly(boat: Boat, mission: Mission, where: object, even_if_empty: bool = False) -> Flight:
    """Fly a mission with a boat, its effects on, from rest.

    where: the file to name in errors. even_if_empty: fly on below the reserve until a pack is empty.
    A boat that touches ground ends the mission there. UserError for a boat without battery, a reserve above
    the charge at the start, a speed that the boat cannot reach, a depth that it was not towed in, a leg that
    does not end, a current above the packs' peak, and, unless `even_if_empty`, for a mission that needs more
    than the battery.
    """
    reserve = reserve_of(boat, mission)
    assert boat.battery is not None
    if mission.charge <= reserve:
        raise UserError(
            f"{where}: charge {mission.charge:g}: must be above the reserve of {reserve:g}; charge the packs"
        )
    refuse_speeds(boat, mission, where)
    refuse_depths(boat, mission, where)
    least = 0.0 if even_if_empty else reserve
    states, leg, power, short, aground = _flown(boat, mission, boat.battery, least, where)
    packs = discharge(boat.battery, supplied(boat, power), STEP, mission.charge)
    flight = Flight(boat, mission, states, leg, packs, power, len(leg) * STEP if short else None, aground)
    if short and not even_if_empty:
        raise UserError(f"{where}: {too_much(flight, reserve)}; shorten it or use --even-if-empty")
    refuse_slow_legs(flight, where)
    refuse_currents(flight, boat.battery, where)
    return flight


def refuse_speeds(boat: Boat, mission: Mission, where: object) -> None:
    """UserError for a leg that is faster than the boat in still water."""
    most = reference_of(boat).speed
    for number, leg in enumerate(mission.legs):
        if leg.speed > most:
            raise UserError(
                f"{where}: legs.{number}.speed: {leg.speed:g} m/s is above {most:.3g} m/s, the top speed of "
                f"boat {boat.name}; go slower"
            )


def too_much(flight: Flight, reserve: float) -> str:
    """What a mission that needs more than the battery says: where, and when."""
    boat, time, leg = flight.boat, len(flight.leg) * STEP, int(flight.leg[-1])
    return (
        f"the mission needs more than the battery of boat {boat.name}: state of charge {reserve:.3g} after "
        f"{time:.0f} s and {flight.way[-1]:.0f} m, in legs.{leg}"
    )


class Load:
    """The packs under way: the thrusters' power in each step, and what the voltage leaves of the thrust.

    The voltage is that of the last look, `CHECKED` steps ago at most.
    """

    def __init__(self, boat: Boat, battery: Battery, charge: float, least: float) -> None:
        self.boat, self.battery = boat, battery
        self.first = float(stored_energy(battery, np.array(charge)))
        self.usable = self.first - float(stored_energy(battery, np.array(least)))
        self.power: list[Array] = []
        self.drawn = np.zeros(battery.packs)
        self.left = thrust_left(boat, np.full(battery.packs, charge))

    def take(self, states: list[Array]) -> bool:
        """Account for the steps to these states (1, S) each; whether a pack has given all that it may."""
        throttle = np.concatenate(states)[:, ACTUATORS + len(self.boat.thrusters) :]
        self.power.append(thruster_power(self.boat, throttle, self.left))
        self.drawn = self.drawn + supplied(self.boat, self.power[-1]).sum(axis=0) * STEP
        self.left = thrust_left(self.boat, charge_at(self.battery, self.first - self.drawn))
        return bool(self.drawn.max() >= self.usable)


def _flown(
    boat: Boat, mission: Mission, battery: Battery, least: float, where: object
) -> tuple[Array, NDArray[np.int64], Array, bool, Aground | None]:
    """States, leg and the thrusters' power of each step, whether a pack came to the charge `least` before the
    end, and where the boat touched ground.
    """
    pilot, load = MissionPilot(boat, mission), Load(boat, battery, mission.charge, least)
    params = parameters(boat)
    gain, legs, short = params["thruster_gain"].copy(), list[int](), [False]
    deep, ground = depths(boat, mission), list[Aground]()
    params["thruster_gain"] = gain * load.left

    def decide(states: list[Array]) -> tuple[Array, bool]:
        if len(states) > 1 and (len(states) - 1) % CHECKED == 0:
            short[0] = load.take(states[-CHECKED:])
            params["thruster_gain"] = gain * load.left
        seen = truth(states[-1][0])
        commands = pilot.act(seen, STEP)[None]
        if pilot.leg is not None:
            set_depth(params, boat, deep[pilot.leg])
            touch = touched(boat, params, states[-1][0], pilot.leg, deep[pilot.leg])
            ground.extend([] if touch is None else [touch])
        if pilot.leg is None or short[0] or ground:
            rest = (len(states) - 1) % CHECKED
            if rest:
                load.take(states[-rest:])
            return commands, True
        if len(legs) % TOLD == 0:
            LOG.debug("leg %d of %d, %.0f s sailed", pilot.leg + 1, len(mission.legs), seen.time)
        legs.append(pilot.leg)
        spent = seen.time - pilot.begun
        if spent > PATIENCE * pilot.expected + TURNING:
            raise UserError(
                f"{where}: legs.{pilot.leg}: its last waypoint is not reached within {spent:.0f} s; go "
                "faster, or check the waypoints and the current"
            )
        return commands, False

    pose = np.array([[mission.start.north, mission.start.east, mission.course]])
    seeds = np.array([mission.seed], np.uint64)
    states, _ = closed_loop(boat, params, initial_state(params, pose), decide, seeds, STEP)
    return (
        states[0],
        np.array(legs, dtype=np.int64),
        np.concatenate(load.power),
        short[0],
        next(iter(ground), None),
    )


def refuse_slow_legs(flight: Flight, where: object) -> None:
    """UserError for a leg with a duration at the end of which the boat does not make its speed."""
    for number, leg in enumerate(flight.mission.legs):
        rows = np.flatnonzero(flight.leg == number) + 1
        if leg.duration_s is None or len(rows) < 2 * SETTLED / STEP:
            continue
        made = float(flight.speed[rows[-round(SETTLED / STEP) :]].mean())
        if made < SLOWER * leg.speed:
            raise UserError(
                f"{where}: legs.{number}.speed: {leg.speed:g} m/s is not reached: boat {flight.boat.name} "
                f"makes {made:.3g} m/s over ground there; go slower, or check wind and current"
            )


def refuse_currents(flight: Flight, battery: Battery, where: object) -> None:
    """UserError where a pack would have to give more than its peak current."""
    over = np.flatnonzero(flight.packs.current.max(axis=1) > battery.current_peak)
    if len(over):
        most, step = float(flight.packs.current.max()), int(over[0])
        raise UserError(
            f"{where}: legs.{flight.leg[step]}: a pack would give {most:.3g} A, its peak is "
            f"{battery.current_peak:g} A; go slower"
        )


def above_continuous(flight: Flight) -> float:
    """Time [s] in which a pack gives more than its continuous current."""
    assert flight.boat.battery is not None
    over = flight.packs.current.max(axis=1) > flight.boat.battery.current_continuous
    return float(over.sum()) * STEP if math.isfinite(flight.boat.battery.current_continuous) else 0.0

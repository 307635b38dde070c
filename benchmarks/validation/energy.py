"""Power, energy and charge against tables 6.2 and 6.3 of the thesis: rows of docs/validation.md."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from benchmarks.validation.swamp import FULL, Row
from swamp_rl.boat import Boat, Thruster, load_boat
from swamp_rl.energy import thruster_power
from swamp_rl.energy.best_range import energy_per_metre_at, steady_power
from swamp_rl.energy.figures import leg_figures
from swamp_rl.energy.fly import Flight, fly
from swamp_rl.energy.mission import load_mission
from swamp_rl.manoeuvres.captive import resistance_at

DESIGN = "swamp-design"
SPEEDS = (0.5, 0.8, 1.0, 1.2, 1.5)  # m/s, table 6.3
PRINTED_POWER = (17.0, 24.0, 40.0, 74.0, 171.0)  # W of a hull, P_prop of table 6.3
USERS = 88.0  # W of a hull, table 6.3
ANCHOR_THRUST, ANCHOR_POWER = 12.3, 96.7  # N and W of one jet on the bollard, 5.5.2
MARGIN = 1.1  # T = 1.1 R / 4
MISSIONS = {"table_6_3_1": 433.0, "table_6_3_2": 399.0, "table_6_3_3": 464.0}  # Wh of a hull
FINAL_CHARGE = 0.08  # of each mission
VOLTAGES = (40.0, 38.0, 36.0, 34.0, 32.0)  # V = P_tot / I_tot of table 6.3, leg by leg
PEUKERT, AMPERE_HOURS = 1.05, 13.0  # of the column I^n t; table 6.2


def fitted_power() -> tuple[float, float]:
    """P_0 [W] and k [W/N^1.5]: k through the anchor, P_0 by least squares of the five printed powers.

    P = P_0 + k T^1.5, T = 1.1 R / 4 with the resistance R of the towing tank.
    """
    boat = load_boat(DESIGN)
    shape = np.array([(MARGIN * resistance_at(boat, speed) / 4.0) ** 1.5 for speed in SPEEDS])
    share = shape / ANCHOR_THRUST**1.5
    slope, rest = 1.0 - share, np.array(PRINTED_POWER) / 2.0 - ANCHOR_POWER * share
    idle = float(slope @ rest / (slope @ slope))
    return idle, (ANCHOR_POWER - idle) / ANCHOR_THRUST**1.5


def propulsion_power(boat: Boat, speed: float) -> float:
    """Power [W] of one hull's jets at a steady speed [m/s]."""
    assert boat.battery is not None
    return float(steady_power(boat, speed)[0] - boat.battery.hotel_power)


@lru_cache
def flown(name: str) -> Flight:
    """A mission of configs/missions, flown."""
    mission, path = load_mission(name)
    return fly(load_boat(mission.boat), mission, path)


def watt_hours(flight: Flight) -> float:
    """Energy of one hull [Wh]."""
    return float(flight.packs.energy[-1].mean()) / 3600.0


def charge_by_the_tables_rule(flight: Flight) -> float:
    """State of charge [1] at the end by the rule of table 6.3: 1 − Σ I^1.05 t / 13 Ah, I = P / V_leg.

    V_leg is the voltage that P_tot / I_tot gives for each leg, 40, 38, 36, 34 and 32 V, whatever the charge.
    """
    drawn = sum(
        (float(leg.power.mean()) / VOLTAGES[leg.number]) ** PEUKERT * leg.duration / 3600.0
        for leg in leg_figures(flight)
    )
    return 1.0 - drawn / AMPERE_HOURS


def energy_rows() -> list[Row]:
    """Printed numbers of power, energy and charge beside those of `swamp-design`."""
    boat, nan = load_boat(DESIGN), math.nan
    rows = [("power of a jet at 13.5 N, W", "5.5.2", "around 105 W", 105.0, jet_power(boat, 13.5), "")]
    for speed, power in zip(SPEEDS, PRINTED_POWER, strict=True):
        printed, ours = 2.0 * (power + USERS) / speed, energy_per_metre_at(boat, speed)
        what = f"both hulls at {speed:g} m/s, J/m"
        rows.append((what, "table 6.3, 2 P_tot / U", f"{printed:.0f}", printed, ours, ""))
    best = min(SPEEDS, key=lambda speed: energy_per_metre_at(boat, speed))
    rows.append(("speed of best range of these five, m/s", "table 6.3", "1.0", 1.0, best, ""))
    for name, energy in MISSIONS.items():
        mission, flight = f"mission {name[-1]}", flown(name)
        ours = watt_hours(flight)
        rows.append((f"{mission}: energy of a hull, Wh", "table 6.3", f"{energy:.0f}", energy, ours, ""))
        final = float(flight.packs.charge[-1].mean())
        by_rule = charge_by_the_tables_rule(flight)
        for what, value in (("simulated", final), ("by the table's rule", by_rule)):
            number = f"{mission}: final state of charge"
            rows.append((f"{number}, {what}", "table 6.3", "0.08", FINAL_CHARGE, value, number))
    return [
        Row(what, source, printed, value, ours, nan, FULL, reading_of=number)
        for what, source, printed, value, ours, number in rows
    ]


def jet_power(boat: Boat, thrust: float) -> float:
    """Electric power [W] of the first thruster at a thrust at rest [N]."""
    jet = boat.thrusters[0]
    assert isinstance(jet, Thruster)
    throttle: NDArray[np.float64] = np.full(len(boat.thrusters), math.sqrt(thrust / jet.thrust_quadratic))
    return float(thruster_power(boat, throttle)[0])

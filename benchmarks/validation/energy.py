"""Power, energy and charge against tables 6.2 and 6.3 of the thesis: rows of docs/validation.md."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from benchmarks.validation.swamp import FULL, Row
from swamp_rl.boat import Boat, Thruster, load_boat
from swamp_rl.energy import pack_power, stored_energy, thruster_power
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
LEGS = {  # Wh of a hull and state of charge at the end of each leg, table 6.3
    "table_6_3_1": ((433.0, 0.08),),
    "table_6_3_2": ((52.0, 0.89), (84.0, 0.82), (315.0, 0.30), (347.0, 0.22), (399.0, 0.08)),
    "table_6_3_3": ((64.0, 0.87), (400.0, 0.15), (464.0, 0.08)),
}
HALF_CENT = 0.005  # half a unit of the last digit of a state of charge
FULL_POWER, FULL_CURRENT, NOMINAL = 282.0, 7.8, 36.0  # W and A of a hull at 36 V, table 6.1
AUTONOMY = 2.0  # h at the greatest power, table 4.1
CURVE = (
    "the curve of power against thrust, figure 5.33, is a picture; P_0 + k T^1.5 through 96.7 W at 12.3 N "
    "meets the other four powers, and 17 W only with another P_0."
)
LAST = (
    "the table prints 1.8 A beside 128 W in its last row, which is 71 V; at the 36 V of the third row of "
    "mission 2 128 W are 3.6 A, which leave nothing of 13 Ah."
)
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
    """State of charge [1] at the end by the rule of table 6.3, with our powers."""
    return charges_by_the_tables_rule(flight, printed=False)[-1]


def charges_by_the_tables_rule(flight: Flight, printed: bool) -> list[float]:
    """State of charge [1] at the end of each leg by the rule of table 6.3.

    It is 1 − Σ I^1.05 t / 13 Ah, I = P / V_leg; V_leg is the voltage that P_tot / I_tot gives for each leg,
    40, 38, 36, 34 and 32 V, whatever the charge.
    printed: with the powers of the table instead of ours.
    """
    of_table = {speed: power + USERS for speed, power in zip(SPEEDS, PRINTED_POWER, strict=True)}
    drawn, found = 0.0, []
    for leg in leg_figures(flight):
        power = of_table[leg.asked] if printed else float(leg.power.mean())
        drawn += (power / VOLTAGES[leg.number]) ** PEUKERT * leg.duration / 3600.0
        found.append(1.0 - drawn / AMPERE_HOURS)
    return found


def energy_rows() -> list[Row]:
    """Printed numbers of power, energy and charge beside those of `swamp-design`."""
    boat = load_boat(DESIGN)
    assert boat.battery is not None
    most = float(pack_power(boat, np.ones(len(boat.thrusters)))[0])
    hours = float(stored_energy(boat.battery, np.array(1.0))) / most / 3600.0
    rows = [
        _row("power of a jet at 13.5 N, W", "5.5.2", "around 105 W", 105.0, jet_power(boat, 13.5)),
        _row("power of a hull at full throttle, W", "table 6.1", "282", FULL_POWER, most),
        _row(
            "current of a hull at full throttle and 36 V, A", "table 6.1", "7.8", FULL_CURRENT, most / NOMINAL
        ),
        _row("hours at full throttle, until empty", "table 4.1", "2", AUTONOMY, hours, width=0.5),
    ]
    for speed, power in zip(SPEEDS, PRINTED_POWER, strict=True):
        what, ours = f"two jets at {speed:g} m/s, W", propulsion_power(boat, speed)
        rows.append(_row(what, "table 6.3, P_prop", f"{power:g}", power, ours, reason=CURVE))
    for speed, power in zip(SPEEDS, PRINTED_POWER, strict=True):
        printed, ours = 2.0 * (power + USERS) / speed, energy_per_metre_at(boat, speed)
        what = f"both hulls at {speed:g} m/s, J/m"
        rows.append(_row(what, "table 6.3, 2 P_tot / U", f"{printed:.0f}", printed, ours))
    best = min(SPEEDS, key=lambda speed: energy_per_metre_at(boat, speed))
    rows.append(_row("speed of best range of these five, m/s", "table 6.3", "1.0", 1.0, best))
    return rows + [row for name in LEGS for row in mission_rows(name)]


def mission_rows(name: str) -> list[Row]:
    """Energy and state of charge after each leg of a mission of table 6.3, the charge in three readings."""
    flight, where = flown(name), "table 6.3"
    figures = leg_figures(flight)
    energies = np.cumsum([float(leg.energy.mean()) / 3600.0 for leg in figures])
    readings = {
        "simulated": [float(leg.charge.mean()) for leg in figures],
        "by the table's rule": charges_by_the_tables_rule(flight, printed=False),
        "by the table's rule and powers": charges_by_the_tables_rule(flight, printed=True),
    }
    found = []
    for leg, (energy, charge) in enumerate(LEGS[name]):
        when = f"mission {name[-1]}, leg {leg + 1}"
        found.append(
            _row(f"{when}: energy of a hull, Wh", where, f"{energy:g}", energy, float(energies[leg]))
        )
        number = f"{when}: state of charge"
        for reading, charges in readings.items():
            message, at_end = f"{number}, {reading}", f"{charge:.2f}"
            misprint = name == "table_6_3_3" and leg == len(figures) - 1
            found.append(
                _row(
                    message,
                    where,
                    at_end,
                    charge,
                    charges[leg],
                    HALF_CENT,
                    number,
                    LAST if misprint else "",
                    misprint,
                )
            )
    return found


def _row(
    what: str,
    source: str,
    printed: str,
    value: float,
    ours: float,
    width: float = 0.0,
    reading_of: str = "",
    reason: str = "",
    contradicted: bool = False,
) -> Row:
    entries = {"width": width, "reading_of": reading_of, "reason": reason, "contradicted": contradicted}
    return Row(what, source, printed, value, ours, math.nan, FULL, **entries)  # type: ignore[arg-type]


def jet_power(boat: Boat, thrust: float) -> float:
    """Electric power [W] of the first thruster at a thrust at rest [N]."""
    jet = boat.thrusters[0]
    assert isinstance(jet, Thruster)
    throttle: NDArray[np.float64] = np.full(len(boat.thrusters), math.sqrt(thrust / jet.thrust_quadratic))
    return float(thruster_power(boat, throttle)[0])

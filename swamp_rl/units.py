"""Units of others in those of boat files and runs."""

import math

from swamp_rl.constants import DAY, FOOT, KNOT, POUND

UNITS = {
    "deg": {"rad": math.pi / 180.0, "deg": 1.0},
    "deg/s": {"rad/s": math.pi / 180.0},
    "deg/min": {"rad/s": math.pi / 10800.0},
    "rpm": {"rps": 1.0 / 60.0, "rad/s": math.tau / 60.0},
    "percent": {"1": 0.01},
    "mm": {"m": 1e-3},
    "cm": {"m": 1e-2},
    "km": {"m": 1e3},
    "ft": {"m": FOOT},
    "kn": {"m/s": KNOT},
    "km/h": {"m/s": 1.0 / 3.6},
    "mm/s": {"m/s": 1e-3},
    "cm/s": {"m/s": 1e-2},
    "ft/s": {"m/s": FOOT},
    "s": {"s": 1.0},
    "ms": {"s": 1e-3},
    "us": {"s": 1e-6},
    "ns": {"s": 1e-9},
    "min": {"s": 60.0},
    "h": {"s": 3600.0},
    "d": {"s": DAY},
    "g": {"kg": 1e-3},
    "t": {"kg": 1e3},
    "lb": {"kg": POUND},
    "kW": {"W": 1e3},
    "mAh": {"C": 3.6},
    "Ah": {"C": 3600.0},
    "Wh": {"J": 3600.0},
    "kWh": {"J": 3.6e6},
}
"""What one of each is in the units of boat files and runs that it may stand for."""


def in_ours(unit: str, ours: str) -> str:
    """What one of a unit is in one of ours, such as `1 Ah is 3600 C`; nothing where that is not known."""
    value = UNITS.get(unit, {}).get(ours)
    return "" if value is None else f"1 {unit} is {value:.9g} {ours}"

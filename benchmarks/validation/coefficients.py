"""Coefficients that the thesis prints and that follow from its other numbers: rows of docs/validation.md."""

import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.validation.swamp import FULL, TANK_DENSITY, Row
from swamp_rl.boat import load_boat
from swamp_rl.boat.resistance import TankResistance
from swamp_rl.constants import GRAVITY

Array = NDArray[np.float64]
WETTED = 0.99  # m2, table 4.5
DEPTHS = {1.5: 0.21, 2.0: 0.28, 2.5: 0.35, 4.0: 0.56, 9.0: 1.26}  # m by h/T, table 4.5
DEPTH_FROUDE = {  # table 4.7
    1.5: (0.35, 0.43, 0.51, 0.61, 0.69),
    2.0: (0.30, 0.45, 0.53, 0.60, 0.76),
    2.5: (0.27, 0.40, 0.47, 0.54, 0.68, 0.76),
    4.0: (0.21, 0.32, 0.37, 0.42, 0.54, 0.64),
    9.0: (0.14, 0.21, 0.28, 0.35, 0.42, 0.49),
}
FROUDE = {  # table 4.7
    1.5: (0.14, 0.18, 0.21, 0.25, 0.29),
    2.0: (0.14, 0.21, 0.25, 0.29, 0.36),
    2.5: (0.14, 0.21, 0.25, 0.29, 0.36, 0.40),
    4.0: (0.14, 0.21, 0.25, 0.29, 0.36, 0.43),
    9.0: (0.14, 0.21, 0.28, 0.36, 0.43, 0.50),
}
DRAG = {  # 10³ C_t of table 4.7
    1.5: (18.28, 20.30, 24.04, 51.27, 95.16),
    2.0: (14.95, 17.81, 24.87, 34.43, 79.09),
    2.5: (12.22, 14.16, 19.83, 28.24, 54.15, 70.08),
    4.0: (11.04, 13.43, 15.83, 22.90, 32.27, 50.48),
    9.0: (11.34, 12.16, 19.88, 29.81, 36.26, 52.63),
}
BOW_UP, BOW_UP_FROUDE = 1.3, 0.46  # m/s and F_n where the trim changes its sign, 4.4.1
CROSS_FLOW = 1.325  # C_D, 8.1.3
TRIM = "table 4.7 prints F_n = 0.36 at 1.26 m/s and 0.40 at 1.41 m/s."


def coefficient_rows() -> list[Row]:
    """Froude numbers and C_t of table 4.7 by their worst points, and the cross-flow drag of the simulator."""
    boat = load_boat(FULL)
    assert isinstance(boat.resistance, TankResistance)
    speeds = {curve.h_over_t: np.array(curve.speed) for curve in boat.resistance.table}
    drags = {curve.h_over_t: np.array(curve.resistance) for curve in boat.resistance.table}
    by_length = {depth: speed / math.sqrt(GRAVITY * boat.length) for depth, speed in speeds.items()}
    by_depth = {depth: speed / math.sqrt(GRAVITY * DEPTHS[depth]) for depth, speed in speeds.items()}
    total = {
        depth: 2e3 * drags[depth] / (TANK_DENSITY * WETTED * speed**2) for depth, speed in speeds.items()
    }
    froude = BOW_UP / math.sqrt(GRAVITY * boat.length)
    return [
        worst_row("F_n", FROUDE, by_length),
        worst_row("F_nH", DEPTH_FROUDE, by_depth),
        worst_row("10³ C_t", DRAG, total),
        _row(f"F_n at {BOW_UP:g} m/s", "4.4.1", BOW_UP_FROUDE, froude, TRIM),
        _row("cross-flow drag C_D", "8.1.3", CROSS_FLOW, boat.hull.c_d),
    ]


def worst_row(name: str, printed: dict[float, tuple[float, ...]], ours: dict[float, Array]) -> Row:
    """The point of a column of table 4.7 that ours is furthest from, as a share."""
    pairs = [pair for depth, row in printed.items() for pair in zip(row, ours[depth], strict=True)]
    value, found = max(pairs, key=lambda pair: abs(pair[1] / pair[0] - 1.0))
    return _row(f"{name}, the worst of {len(pairs)} points", "table 4.7", value, float(found))


def _row(what: str, source: str, value: float, ours: float, reason: str = "") -> Row:
    nan, against = math.nan, bool(reason)
    return Row(what, source, f"{value:g}", value, ours, nan, FULL, reason=reason, contradicted=against)

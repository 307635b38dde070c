"""Squat by formula against what the towing tank measured, the thesis's table 4.7."""

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from swamp_rl.boat import load_boat
from swamp_rl.boat.squat import squat

SQUAT = {  # depth [m] as h/T and T = 0.14 m give it: speed [m/s], squat [mm]
    0.21: ((0.50, 4.80), (0.62, 8.50), (0.74, 15.05), (0.88, 32.10), (1.00, 58.32)),
    0.28: ((0.50, 3.48), (0.74, 10.72), (0.88, 17.70), (1.00, 32.52), (1.26, 84.82)),
    0.35: ((0.50, 2.86), (0.74, 10.51), (0.88, 16.19), (1.00, 21.34), (1.26, 55.01), (1.41, 70.22)),
    0.56: ((0.50, 1.02), (0.74, 5.51), (0.88, 11.49), (1.00, 16.63), (1.25, 33.67), (1.51, 64.05)),
}


def ratios(depth: float) -> np.ndarray:
    """Formula over measurement [1] at each speed of a depth [m], the fastest last."""
    boat = load_boat("swamp")
    return np.array([1e3 * squat(boat, speed, depth) / printed for speed, printed in SQUAT[depth]])


def squat_table() -> str:
    """Formula over measurement by depth: the median, the most, and at the highest speed."""
    rows = []
    for depth, points in SQUAT.items():
        found = ratios(depth)
        cells = [f"{value:.2f}" for value in (np.median(found), found.max(), found[-1])]
        rows.append([f"{depth:g}", str(len(points)), f"{points[-1][1]:.1f}", *cells])
    head = ["depth, m", "points", "greatest measured, mm", "formula / measured: median", "most"]
    return table([*head, "at the highest speed"], rows)

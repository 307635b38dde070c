"""Paper 003's identification: table I from the simulated square of a twin, and the replay.

    python -m benchmarks.validation.identification

writes the tables and the figure of docs/typhoon.md.
"""

import math
import shutil
import tempfile
from functools import lru_cache
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.reports.waypoint_square import write_square

from benchmarks.markers import DOCS, write_parts
from benchmarks.validation.check import Check, check
from swamp_rl.identification.square_twin import load_vehicle, sail
from swamp_rl.identification.waypoint_square import AXES, Found, identify, replay, track_error

SHARE = 0.05
LENGTH, DIAMETER, DENSITY = 3.3, 0.33, 1025.0  # m and m, 004; kg/m3
NOISES = 20
TABLE_I = ((180.0, 58.7), (180.0, 1230.0), (279.0, 1830.0))


@lru_cache(maxsize=1)
def squares() -> list[tuple[list[Found], np.ndarray, float]]:
    """What is found, the track error (T,) [m] and the length [m] with each draw of the sensors' noise."""
    vehicle = load_vehicle("typhoon")
    found = []
    for seed in range(NOISES):
        log = sail(vehicle, seed)
        one = identify(vehicle, log)
        found.append((one, track_error(log, replay(vehicle, log, one)), log.length))
    return found


def identification_checks() -> list[Check]:
    """Table I and II of 003, by the medians over the draws of the noise."""
    found = []
    for axis, name in enumerate(AXES):
        for which, (symbol, printed) in enumerate(zip(("mass", "drag"), TABLE_I[axis], strict=True)):
            values = [one[axis].estimates[which].value for one, _, _ in squares() if one[axis].estimates]
            reason = "the elementary motion holds few seconds of acceleration; its 95 % interval is wide."
            what, ours = f"{name} {symbol}, recovered", float(np.median(values))
            found.append(check(what, "003 table I", printed, ours, SHARE, reason=reason))
    errors = np.array([[e.mean(), e.max(), e.std()] for _, e, _ in squares()])
    mean, most, _ = np.median(errors, axis=0)
    found.append(
        Check("mean track error of the replay, m", "003 table II", "1.2", 0.0, 1.2, float(mean), SHARE)
    )
    found.append(Check("greatest track error, m", "003 table II", "2.4", 0.0, 2.4, float(most), SHARE))
    length = float(np.median([length for _, _, length in squares()]))
    found.append(check("length of the track, m, about", "003, IV", 70.0, length, SHARE))
    rms = math.sqrt(1.2**2 + 1.7**2)
    reason = (
        "errors from 0 to 2.4 m with mean 1.2 m have a deviation of at most 1.2 m; with 1.7 m their rms "
        f"would be {rms:.2f} m; 1.7 m can only be the rms."
    )
    widest = math.sqrt(1.2 * (2.4 - 1.2))
    what = "greatest deviation that mean 1.2 and max 2.4 allow, m"
    found.append(check(what, "003 table II", 1.7, widest, SHARE, reason=reason, contradicted=True))
    pressure = 0.5 * DENSITY
    frontal = 58.7 / (pressure * math.pi / 4.0 * DIAMETER**2)
    plan = LENGTH * DIAMETER
    reason = (
        f"on the transversal section, which the text names, the printed D_11 = 58.7 gives {frontal:.2f}; on "
        f"the area L D it is {58.7 / pressure / plan:.2f}."
    )
    found.append(
        check("C_DX of D_11, frontal area", "003, IV", 0.09, frontal, SHARE, reason=reason, contradicted=True)
    )
    return found


def square_table() -> str:
    """Medians and spread over the draws of the noise."""
    rows = []
    for axis, name in enumerate(AXES):
        for which, what in enumerate(("mass", "drag")):
            found = [one[axis].estimates[which] for one, _, _ in squares() if one[axis].estimates]
            low, middle, high = np.quantile([one.value for one in found], (0.025, 0.5, 0.975))
            between, printed = f"{low:.4g} to {high:.4g}", f"{TABLE_I[axis][which]:g}"
            rows.append([f"{name} {what}, {found[0].unit}", printed, f"{middle:.4g}", between])
    means = [error.mean() for _, error, _ in squares()]
    low, middle, high = np.quantile(means, (0.025, 0.5, 0.975))
    rows.append(["mean track error, m", "1.2", f"{middle:.2f}", f"{low:.2f} to {high:.2f}"])
    rows.append(["length of the track, m", "about 70", f"{squares()[0][2]:.1f}", ""])
    return table(["number", "003", "median", "95 % of the draws"], rows)


def main() -> None:
    """Write the table and the figure of docs/typhoon.md."""
    write_parts(DOCS / "typhoon.md", {"square": square_table()})
    with tempfile.TemporaryDirectory() as name:
        write_square(Path(name) / "square", "typhoon", 0)
        shutil.copy(Path(name) / "square/square.png", DOCS / "typhoon_square.png")


if __name__ == "__main__":
    main()

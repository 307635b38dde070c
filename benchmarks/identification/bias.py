"""What the papers' regressions find where the truth is known, beside rollout fitting; docs/identification.md.

python -m benchmarks.identification.bias
"""

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.identification.common import DT, NOISE
from benchmarks.identification.forces import TRUE, deduction_rows, elementary_rows
from benchmarks.identification.yaw import (
    implied_rows,
    measured_rows,
    own_motion,
    own_rows,
    simulator_rows,
)
from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import load_boat
from swamp_rl.identification.elementary import identify_surge, identify_yaw
from swamp_rl.identification.estimate import Estimate
from swamp_rl.identification.motion import motion_of
from swamp_rl.identification.simulated import ahead_by_steps, on_the_spot, record_run
from swamp_rl.identification.yaw_model import NAMES, PUBLISHED, by_pseudo_inverse

MEASURED_HEAD = ["azimuth, deg", "speed, m/s", "measured diameter", "Table III: rad/s", "its diameter"]
IMPLIED_HEAD = ["azimuth, deg", "speed, m/s", "simulator: rad/s", "diameter", "Table III: rad/s", "diameter"]
IMPLIED_HEAD.append("its time constant, s")


def interval_rows() -> list[list[str]]:
    """One seed's estimates with their own intervals, at full noise."""
    rng = np.random.default_rng(1)
    boat = load_boat("swamp-thesis")
    yaw = by_pseudo_inverse(own_motion(1.0, 1), PUBLISHED.inertia)[1]
    ahead = identify_surge(motion_of(record_run(TRUE, ahead_by_steps(TRUE, DT), DT, NOISE, rng), TRUE), boat)
    spot = identify_yaw(motion_of(record_run(TRUE, on_the_spot(TRUE, DT), DT, NOISE, rng), TRUE), boat)
    named = [*zip(NAMES, yaw, PUBLISHED[:4], strict=True)]
    rows = [[name, f"{true:.3g}", between(one)] for name, one, true in named]
    rows.append(["M_11", "66.9", between(ahead[0])])
    rows.append(["M_66", f"{1.2 * boat.inertia_z - boat.added_inertia_yaw:.3g}", between(spot[0])])
    return rows


def between(one: Estimate) -> str:
    """Value and interval."""
    return f"{one.value:.3g} {one.unit}, {one.low:.3g} to {one.high:.3g}"


def main() -> None:
    """Write the tables."""
    own = ["noise", "method", "damping, N m s", "b_r, N m/rad", "steady rate, rad/s"]
    elementary = ["motion", "noise", "method", "mass or inertia", "drag"]
    parts = {
        "measured circles": table(MEASURED_HEAD, measured_rows()),
        "simulated circles": table(IMPLIED_HEAD, implied_rows()),
        "fits to the simulator": table(["model", *NAMES, "misfit"], simulator_rows()),
        "equation 2": table(own, own_rows()),
        "elementary motions": table(elementary, elementary_rows()),
        "thrust deduction": table(["throttle", "method", "truth", "1 - t"], deduction_rows()),
        "intervals": table(["", "truth", "estimate"], interval_rows()),
    }
    write_parts(DOCS / "identification.md", parts)


if __name__ == "__main__":
    main()

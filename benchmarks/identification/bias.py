"""What the papers' regressions find where the truth is known, beside rollout fitting; docs/identification.md.

python -m benchmarks.identification.bias
"""

import math
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.identification.common import DT, NOISE, SEEDS
from benchmarks.identification.forces import CURRENT, TRUE, deduction_rows, elementary_rows
from benchmarks.identification.yaw import (
    SPEED,
    implied_rows,
    measured_rows,
    own_motion,
    own_rows,
    simulator_rows,
)
from swamp_rl.boat import load_boat
from swamp_rl.identification.elementary import identify_surge, identify_yaw
from swamp_rl.identification.estimate import Estimate
from swamp_rl.identification.motion import motion_of
from swamp_rl.identification.simulated import ahead_by_steps, on_the_spot, record_run
from swamp_rl.identification.yaw_model import NAMES, PUBLISHED, by_pseudo_inverse

ROOT = Path(__file__).resolve().parents[2]
MEASURED_HEAD = ["azimuth, deg", "speed, m/s", "measured diameter", "Table III: rad/s", "its diameter"]
IMPLIED_HEAD = ["azimuth, deg", "speed, m/s", "simulator: rad/s", "diameter", "Table III: rad/s", "diameter"]
IMPLIED_HEAD.append("its time constant, s")


def interval_rows() -> list[list[str]]:
    """One seed's estimates with their own intervals, at full noise."""
    rng = np.random.default_rng(1)
    boat = load_boat("swamp")
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


def document() -> str:
    """The text of docs/identification.md."""
    noise = f"{NOISE[3]} m/s, {NOISE[5]} rad/s, positions {NOISE[0]} m, heading {NOISE[2]} rad"
    thrust = 4 * 0.35 * 12.2 * 0.6**2
    in_their_terms = thrust * PUBLISHED.inertia / 11.82
    constant = PUBLISHED.time_constant(SPEED)
    steady = PUBLISHED.steady_rate(math.radians(30), SPEED)
    return f"""# Identification as the papers do it, and its bias

Written by `python -m benchmarks.identification.bias`. Simulated runs of known truth at {1 / DT:.0f} Hz; full
noise is {noise}; {SEEDS} seeds. Figures are
mean ± standard deviation over the seeds, and the bias in percent of the truth. *Rollout* fits the same
numbers to the motion itself: for eq. 1 `swamp_rl.identification.yaw_model.by_rollout`, else the fit of
`swamp_rl.criticism`. On recorded runs: `swamp-rl identify yaw-model | elementary | thrust-deduction DATASET`.

## What Table III of paper 002 implies

With δ in radians: time constant {constant:.2f} s and {steady:.3f} rad/s for 30 deg at {SPEED} m/s; no steady
turn at all from {PUBLISHED.unstable_above:.2f} m/s, for c_ru is positive: the faster the boat, the less the
model damps. At the speeds that the thesis measured in circles (diameters 2 U / r, in m):

{table(MEASURED_HEAD, measured_rows())}

At the simulator's own steady speeds (48 kg, four jets at 60 %, bow and stern opposed):

{table(IMPLIED_HEAD, implied_rows())}

Its b_r belongs with I_r = {PUBLISHED.inertia} kg m2, the boat's without the water's. The jets give
4 · 0.35 m · T, {thrust:.1f} N m/rad at 60 % before thrust deduction; with the water's inertia (11.8 kg m2 in
the boat file) in eq. 1 this would be {in_their_terms:.1f} in the paper's terms, where it has {PUBLISHED.b_r}.
The same eq. 1 fitted to the simulator's zig-zags of 10, 20 and 30 deg without noise, and how far its yaw
rate is from the simulator's after a start at the true value (root mean square over 10 s, rad/s):

{table(["model", *NAMES, "misfit"], simulator_rows())}

So the four numbers are no properties of the boat: sway, yaw rate and azimuth move together in a zig-zag, and
the regression shares their effects out as it can.

## Eq. 2 against rollout, the truth being Table III itself

A zig-zag that obeys eq. 1 to the letter. Damping is -(k_r + c_ru |u|) at {SPEED} m/s; steady rate at 30 deg.

{table(["noise", "method", "damping, N m s", "b_r, N m/rad", "steady rate, rad/s"], own_rows())}

## Paper 003: bounded least squares on elementary motions

The true boat has 64 kg (boat file 58), 1.15 of the resistance, 1.2 of the yaw inertia and 1.1 of the cross
flow's drag. Mass and inertia are with the water's; the drag's truth is the quadratic nearest to the true
curve.

{table(["motion", "noise", "method", "mass or inertia", "drag"], elementary_rows())}

Mass comes from the derivative of a noisy velocity, which is the regressor: it shrinks towards zero, whatever
the bounds allow.

## Thesis 7.3.5: thrust deduction, eq. 7.3

The true boat has 0.9 of the thrust and lies in a current of {CURRENT} m/s along its way. Full noise, runs of
60 s, the first half left out.

{table(["throttle", "method", "truth", "1 - t"], deduction_rows())}

## The methods' own intervals

95 % by resampled blocks of 5 s, one seed at full noise, no smoothing. They show scatter, not bias:

{table(["", "truth", "estimate"], interval_rows())}
"""


def main() -> None:
    """Write the document."""
    (ROOT / "docs" / "identification.md").write_text(document(), encoding="utf-8")


if __name__ == "__main__":
    main()

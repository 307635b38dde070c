"""Paper 003's least squares and the thesis's thrust deduction for docs/identification.md, beside rollout."""

import math

import numpy as np

from benchmarks.identification.common import DT, LEVELS, NOISE, SEEDS, SMOOTH, spread, with_effects
from benchmarks.identification.rollout import fitted
from swamp_rl.boat import load_boat
from swamp_rl.identification.deduction import deduction_points, paired, resistance_at
from swamp_rl.identification.elementary import identify_surge, identify_yaw, surge_motion, yaw_motion
from swamp_rl.identification.motion import motion_of, motions_of
from swamp_rl.identification.simulated import ahead_by_steps, on_the_spot, record_run, straights
from swamp_rl.runs import Run
from swamp_rl.simulator import parameters

THROTTLES = (0.4, 0.7, 1.0)
CURRENT = 0.1  # m/s
TRUE = with_effects(
    {"effect": "mass", "mass": 64.0},
    {"effect": "resistance", "scale": 1.15},
    {"effect": "yaw_inertia", "scale": 1.2},
    {"effect": "sway_drag", "scale": 1.1},
)
WEAK = with_effects(
    {"effect": "thrust_scale", "scale": 0.9}, {"effect": "current", "north": CURRENT, "east": 0.0}
)


def reference_drag(run: Run, axis: int) -> float:
    """Quadratic coefficient [N s2/m2 or N m s2] nearest to the true drag on a noise-free run."""
    motion = motion_of(run, TRUE)
    part = surge_motion(motion) if axis == 0 else yaw_motion(motion)
    speed = part.velocity[:, axis]
    square = speed * np.abs(speed)
    if axis == 0:
        drag = np.array([math.copysign(resistance_at(TRUE, value), value) for value in speed])
    else:
        q = 0.5 * TRUE.water_density * TRUE.length * TRUE.draught
        record = parameters(TRUE)[0]
        drag = q * record["c_d"] * record["c_rn"] ** 2 * TRUE.length**3 / 32 * square
    return float((drag * square).sum() / (square**2).sum())


def elementary_rows() -> list[list[str]]:
    """Mass and drag in surge, inertia and drag in yaw, by regression and by rollout."""
    boat = load_boat("swamp-thesis")
    rows = []
    motions = (("surge", 0, ahead_by_steps, identify_surge), ("yaw", 2, on_the_spot, identify_yaw))
    for name, axis, commands, identify in motions:
        clean = record_run(TRUE, commands(TRUE, DT), DT, 0 * NOISE, np.random.default_rng(0))
        mass = float(64.0 + 2.9 if axis == 0 else 1.2 * boat.inertia_z - boat.added_inertia_yaw)
        truth = (mass, reference_drag(clean, axis))
        for level, share in LEVELS.items():
            found: dict[str, list[tuple[float, float]]] = {}
            for seed in range(SEEDS if share else 1):
                rng = np.random.default_rng([axis, seed])
                run = record_run(TRUE, commands(TRUE, DT), DT, share * NOISE, rng)
                for method, smooth in (("least squares", 0.0), ("the same, smoothed 1 s", SMOOTH)):
                    both = identify(motion_of(run, TRUE, smooth), boat)
                    found.setdefault(method, []).append((both[0].value, both[1].value))
                found.setdefault("rollout", []).append(by_rollout_of(run, axis, truth[1]))
            for method, values in found.items():
                columns = zip(np.array(values).T, truth, strict=True)
                rows.append([name, level, method, *(spread(column, true) for column, true in columns)])
    return rows


def by_rollout_of(run: Run, axis: int, reference: float) -> tuple[float, float]:
    """Mass or inertia with the water's, and drag, of the simulator fitted to the run."""
    boat = load_boat("swamp-thesis")
    if axis == 0:
        fit = fitted([run], boat, ("mass", "resistance"))
        mass, scale = fit["mass"][0], fit["resistance"][0]
        return mass + 2.9, reference * scale / 1.15 * (mass / 64.0) ** (2 / 3)
    fit = fitted([run], boat, ("yaw_inertia", "sway_drag"))
    inertia = fit["yaw_inertia"][0] * boat.inertia_z - boat.added_inertia_yaw
    return inertia, reference * fit["sway_drag"][0] / 1.1


def true_factor(throttle: float) -> float:
    """1 - t [1] of the weak boat."""
    given = load_boat("swamp-thesis").thrust_deduction
    assert given is not None
    ends = [given.throttle_low, given.throttle_high], [given.factor_low, given.factor_high]
    return 0.9 * float(np.interp(throttle, *ends))


def deduction_rows() -> list[list[str]]:
    """1 - t by eq. 7.3, of one direction and of both, and by rollout with a current to be found."""
    boat = load_boat("swamp-thesis")
    found: dict[tuple[float, str], list[float]] = {}
    for seed in range(SEEDS):
        for throttle in THROTTLES:
            rng = np.random.default_rng([seed, round(100 * throttle)])
            runs = [
                record_run(WEAK, straights(WEAK, DT, (throttle,), ahead), DT, NOISE, rng, name)
                for name, ahead in (("ahead", True), ("astern", False))
            ]
            points = deduction_points(motions_of(runs, boat), boat)
            if len(points) == 2:
                found.setdefault((throttle, "eq. 7.3, ahead"), []).append(points[0].factor)
                found.setdefault((throttle, "eq. 7.3, astern"), []).append(points[1].factor)
                both = paired(points, boat)[throttle]
                found.setdefault((throttle, "eq. 7.3, mean speed of both"), []).append(both)
            scale = fitted(runs, boat, ("thrust_scale", "current"))["thrust_scale"][0]
            found.setdefault((throttle, "rollout"), []).append(scale * true_factor(throttle) / 0.9)
    return [
        [f"{throttle:.0%}", method, f"{true_factor(throttle):.3f}", spread(values, true_factor(throttle))]
        for (throttle, method), values in sorted(found.items())
    ]

"""The yaw model of paper 002 for docs/identification.md: what it implies, and the bias of eq. 2."""

import math

import numpy as np

from benchmarks.identification.common import DT, LEVELS, NOISE, SEEDS, SMOOTH, spread
from swamp_rl.boat import Boat, load_boat
from swamp_rl.identification.motion import Motion, motions_of
from swamp_rl.identification.simulated import record_run, zigzag
from swamp_rl.identification.yaw_model import PUBLISHED, YawModel, by_pseudo_inverse, by_rollout, rollout
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.state import SURGE, SWAY, YAW_RATE

SPEED = 0.8  # m/s at which the yaw model's damping is stated
LIGHT = load_boat("swamp-light")


def circle(boat: Boat, angle: float) -> tuple[float, float, float]:
    """Steady surge, sway [m/s], yaw rate [rad/s] of the simulator, bow and stern opposed, throttle 60 %."""
    params = parameters(boat)
    row = np.array([angle, angle, -angle, -angle, 0.6, 0.6, 0.6, 0.6])
    commands = np.tile(row, (1, 1200, 1))
    start = initial_state(params, np.zeros((1, 3)), np.array([[0.8, 0.0, 0.0]]))
    end = simulate(params, tank(boat), start, commands, np.zeros(1, np.uint64), DT, 2)[0, -1]
    return float(end[SURGE]), float(end[SWAY]), float(end[YAW_RATE])


def implied_rows() -> list[list[str]]:
    """Table III at the simulator's own steady speeds, beside the simulator's yaw rates."""
    rows = []
    for degrees in (10, 20, 30, 40, 60):
        u, v, r = circle(LIGHT, math.radians(degrees))
        steady = PUBLISHED.steady_rate(math.radians(degrees), u, v)
        constant = PUBLISHED.time_constant(u, v)
        speed = math.hypot(u, v)
        rows.append(
            [
                f"{degrees}",
                f"{speed:.2f}",
                f"{r:.3f}",
                f"{2 * speed / r:.1f}",
                f"{steady:.3f}",
                f"{2 * speed / steady:.1f}",
                f"{constant:.2f}",
            ]
        )
    return rows


def measured_rows() -> list[list[str]]:
    """Table III at the speeds that the thesis measured in circles."""
    rows = []
    for degrees, speed, diameter in ((30, 1.0, "almost 9"), (60, 0.5, "under 2")):
        steady = PUBLISHED.steady_rate(math.radians(degrees), speed)
        rows.append([f"{degrees}", f"{speed:g}", diameter, f"{steady:.3f}", f"{2 * speed / steady:.1f}"])
    return rows


def simulator_rows() -> list[list[str]]:
    """Eq. 1 fitted to the simulator's own zig-zags without noise."""
    rng = np.random.default_rng(0)
    runs = [
        record_run(LIGHT, zigzag(LIGHT, DT, math.radians(degrees)), DT, 0 * NOISE, rng, f"zigzag-{degrees}")
        for degrees in (10, 20, 30)
    ]
    motion = motions_of(runs, LIGHT)
    regressed = by_pseudo_inverse(motion, PUBLISHED.inertia)[0]
    rolled = by_rollout(motion, regressed)
    rows = []
    for name, model in (("Table III", PUBLISHED), ("pseudo-inverse", regressed), ("rollout", rolled)):
        misfit = rollout_misfit(motion, model)
        rows.append([name, *(f"{value:.2f}" for value in model[:4]), f"{misfit:.3f}"])
    return rows


def rollout_misfit(motion: Motion, model: YawModel) -> float:
    """Root mean square [rad/s] of the yaw rate that the model predicts over 10 s from a measured start."""
    rows = round(10.0 / motion.step)
    cut = np.arange(len(motion.time) // rows * rows).reshape(-1, rows)
    u, v, r = (motion.velocity[cut, i] for i in range(3))
    predicted = rollout(model, r[:, 0], u, v, motion.steering[cut], motion.step)
    return float(np.sqrt(np.mean((predicted - r) ** 2)))


def own_motion(noise: float, seed: int) -> Motion:
    """120 s that obey eq. 1 with Table III to the letter, velocities measured with a share of the noise."""
    rng = np.random.default_rng(seed)
    rate = 10
    time = np.arange(1200 * rate) * DT / rate
    angle = 0.35 * np.where((time // 8.0) % 2 == 0, 1.0, -1.0)
    surge, sway = SPEED + 0.15 * np.sin(0.3 * time), 0.15 * np.sin(2 * math.pi * time / 16.0)
    r = rollout(PUBLISHED, np.zeros(1), surge[None], sway[None], angle[None], DT / rate)[0]
    true = np.column_stack([surge, sway, r])[::rate]
    velocity = true + noise * NOISE[3:] * rng.standard_normal(true.shape)
    n = len(true)
    derivative = np.gradient(velocity, DT, axis=0)
    return Motion(time[::rate], velocity, derivative, np.zeros((n, 3)), angle[::rate], np.full(n, 0.6), (n,))


def smoothed(motion: Motion) -> Motion:
    """The same rows after a quadratic smoother of 1 s."""
    from scipy.signal import savgol_filter

    rows = 2 * round(SMOOTH / DT / 2) + 1
    derivative = savgol_filter(motion.velocity, rows, 2, deriv=1, delta=DT, axis=0)
    return motion._replace(velocity=savgol_filter(motion.velocity, rows, 2, axis=0), derivative=derivative)


def own_rows() -> list[list[str]]:
    """Damping at 0.8 m/s, b_r and the steady yaw rate by three methods at three noise levels."""
    angle = math.radians(30)
    truth = (PUBLISHED.damping(SPEED), PUBLISHED.b_r, PUBLISHED.steady_rate(angle, SPEED))
    rows = []
    for level, share in LEVELS.items():
        found: dict[str, list[YawModel]] = {"pseudo-inverse": [], "the same, smoothed 1 s": [], "rollout": []}
        for seed in range(SEEDS if share else 1):
            motion = own_motion(share, seed)
            raw = by_pseudo_inverse(motion, PUBLISHED.inertia)[0]
            found["pseudo-inverse"].append(raw)
            found["the same, smoothed 1 s"].append(by_pseudo_inverse(smoothed(motion), PUBLISHED.inertia)[0])
            found["rollout"].append(by_rollout(motion, raw))
        for method, models in found.items():
            figures = [(m.damping(SPEED), m.b_r, m.steady_rate(angle, SPEED)) for m in models]
            columns = zip(np.array(figures).T, truth, strict=True)
            rows.append([level, method, *(spread(values, true) for values, true in columns)])
    return rows

"""Runs and motions of known truth for tests of identification."""

import math
from pathlib import Path

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.identification.motion import Motion
from swamp_rl.identification.yaw_model import PUBLISHED, rollout
from swamp_rl.runs import Run, append_run, create_dataset
from swamp_rl.runs.schema import meta_of

QUIET = np.zeros(6)
NOISY = np.array([0.3, 0.3, 0.02, 0.03, 0.03, 0.01])


def own_motion(noise: float, dt: float = 0.02, seed: int = 0) -> Motion:
    """60 s of exactly eq. 1 with Table III, under a zig-zag, its yaw rate measured with `noise` [rad/s]."""
    time = np.arange(3000) * dt
    angle = 0.35 * np.sign(np.sin(2 * math.pi * time / 9.0) + 1e-9)
    surge, sway = 0.8 + 0.1 * np.sin(0.3 * time), 0.1 * np.sin(0.7 * time)
    r = rollout(PUBLISHED, np.zeros(1), surge[None], sway[None], angle[None], dt)[0]
    r = r + noise * np.random.default_rng(seed).standard_normal(len(r))
    velocity = np.column_stack([surge, sway, r])
    derivative = np.gradient(velocity, time, axis=0)
    if noise == 0.0:
        damping = PUBLISHED.k_r + PUBLISHED.c_ru * np.abs(surge) + PUBLISHED.c_rv * np.abs(sway)
        derivative[:, 2] = (damping * r + PUBLISHED.b_r * angle) / PUBLISHED.inertia
    return Motion(time, velocity, derivative, np.zeros_like(velocity), angle, np.full(3000, 0.6), (3000,))


def folder_of(path: Path, boat: Boat, runs: list[Run]) -> Path:
    meta = meta_of(boat, boat.name, 10.0, "simulated")
    create_dataset(path, meta)
    for run in runs:
        append_run(path, run)
    return path

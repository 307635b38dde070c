"""An independent program on the same equations, written from the sources, tracks the simulator to 1 mm."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from swamp_rl.boat import load_boat
from swamp_rl.runs import Run
from swamp_rl.simulator.replay import replay

Array = NDArray[np.float64]

STEP = 0.005  # s, of the independent program
PLACES = {"bs": (0.35, 0.40), "bp": (0.35, -0.40), "ss": (-0.35, 0.40), "sp": (-0.35, -0.40)}
TOWED_DEEP = PchipInterpolator(  # table 4.7 at h/T = 9: R / U^2
    [0.49, 0.73, 0.99, 1.24, 1.49, 1.74],
    [
        r / u**2
        for u, r in ((0.49, 1.38), (0.73, 3.25), (0.99, 9.68), (1.24, 22.97), (1.49, 40.30), (1.74, 79.44))
    ],
)
# mass, draught, inertia, added masses in surge, sway, yaw, spacing, azimuth rate [deg/s], c of V_a/V_o
NUMBERS: dict[str, Any] = {
    "swamp": (58.0, 0.14, 7.88, 2.9, 23.2, 3.94, 0.80, 246.1, 0.86),
    "swamp-light": (48.0, 0.115, 7.58, 2.4, 19.2, 3.79, 0.80, 246.1, 0.86),
    "swamp-thesis": (58.0, 0.14, 7.88, 2.9, 23.2, 3.94, 0.0, 492.0, 0.0),
}
STATIONS, WEIGHTS = np.polynomial.legendre.leggauss(400)


def towed(u: float, v: float, mass: float) -> float:
    """X [N] of the whole hull at surge u and sway v."""
    speed = math.hypot(u, v)
    k = float(TOWED_DEEP(min(max(speed, 0.49), 1.74)))
    return -k * u * speed * 1025.0 / 1001.0 * (mass / 58.0) ** (2 / 3)


def acceleration(name: str, u: float, v: float, r: float, angles: Array, throttles: Array) -> Array:
    """u', v', r' by 8.14 and 8.16."""
    mass, draught, inertia, mx, my, jz, spacing, _, loss = NUMBERS[name]
    length, q = 1.24, 0.5 * 1025.0 * 1.24 * draught
    drag = -0.0591 * length / draught + 1.848
    x = 0.5 * length * STATIONS
    w = v + 0.942 * r * x
    cross = 0.5 * length * np.array([np.sum(WEIGHTS * np.abs(w) * w), np.sum(WEIGHTS * np.abs(w) * w * x)])
    half = 0.5 * spacing
    hulls = [(y, 0.5 * towed(u - r * y, v, mass)) for y in (half, -half)]
    surge = sum(f for _, f in hulls) + q * 0.168 * length * v * r
    sway = q * (-0.54 * v * abs(u) + 0.066 * length * r * u - drag / length * cross[0])
    yaw = q * length * (-0.226 * v * u - 0.135 * length * r * abs(u) - drag / length**2 * cross[1])
    yaw -= sum(y * f for y, f in hulls)
    for (px, py), angle, p in zip(PLACES.values(), angles, throttles, strict=True):
        thrust = 12.2 * p * p
        if name == "swamp-thesis":
            thrust *= min(max(0.30 + 0.45 * (p - 0.3) / 0.7, 0.30), 0.75)
        if loss and thrust:
            advance = (u - r * py) * math.cos(angle) + (v + r * px) * math.sin(angle)
            thrust *= max(1.0 - loss * advance / math.sqrt(thrust / (1025.0 * 900e-6)), 0.0)
        fx, fy = thrust * math.cos(angle), thrust * math.sin(angle)
        surge, sway, yaw = surge + fx, sway + fy, yaw + px * fy - py * fx
    return np.array(
        [(surge + mass * v * r) / (mass + mx), (sway - mass * u * r) / (mass + my), yaw / (inertia + jz)]
    )


def independent(name: str, commands: Array) -> Array:
    """(T, 3) north, east [m], heading [rad] at 10 Hz from rest under commands (T, 8) at 10 Hz."""
    limit = math.radians(NUMBERS[name][7])

    def slope(state: Array, throttles: Array) -> Array:
        u, v, r = state[3:6]
        cos, sin = math.cos(state[2]), math.sin(state[2])
        moved = [u * cos - v * sin, u * sin + v * cos, r]
        return np.concatenate([moved, acceleration(name, u, v, r, state[6:], throttles)])

    state, track = np.concatenate([np.zeros(6), commands[0, :4]]), []
    for command in commands:
        track.append(state[:3].copy())
        for _ in range(round(0.1 / STEP)):
            # the motors' angles at the middle and the end of the step, by the same equation finely integrated
            angles = [state[6:]]
            for _ in range(2):
                turned = angles[-1].copy()
                for _ in range(20):
                    rate = np.clip((command[:4] - turned) / 0.1, -limit, limit)
                    turned = turned + rate * STEP / 40
                angles.append(turned)
            stages: list[Array] = []
            for ahead, angle in ((0.0, angles[0]), (0.5, angles[1]), (0.5, angles[1]), (1.0, angles[2])):
                at = state[:6] + (ahead * STEP * stages[-1] if stages else 0.0)
                stages.append(slope(np.concatenate([at, angle]), command[4:]))
            mean = (stages[0] + 2 * stages[1] + 2 * stages[2] + stages[3]) / 6
            state = np.concatenate([state[:6] + STEP * mean, angles[2]])
    return np.array(track)


def steered(seed: int, rows: int = 101) -> Array:
    """(T, 8) azimuths and throttles that change every second."""
    rng = np.random.default_rng(seed)
    chosen = np.hstack(
        [rng.uniform(-1.2, 1.2, (rows // 10 + 1, 4)), rng.uniform(0.2, 1.0, (rows // 10 + 1, 4))]
    )
    return np.repeat(chosen, 10, axis=0)[:rows]


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("seed", range(2))
def test_ten_seconds_of_open_loop_agree_with_an_independent_program(
    name: str, seed: int, tmp_path: Path
) -> None:
    commands = steered(seed)
    time = 0.1 * np.arange(len(commands))
    columns = {"time": time} | dict.fromkeys(
        ("north", "east", "heading", "surge", "sway", "yaw_rate"), 0.0 * time
    )
    for k, thruster in enumerate(PLACES):
        columns |= {f"azimuth_{thruster}": commands[:, k], f"throttle_{thruster}": commands[:, 4 + k]}
    found = replay(load_boat(name), Run("open-loop", columns)).pose
    known = independent(name, commands)
    off = found - known
    assert np.hypot(off[:, 0], off[:, 1]).max() < 1e-3
    assert np.abs(np.unwrap(found[:, 2]) - known[:, 2]).max() < 1e-3

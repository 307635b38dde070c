"""Numbers of effects at random, as a blind case hides them."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

Rng = np.random.Generator
RUNS = 5  # of a case


def signed(rng: Rng, typical: float, size: float) -> float:
    """+- typical times size."""
    return float(rng.choice([-1.0, 1.0]) * typical * size)


def thruster(rng: Rng, level: str) -> str:
    """One that the data can show: gate runs use the bow's alone."""
    return str(rng.choice(["bs", "bp"] if level == "C" else ["bs", "bp", "ss", "sp"]))


def polar(rng: Rng, length: float) -> dict[str, float]:
    """A vector of that length in any direction."""
    angle = rng.uniform(-math.pi, math.pi)
    return {"north": length * math.cos(angle), "east": length * math.sin(angle)}


def drift(rng: Rng, size: float) -> dict[str, float]:
    """A current that turns into another within a run."""
    rates = polar(rng, 0.003 * size)
    return polar(rng, 0.08 * size) | {"north_rate": rates["north"], "east_rate": rates["east"]}


def swap(rng: Rng) -> list[str]:
    """Two thrusters."""
    return [str(name) for name in rng.choice(["bs", "bp", "ss", "sp"], 2, replace=False)]


def scale(rng: Rng, share: float, size: float) -> float:
    """A scale that departs from 1 by a share either way."""
    return math.exp(signed(rng, share, size))


def wind_from(vector: dict[str, float]) -> dict[str, float]:
    """A wind from its components towards where it comes from [m/s]."""
    north, east = vector["north"], vector["east"]
    return {"speed": math.hypot(north, east), "from": math.atan2(east, north)}


def weather_by_run(rng: Rng, name: str, size: float) -> list[list[dict[str, Any]]]:
    """A wind or current of each run: Gaussian about a mean that all runs share."""
    mean, spread = WEATHER[name]
    common = polar(rng, mean * size)
    found = []
    for _ in range(RUNS):
        vector = {key: value + spread * size * rng.normal() for key, value in common.items()}
        found.append([{"effect": name} | (wind_from(vector) if name == "wind" else vector)])
    return found


# mean and standard deviation of a component over runs [m/s]
WEATHER = {"wind": (4.0, 2.0), "current": (0.08, 0.05)}
NOT_BESIDE_WEATHER = ("current", "drifting_current", "wind", "external_force")
Draw = Callable[[Rng, float, str], dict[str, Any]]
EFFECTS: dict[str, Draw] = {
    "current": lambda g, s, _: polar(g, 0.12 * s),
    "drifting_current": lambda g, s, _: drift(g, s),
    "wind": lambda g, s, _: {"speed": 5.0 * s, "from": float(g.uniform(-math.pi, math.pi))},
    "waves": lambda g, s, _: {
        "force": 4.0 * s,
        "frequency": float(g.uniform(0.1, 0.5)),
        "from": float(g.uniform(-math.pi, math.pi)),
    },
    "shallow_water": lambda g, s, _: {"depth_over_draught": 1.0 + 1.2 / min(s, 1.5)},
    "thruster_gain": lambda g, s, v: {"thruster": thruster(g, v), "gain": 1.0 + max(signed(g, 0.3, s), -0.9)},
    "thruster_failure": lambda g, s, v: {"thruster": thruster(g, v), "time": float(g.uniform(15.0, 60.0))},
    "azimuth_offset": lambda g, s, v: {
        "thruster": "all" if g.random() < 0.4 else thruster(g, v),
        "offset": signed(g, 0.15, s),
    },
    "azimuth_lag": lambda g, s, _: {"time_constant": 0.1 + 0.6 * s},
    "command_delay": lambda g, s, _: {"delay": 0.5 * s},
    "pump_lag": lambda g, s, _: {"time_constant": 0.8 * s},
    "channel_swap": lambda g, s, _: {"thruster": swap(g)},
    "azimuth_reversed": lambda g, s, v: {"thruster": "all" if g.random() < 0.3 else thruster(g, v)},
    "throttle_dead_band": lambda g, s, v: {"thruster": thruster(g, v), "below": 0.2 * s},
    "thruster_efficiency_curve": lambda g, s, v: (
        {"thruster": thruster(g, v)}
        | {name: math.exp(0.45 * s * g.uniform(-1.0, 1.0)) for name in ("at_30", "at_60", "at_100")}
    ),
    "thrust_scale": lambda g, s, _: {"scale": scale(g, 0.2, s)},
    "advance_thrust_loss": lambda g, s, _: {"factor": 0.8 * s},
    "crossflow_thrust_loss": lambda g, s, _: {"coefficient": 12.0 * s},
    "thrust_deduction": lambda g, s, _: {"low": 1.0 - 0.4 * s, "high": 1.0 - 0.1 * s},
    "thrust_sag": lambda g, s, _: {"rate": 0.004 * s},
    "resistance": lambda g, s, _: {"scale": scale(g, 0.35, s)},
    "linear_drag": lambda g, s, _: {"coefficient": 6.0 * s},
    "linear_sway_damping": lambda g, s, _: {"coefficient": 12.0 * s},
    "linear_yaw_damping": lambda g, s, _: {"coefficient": 3.0 * s},
    "drag_asymmetry": lambda g, s, _: {"astern": scale(g, 0.5, s), "port": scale(g, 0.4, s)},
    "mass": lambda g, s, _: {"mass": 58.0 * scale(g, 0.2, s)},
    "centre_of_gravity": lambda g, s, _: {"x_g": signed(g, 0.08, s)},
    "yaw_inertia": lambda g, s, _: {"scale": scale(g, 0.4, s)},
    "sway_drag": lambda g, s, _: {"scale": scale(g, 0.4, s)},
    "yaw_damping": lambda g, s, _: {"scale": scale(g, 0.5, s)},
    "demihull_spacing": lambda g, s, _: {"spacing": 0.8 * scale(g, 0.5, s)},
    "hull_asymmetry": lambda g, s, _: {"yaw_moment": signed(g, 2.0, s)},
    "external_force": lambda g, s, _: polar(g, 2.0 * s),
    "heading_bias": lambda g, s, _: {"bias": signed(g, 0.1, s)},
    "position_delay": lambda g, s, _: {"delay": 0.5 * s},
    "position_lever_arm": lambda g, s, _: (lambda p: {"x": p["north"], "y": p["east"]})(polar(g, 0.4 * s)),
    "gyro_bias": lambda g, s, _: {"bias": signed(g, 0.02, s)},
    "heading_drift": lambda g, s, _: {"rate": signed(g, 0.002, s)},
    "clock_offset": lambda g, s, _: {"offset": signed(g, 0.4, s)},
    "clock_drift": lambda g, s, _: {"rate": signed(g, 0.006, s)},
}

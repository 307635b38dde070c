"""Boats with effects, for tests: every effect far from neutral, records, tracks under lively commands."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import load_boat
from swamp_rl.effects import apply_effects, parse_effects
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.state import SURGE, YAW_RATE
from tests.support.boats import Array, commands

BOAT = load_boat("swamp-thesis")  # neutral in every effect
NAMES = BOAT.thruster_names
DT = 0.1
SURGE_MASS = BOAT.mass - BOAT.added_mass_surge
SWAY_MASS = BOAT.mass - BOAT.added_mass_sway
YAW_INERTIA = BOAT.inertia_z - BOAT.added_inertia_yaw
NO_RESISTANCE = {"effect": "resistance", "scale": 0.0}

STRONG: dict[str, dict[str, Any]] = {  # every effect far enough from neutral for anyone to see
    "current": {"north": 0.1, "east": -0.05},
    "drifting_current": {"north_rate": 0.002},
    "wind": {"speed": 5.0, "from": 1.0},
    "gusts": {"speed_std": 2.0},
    "waves": {"force": 3.0, "frequency": 0.3, "from": 0.5},
    "shallow_water": {"depth_over_draught": 2.0},
    "thruster_gain": {"thruster": "bs", "gain": 0.7},
    "thruster_failure": {"thruster": "ss", "time": 4.0},
    "thruster_kick": {"thruster": "sp", "time": 3.0, "duration": 2.0, "throttle": 1.0, "azimuth": 1.5},
    "azimuth_offset": {"thruster": "all", "offset": 0.1},
    "azimuth_lag": {"time_constant": 0.6},
    "command_delay": {"delay": 0.25},
    "pump_lag": {"time_constant": 0.5},
    "channel_swap": {"thruster": ["bs", "ss"]},
    "azimuth_reversed": {"thruster": "bs"},
    "throttle_reversed": {"thruster": "bs"},
    "throttle_dead_band": {"thruster": "bp", "below": 0.3},
    "thruster_efficiency_curve": {"thruster": "all", "at_30": 0.5, "at_60": 0.8, "at_100": 1.1},
    "thrust_scale": {"scale": 0.8},
    "advance_thrust_loss": {"factor": 1.0},
    "crossflow_thrust_loss": {"coefficient": 1.0},
    "thrust_deduction": {"low": 0.6, "high": 0.9},
    "thrust_sag": {"rate": 0.01},
    "low_battery": {"charge": 0.1},
    "resistance": {"scale": 1.4},
    "linear_drag": {"coefficient": 4.0},
    "linear_sway_damping": {"coefficient": 8.0},
    "linear_yaw_damping": {"coefficient": 3.0},
    "drag_asymmetry": {"astern": 1.8, "port": 1.5},
    "mass": {"mass": 48.0},
    "centre_of_gravity": {"x_g": 0.1},
    "yaw_inertia": {"scale": 1.5},
    "sway_drag": {"scale": 1.5},
    "yaw_damping": {"scale": 1.5},
    "hull_coefficients": {"y_v": 1.3},
    "demihull_spacing": {"spacing": 0.8},
    "hull_asymmetry": {"yaw_moment": 3.0},
    "wind_coefficients": {"c_x": 1.4, "c_y": 1.8, "lateral_centre": 0.3, "c_n": 0.1},
    "external_force": {"north": 2.0},
    "heading_bias": {"bias": 0.1},
    "position_delay": {"delay": 0.35},
    "position_lever_arm": {"x": 0.3, "y": -0.2},
    "gyro_bias": {"bias": 0.03},
    "heading_drift": {"rate": 0.002},
    "clock_offset": {"offset": -0.4},
    "clock_drift": {"rate": 0.01},
    "force_curve": {"component": "surge", "covariate": "speed", "knots": [0.0, 2.0], "values": [2.0, -3.0]},
}
EVERY_EFFECT = [{"effect": name} | numbers for name, numbers in STRONG.items()]


def record(*entries: dict[str, Any], boats: int = 1) -> NDArray[Any]:
    params = parameters(BOAT, boats)
    apply_effects(params, parse_effects(list(entries), "test", NAMES), NAMES)
    return params


def track(
    command: Array,
    *entries: dict[str, Any],
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    heading: float = 0.0,
    substeps: int = 2,
    start: Array | None = None,
) -> Array:
    params = record(*entries)
    if start is None:
        start = initial_state(params, np.array([[0.0, 0.0, heading]]), np.array([velocity]))
    return simulate(params, tank(BOAT), start, command[None], np.ones(1, np.uint64), DT, substeps)[0]


def lively(steps: int = 200, seed: int = 0) -> Array:
    rng = np.random.default_rng(seed)
    chosen = np.concatenate(
        [rng.uniform(-1, 1, (steps // 10, 4)), rng.uniform(0.2, 1, (steps // 10, 4))], axis=1
    )
    return np.repeat(chosen, 10, axis=0)


def coast(seconds: float = 10.0) -> Array:
    return commands(0, 0, (0.0,) * 4, round(seconds / DT))


def times(run: Array) -> Array:
    return np.asarray(DT * np.arange(len(run)), dtype=np.float64)


def thrust_at(throttle: float) -> float:
    """Of all four thrusters together, as the reference has it: 12.2 p² and 1 - t from 0.30 to 0.75."""
    return float(4.0 * 12.2 * throttle**2 * np.interp(throttle, [0.3, 1.0], [0.30, 0.75]))


def at_once(*entries: dict[str, Any], velocity: tuple[float, float, float] = (0, 0, 0)) -> Array:
    """Accelerations at the start, with the thrusters off."""
    params = record(*entries)
    start = initial_state(params, np.zeros((1, 3)), np.array([velocity], dtype=float))
    end = simulate(params, tank(BOAT), start, coast(DT)[None], np.zeros(1, np.uint64), 1e-5, 1)[0, -1]
    return (end[SURGE : YAW_RATE + 1] - start[0, SURGE : YAW_RATE + 1]) / 1e-5

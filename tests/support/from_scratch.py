"""Boats written from nothing: fixed thrusters, azimuth ferries of 1.8 and 84 t, a toy of 0.3 m."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import yaml

Section = dict[str, Any]


def number(value: Any, unit: str) -> Section:
    """A number as a file that extends nothing has to give it."""
    return {"value": value, "unit": unit, "provenance": "assumed", "source": "a test"}


def thruster(name: str, kind: str, x: float, y: float, thrust: float, **more: Section) -> Section:
    """A thruster at x, y [m] that pushes `thrust` [N] at most."""
    return {
        "name": name,
        "kind": kind,
        "x": number(x, "m"),
        "y": number(y, "m"),
        "pump_time_constant": number(0.1, "s"),
        "thrust_linear": number(0.0, "N"),
        "thrust_quadratic": number(thrust, "N"),
        **more,
    }


def turning(rate: float, lag: float, **more: Section) -> Section:
    """How an azimuth thruster turns: rate [rad/s] and time constant [s]."""
    return {"azimuth_rate": number(rate, "rad/s"), "azimuth_time_constant": number(lag, "s"), **more}


def boat(size: tuple[float, float, float], mass: float, thrusters: list[Section], joypad: Section) -> Section:
    """A whole boat file; size: length, breadth, draught [m]. Coefficients are usual ones of slender hulls."""
    length, breadth, draught = size
    inertia = mass * (0.25 * length) ** 2
    under, beside = breadth * draught, length * draught
    names = ("x_vr", "y_v", "y_r", "n_v", "n_r", "c_d", "c_ry", "c_rn")
    hull = dict(zip(names, (0.1, -0.4, 0.05, -0.12, -0.08, 1.0, 1.0, 1.0), strict=True))
    return {
        "length": number(length, "m"),
        "breadth": number(breadth, "m"),
        "draught": number(draught, "m"),
        "mass": number(mass, "kg"),
        "inertia_z": number(inertia, "kg m2"),
        "x_g": number(0.0, "m"),
        "added_mass_surge": number(-0.05 * mass, "kg"),
        "added_mass_sway": number(-0.5 * mass, "kg"),
        "added_inertia_yaw": number(-0.4 * inertia, "kg m2"),
        "water_density": number(1000.0, "kg/m3"),
        "hull": {name: number(value, "1") for name, value in hull.items()},
        "resistance": {"x_0_ahead": number(-0.06, "1"), "x_0_astern": number(-0.08, "1")},
        "thrusters": thrusters,
        "thrust_deduction": {
            "throttle_low": number(0.0, "1"),
            "factor_low": number(0.9, "1"),
            "throttle_high": number(1.0, "1"),
            "factor_high": number(0.9, "1"),
        },
        "wind": {
            "air_density": number(1.2, "kg/m3"),
            "frontal_area": number(2.0 * under, "m2"),
            "lateral_area": number(2.0 * beside, "m2"),
            "lateral_centre": number(0.0, "m"),
            **{name: number(value, "1") for name, value in (("c_x", 0.7), ("c_y", 0.9), ("c_n", 0.1))},
        },
        "current": {
            "model": "relative",
            "frontal_area": number(under, "m2"),
            "lateral_area": number(beside, "m2"),
            "lateral_centre": number(0.0, "m"),
            **{name: number(value, "1") for name, value in (("c_x", 0.2), ("c_y", 0.6))},
        },
        "joypad": joypad,
    }


def joypad(thrusters: list[str], reach: float | None = None) -> Section:
    """A joypad that drives these thrusters, the azimuth to `reach` [rad] on either side."""
    throttle = {"thrusters": thrusters, "throttle": number([0.0, 1.0], "1")}
    return throttle if reach is None else {**throttle, "azimuth": number([-reach, reach], "rad")}


AHEAD = {"azimuth_min": number(0.0, "rad"), "azimuth_max": number(0.0, "rad")}
STOPS = {"azimuth_min": number(-0.7, "rad"), "azimuth_max": number(0.7, "rad")}
SIDES = (("port", -1.0), ("starboard", 1.0))

TWIN = boat(
    (1.0, 0.6, 0.1),
    15.0,
    [
        thruster(name, "fixed", -0.4, 0.25 * y, 8.0, astern_quadratic=number(5.0, "N"), **AHEAD)
        for name, y in SIDES
    ],
    joypad(["port", "starboard"]),
)
FERRY = boat(
    (5.0, 2.4, 0.45),
    1800.0,
    [
        thruster(name, "azimuth", x, 0.0, 400.0, **turning(1.0, 0.3))
        for name, x in (("bow", 1.8), ("stern", -1.8))
    ],
    joypad(["bow"], 1.2),
)
TOY = boat(
    (0.3, 0.12, 0.04),
    0.6,
    [thruster(name, "azimuth", -0.15, 0.03 * y, 0.2, **turning(6.0, 0.05, **STOPS)) for name, y in SIDES],
    joypad(["port", "starboard"], 0.7),
)
CROSSED = boat(
    (1.1, 0.8, 0.06),
    25.0,
    [
        thruster(
            f"{end}_{side}",
            "fixed",
            x,
            0.28 * y,
            30.0,
            **dict.fromkeys(
                ("azimuth_min", "azimuth_max"), number(math.copysign(math.pi / 4, -x * y), "rad")
            ),
        )
        for end, x in (("bow", 0.44), ("stern", -0.44))
        for side, y in SIDES
    ],
    joypad([f"{end}_{side}" for end in ("bow", "stern") for side, _ in SIDES]),
)
FROUDE = {"m": 1.0, "m2": 2.0, "kg": 3.0, "kg m2": 5.0, "N": 3.0, "s": 0.5, "rad/s": -0.5}


def enlarged(section: Any, ratio: float) -> Any:
    """A section `ratio` times as long, by Froude's law; what has no length in its unit stays."""
    if isinstance(section, list):
        return [enlarged(part, ratio) for part in section]
    if not isinstance(section, dict):
        return section
    if "unit" in section:
        return section | {
            "value": np.multiply(section["value"], ratio ** FROUDE.get(section["unit"], 0.0)).tolist()
        }
    return {name: enlarged(part, ratio) for name, part in section.items()}


BOATS = {"twin": TWIN, "ferry": FERRY, "toy": TOY, "crossed": CROSSED, "large": enlarged(FERRY, 3.6)}


def written(folder: Path, name: str, **changes: Any) -> Path:
    """The file of one of the boats, some of its sections replaced."""
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(BOATS[name] | changes, sort_keys=False))
    return path


def with_tunnel(path: Path, joypad: tuple[str, ...] = ("port", "starboard")) -> Path:
    """The file of the boat at `path` with a tunnel thruster that pushes one way; joypad: what it drives."""
    tunnel = path.with_name("with_tunnel.yaml")
    abeam = {"kind": "fixed", "azimuth_min": 1.5708, "azimuth_max": 1.5708, "x": 0.3, "y": 0.0}
    item = abeam | {"pump_time_constant": 0.1, "thrust_quadratic": 2.0}
    content = {"extends": path.name, "joypad": {"thrusters": list(joypad)}, "thrusters": {"tunnel": item}}
    tunnel.write_text(yaml.safe_dump(content))
    return tunnel

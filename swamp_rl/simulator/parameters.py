"""The parameter record: every number that the compiled physics reads of one boat, effects included."""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.effects import apply_effects, neutral_fields
from swamp_rl.physics.resistance import tank_table
from swamp_rl.simulator.state import NORTH, SURGE, YAW_RATE, state_size

THRUSTER_FIELDS = (
    "x y azimuth_min azimuth_max azimuth_rate azimuth_time_constant azimuth_offset pump_time_constant "
    "thrust_linear thrust_quadratic astern_linear astern_quadratic nozzle_area"
).split()


def boat_fields(boat: Boat) -> dict[str, float]:
    """The per-boat numbers of the record that come from the boat file, by field name."""
    return {
        "length": boat.length,
        "draught": boat.draught,
        "mass": boat.mass,
        "inertia_z": boat.inertia_z,
        "x_g": boat.x_g,
        "added_mass_surge": boat.added_mass_surge,
        "added_mass_sway": boat.added_mass_sway,
        "added_inertia_yaw": boat.added_inertia_yaw,
        "water_density": boat.water_density,
        "reference_mass": boat.resistance.reference_mass,
        "reference_density": boat.resistance.reference_density,
        "x_vr": boat.hull.x_vr,
        "y_v": boat.hull.y_v,
        "y_r": boat.hull.y_r,
        "n_v": boat.hull.n_v,
        "n_r": boat.hull.n_r,
        "c_d": float(boat.hull.c_d),
        "c_ry": boat.hull.c_ry,
        "c_rn": boat.hull.c_rn,
        "deduction_throttle_low": boat.thrust_deduction.throttle_low,
        "deduction_factor_low": boat.thrust_deduction.factor_low,
        "deduction_throttle_high": boat.thrust_deduction.throttle_high,
        "deduction_factor_high": boat.thrust_deduction.factor_high,
        "air_density": boat.wind.air_density,
        "air_frontal_area": boat.wind.frontal_area,
        "air_lateral_area": boat.wind.lateral_area,
        "air_lateral_centre": boat.wind.lateral_centre,
        "air_c_x": boat.wind.c_x,
        "air_c_y": boat.wind.c_y,
        "air_c_n": boat.wind.c_n,
        "current_as_force": float(boat.current.model == "dnv_force"),
        "current_frontal_area": boat.current.frontal_area,
        "current_lateral_area": boat.current.lateral_area,
        "current_lateral_centre": boat.current.lateral_centre,
        "current_c_x": boat.current.c_x,
        "current_c_y": boat.current.c_y,
    }


def thruster_fields(boat: Boat) -> dict[str, list[float]]:
    """The per-thruster numbers of the record that come from the boat file, by field name.

    `channel`: which thruster's command each one obeys, by place in the file.
    """
    fields = {name: [float(getattr(t, name)) for t in boat.thrusters] for name in THRUSTER_FIELDS}
    named = {f"thruster_{name}" if name in ("x", "y") else name: values for name, values in fields.items()}
    return named | {"channel": [float(k) for k in range(len(boat.thrusters))]}


@lru_cache(maxsize=64)
def _nominal(boat: Boat) -> NDArray[Any]:
    scalars = boat_fields(boat)
    columns = thruster_fields(boat)
    for field, (neutral, per_thruster) in neutral_fields().items():
        if field in scalars or field in columns:
            continue
        if per_thruster:
            columns[field] = [neutral] * len(boat.thrusters)
        else:
            scalars[field] = neutral
    count = (len(boat.thrusters),)
    dtype = np.dtype([(f, np.float64) for f in scalars] + [(f, np.float64, count) for f in columns])
    record = np.zeros(1, dtype)
    for field, value in (scalars | columns).items():
        record[field] = value
    apply_effects(record, boat.effects, boat.thruster_names)
    return record


def parameters(boat: Boat, n: int = 1) -> NDArray[Any]:
    """Parameter records of n equal boats, shape (n,), the boat file's own effects applied.

    Any field of any boat may be changed before a step: mass, current, wind, every effect's parameters.
    """
    return np.repeat(_nominal(boat), n)


@lru_cache(maxsize=64)
def tank(boat: Boat) -> NDArray[np.float64]:
    """The boat's towing-tank curves as the compiled functions read them; shared by all boats of a batch."""
    curves = [
        (curve.h_over_t, np.array(curve.speed, dtype=float), np.array(curve.resistance, dtype=float))
        for curve in boat.resistance.table
    ]
    table = tank_table(curves)
    table.flags.writeable = False
    return table


def initial_state(
    params: NDArray[Any], pose: NDArray[np.float64], velocity: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """States (n, S) at time 0, thrusters stopped and straight ahead.

    pose: (n, 3) north, east [m], heading [rad]; velocity: (n, 3) surge, sway [m/s over ground], yaw rate
    [rad/s], at rest over ground where not given.
    """
    thrusters = params["thruster_x"].shape[1]
    state = np.zeros((params.shape[0], state_size(thrusters)))
    state[:, NORTH : NORTH + 3] = pose
    if velocity is not None:
        state[:, SURGE : YAW_RATE + 1] = velocity
    return state

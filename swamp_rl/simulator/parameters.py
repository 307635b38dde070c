"""The parameter record: every number that the compiled physics reads of one boat, effects included."""

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, PropellerRudder, Thruster
from swamp_rl.boat.resistance import DriftResistance
from swamp_rl.boat.thrust_deduction import ThrustDeduction
from swamp_rl.effects import apply_effects, neutral_fields
from swamp_rl.physics.force_curve import CURVES, WIDTH
from swamp_rl.physics.propulsion import OF_JET, OF_RUDDER
from swamp_rl.physics.resistance import tank_table
from swamp_rl.simulator.divergence import refuse_divergence
from swamp_rl.simulator.screws import NEUTRAL, NUMBERS, model_row, room_of, screw_row
from swamp_rl.simulator.state import ACTUATORS, NORTH, SURGE, YAW_RATE, state_size

JET_FIELDS = (
    "azimuth_min",
    "azimuth_max",
    "azimuth_rate",
    "azimuth_time_constant",
    "azimuth_offset",
    "pump_time_constant",
    "thrust_linear",
    "thrust_quadratic",
    "astern_linear",
    "astern_quadratic",
    "dead_band",
    "nozzle_area",
    "advance_loss",
)


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
        **resistance_fields(boat),
        "x_vr": boat.hull.x_vr,
        "y_v": boat.hull.y_v,
        "y_r": boat.hull.y_r,
        "n_v": boat.hull.n_v,
        "n_r": boat.hull.n_r,
        "c_d": float(boat.hull.c_d),
        "c_ry": boat.hull.c_ry,
        "c_rn": boat.hull.c_rn,
        "hull_spacing": boat.hull.spacing,
        **deduction_fields(boat),
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


def resistance_fields(boat: Boat) -> dict[str, float]:
    """What the resistance refers to, and its coefficients, where no tank was towed."""
    given = boat.resistance
    if isinstance(given, DriftResistance):
        own = {"reference_mass": boat.mass, "reference_density": boat.water_density}
        return own | {"x_0_ahead": given.x_0_ahead, "x_0_astern": given.x_0_astern}
    return {"reference_mass": given.reference_mass, "reference_density": given.reference_density}


def deduction_fields(boat: Boat) -> dict[str, float]:
    """The thrust deduction of the jets; none where there are none."""
    given = boat.thrust_deduction or ThrustDeduction(
        throttle_low=0.0, factor_low=1.0, throttle_high=1.0, factor_high=1.0
    )
    return {f"deduction_{name}": value for name, value in given}


def thruster_fields(boat: Boat) -> dict[str, list[Any]]:
    """The per-thruster numbers of the record that come from the boat file, by field name.

    `channel`: which thruster's command each one obeys, by place in the file; `azimuth_sign`, `throttle_sign`:
    factors of its commands. Lists are filled up with zeros to `room_of`. The order of the fields does not
    depend on that of the thrusters, so that boats with equal fields share one record type.
    """
    rows = [
        propeller_row(t, boat) if isinstance(t, PropellerRudder) else jet_row(t, boat) for t in boat.thrusters
    ]
    others = {name for row in rows for name in row} - set(JET_FIELDS)
    fields: dict[str, list[Any]] = {}
    for name in (*JET_FIELDS, *sorted(others)):
        values = [row.get(name, NEUTRAL.get(name, 0.0)) for row in rows]
        longest = max((len(value) for value in values if isinstance(value, tuple)), default=0)
        fields[name] = [filled(value, room_of(name, longest)) for value in values] if longest else values
    if set(fields["drive"]) == {OF_JET}:
        del fields["drive"]
    own = {"channel": [float(k) for k in range(len(rows))]}
    own |= {"azimuth_sign": [1.0] * len(rows), "throttle_sign": [1.0] * len(rows)}
    return fields | own


def filled(value: Any, length: int) -> tuple[float, ...]:
    """A list of numbers, or none, with zeros up to that length."""
    given = value if isinstance(value, tuple) else ()
    return (*given, *(length - len(given)) * (0.0,))


def jet_row(thruster: Thruster, boat: Boat) -> dict[str, Any]:
    """What the record holds of one jet, or of a thruster with a propeller or a table."""
    row = {name: float(getattr(thruster, name)) for name in JET_FIELDS}
    row |= {"thruster_x": thruster.x, "thruster_y": thruster.y, "drive": OF_JET}
    return row | screw_row(thruster, boat) | foil_row(thruster)


def foil_row(thruster: Thruster) -> dict[str, float]:
    """Of a thruster with a foil; nothing for another."""
    foil = thruster.foil
    if foil is None:
        return {}
    row = {"foil_area": foil.area, "foil_aspect_ratio": foil.aspect_ratio, "foil_gamma": foil.gamma}
    return row | {"foil_stall": math.sin(foil.stall_angle)}


def propeller_row(actuator: PropellerRudder, boat: Boat) -> dict[str, Any]:
    """What the record holds of one propeller with its rudder, whose angle takes the place of an azimuth."""
    propeller, rudder = actuator.propeller, actuator.rudder
    model = model_row(propeller.diameter, propeller.open_water) if propeller.open_water else {}
    return (
        dict.fromkeys(JET_FIELDS, 0.0)
        | model
        | {
            "drive": OF_RUDDER,
            "level_min": -actuator.revolutions_max_astern,
            "level_max": actuator.revolutions_max,
            "dead_band": actuator.dead_band,
            "thruster_x": actuator.x,
            "thruster_y": actuator.y,
            "azimuth_min": -actuator.rudder_max,
            "azimuth_max": actuator.rudder_max,
            "azimuth_rate": actuator.rudder_rate,
            "azimuth_time_constant": actuator.rudder_time_constant,
            "pump_time_constant": actuator.revolutions_time_constant,
            "revolutions_max": actuator.revolutions_max,
            "revolutions_max_astern": actuator.revolutions_max_astern,
            "propeller_diameter": propeller.diameter,
            "pitch_ratio": propeller.pitch_ratio,
            "propeller_deduction": propeller.thrust_deduction,
            "wake_zero": propeller.wake_zero,
            "wake_tau": propeller.wake_tau,
            "wake_c_p": propeller.wake_c_p,
            "x_wake": propeller.x_wake,
            "k_t": propeller.k_t or (0.0,) * 3,
            "astern_thrust": propeller.astern_thrust or (0.0,) * 4,
            "propeller_side_force": propeller.side_force,
            "propeller_yaw_moment": propeller.yaw_moment,
            "propeller_side_share": propeller.side_share,
            "rudder_area": rudder.area,
            "rudder_aspect_ratio": rudder.aspect_ratio,
            "rudder_deduction": rudder.thrust_deduction,
            "rudder_a_h": rudder.a_h,
            "rudder_x_h": rudder.x_h,
            "rudder_flow_lever": rudder.flow_lever,
            "rudder_drift_slope": rudder.drift_slope,
            "rudder_gamma_p": rudder.gamma_p,
            "rudder_gamma_n": rudder.gamma_n,
            "rudder_epsilon": rudder.epsilon,
            "rudder_k_x": rudder.k_x,
            "rudder_k_x_astern": rudder.k_x_astern,
            "rudder_c_pr": rudder.c_pr,
        }
    )


@lru_cache(maxsize=64)
def record_of(scalars: tuple[str, ...], columns: tuple[tuple[str, tuple[int, ...]], ...]) -> np.dtype[Any]:
    """The record of these fields, those of `columns` with their shapes; the same object for equal ones.

    At every call numba looks a record up by identity first; another object of the same type is compared with
    it field by field, which takes longer than the step of a boat.
    """
    return np.dtype(
        [(field, np.float64) for field in scalars] + [(field, np.float64, shape) for field, shape in columns]
    )


def file_record(boat: Boat) -> NDArray[Any]:
    """Parameter record (1,) of the boat file's numbers, its effects left out, whether or not its motion
    diverges.
    """
    scalars = boat_fields(boat)
    columns = thruster_fields(boat)
    for field, (neutral, per_thruster) in neutral_fields().items():
        if field in scalars or field in columns:
            continue
        if per_thruster:
            columns[field] = [neutral] * len(boat.thrusters)
        else:
            scalars[field] = neutral
    columns["force_curves"] = np.zeros((CURVES, WIDTH)).tolist()
    if NUMBERS in columns:  # last, so that what every step reads stands close together
        columns[NUMBERS] = columns.pop(NUMBERS)
    shapes = {field: np.shape(values) for field, values in columns.items()}
    record = np.zeros(1, record_of(tuple(scalars), tuple(shapes.items())))
    for field, value in (scalars | columns).items():
        record[field] = value
    return record


@lru_cache(maxsize=64)
def _nominal(boat: Boat) -> NDArray[Any]:
    record = file_record(boat)
    refuse_divergence(boat.name, record, tank(boat))
    apply_effects(record, boat.effects, boat.thruster_names)
    return record


def parameters(boat: Boat, n: int = 1) -> NDArray[Any]:
    """Parameter records of n equal boats, shape (n,), the boat file's own effects applied.

    Any field of any boat may be changed before a step: mass, current, wind, every effect's parameters.
    UserError for a boat whose motion diverges in a few steps, see `swamp_rl.simulator.divergence`.
    """
    return np.repeat(_nominal(boat), n)


@lru_cache(maxsize=64)
def tank(boat: Boat) -> NDArray[np.float64]:
    """The boat's towing-tank curves as the compiled functions read them; shared by all boats of a batch, so
    that nobody may write to it.

    Zeros, which nothing reads, for a boat whose resistance comes as coefficients.
    """
    if isinstance(boat.resistance, DriftResistance):
        table = np.zeros((1, 6, 1))
    else:
        table = tank_table(
            [
                (curve.h_over_t, np.array(curve.speed, dtype=float), np.array(curve.resistance, dtype=float))
                for curve in boat.resistance.table
            ]
        )
    table.flags.writeable = False  # also for numba, which would compile everything twice
    return table


def initial_state(
    params: NDArray[Any], pose: NDArray[np.float64], velocity: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """States (n, S) at time 0, thrusters stopped and straight ahead, or as near to it as they turn.

    pose: (n, 3) north, east [m], heading [rad]; velocity: (n, 3) surge, sway [m/s over ground], yaw rate
    [rad/s], at rest over ground where not given.
    """
    thrusters = params["thruster_x"].shape[1]
    state = np.zeros((params.shape[0], state_size(thrusters)))
    state[:, NORTH : NORTH + 3] = pose
    if velocity is not None:
        state[:, SURGE : YAW_RATE + 1] = velocity
    state[:, ACTUATORS : ACTUATORS + thrusters] = np.clip(0.0, params["azimuth_min"], params["azimuth_max"])
    return state

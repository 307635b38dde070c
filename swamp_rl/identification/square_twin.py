"""A vehicle that surges, heaves and yaws on its own (003 eqs 5 to 7), sailed around a waypoint square."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from swamp_rl.boat.part import NAME, Part
from swamp_rl.boat.quantity import Unit
from swamp_rl.files import find_config, read_yaml, validated

Array = NDArray[np.float64]

STEP = 0.1  # s
PATIENCE = 20.0  # times a side at the top speed, after which the square is given up
REACHED, TURNED, DIVED = 0.3, 0.02, 0.1  # m, rad, m at which a motion is over
HELD, SHARPNESS = 0.1, 4.0  # speed at which a held axis has full force; share of it per m or rad to go
STILL = 0.02  # m/s or rad/s below which the vehicle counts as at rest
FASTEST = 50.0  # m/s or rad/s
LONGEST = 10_800.0  # s until all motions are given up
SIZE = Field(gt=0.0, le=1e9)


class Vehicle(Part):
    """A vehicle file, whole: M v' + D v |v| (+ g) = force on each axis, and the square that it sails."""

    name: Annotated[str, NAME]
    "Name in reports."
    description: str = ""
    "For people."
    surge_mass: Annotated[float, SIZE, Unit("kg")]
    "M_11."
    heave_mass: Annotated[float, SIZE, Unit("kg")]
    "M_33."
    yaw_inertia: Annotated[float, SIZE, Unit("kg m2")]
    "M_66."
    surge_drag: Annotated[float, SIZE, Unit("N s2/m2")]
    "D_11."
    heave_drag: Annotated[float, SIZE, Unit("N s2/m2")]
    "D_33."
    yaw_drag: Annotated[float, SIZE, Unit("N m s2")]
    "D_66."
    buoyancy: Annotated[float, Field(ge=0.0, le=1e9), Unit("N")] = 0.0
    "Surplus, upwards."
    surge_force: Annotated[float, SIZE, Unit("N")]
    "Force of the propellers in a surge motion."
    heave_force: Annotated[float, SIZE, Unit("N")]
    "Force of the thrusters in a heave motion."
    yaw_moment: Annotated[float, SIZE, Unit("N m")]
    "Moment of the thrusters in a yaw motion."
    side: Annotated[float, Field(ge=2.0, le=1000.0), Unit("m")]
    "Side of the square."
    depth: Annotated[float, Field(ge=0.0, le=100.0), Unit("m")]
    "Depth of its second half; 0: it does not dive."
    thrust_error: Annotated[float, Field(ge=-0.5, le=0.5), Unit("1")] = 0.0
    "True over estimated force, less 1."
    current: Annotated[float, Field(ge=0.0, le=10.0), Unit("m/s")] = 0.0
    "Towards north-east, unknown to the model."
    velocity_noise: Annotated[float, Field(ge=0.0, le=10.0), Unit("m/s")] = 0.0
    "Standard deviation."
    yaw_rate_noise: Annotated[float, Field(ge=0.0, le=10.0), Unit("rad/s")] = 0.0
    "Standard deviation."

    @model_validator(mode="after")
    def _can_be_sailed(self) -> Self:
        with np.errstate(over="ignore"):  # then infinite, and refused
            top = np.sqrt(self.forces / self.drags)
        for axis, speed, mass, drag in zip(
            ("surge", "heave", "yaw"), top, self.masses, self.drags, strict=True
        ):
            if not STILL < speed <= FASTEST:
                raise ValueError(
                    f"{axis}: force and drag give {speed:.3g} m/s or rad/s, it is {STILL:g} to {FASTEST:g}"
                )
            if 0.5 * mass / (drag * speed) < STEP:
                raise ValueError(f"{axis}: gathers speed within {STEP:g} s; correct mass, drag or force")
        if (longest := sum(_patience(self, *one) for one in motions(self))) > LONGEST:
            raise ValueError(f"side: may take {longest:.3g} s, at most {LONGEST:g} s; give a shorter one")
        return self

    @property
    def masses(self) -> Array:
        """(3,) M of surge, heave, yaw."""
        return np.array([self.surge_mass, self.heave_mass, self.yaw_inertia])

    @property
    def drags(self) -> Array:
        """(3,) D of surge, heave, yaw."""
        return np.array([self.surge_drag, self.heave_drag, self.yaw_drag])

    @property
    def forces(self) -> Array:
        """(3,) greatest force of surge, heave, yaw."""
        return np.array([self.surge_force, self.heave_force, self.yaw_moment])


@dataclass(frozen=True)
class Log:
    """A square as it was logged, T rows of `STEP`.

    force: (T, 3) estimated [N, N, N m] of surge, heave, yaw; velocity: (T, 3) measured; pose: (T, 4) true
    north, east, depth [m], heading [rad]. motion: (T,) axis of the elementary motion under way.
    """

    force: Array
    velocity: Array
    pose: Array
    motion: NDArray[np.int64]

    @property
    def length(self) -> float:
        """Distance [m]."""
        return float(np.sqrt((np.diff(self.pose[:, :3], axis=0) ** 2).sum(axis=1)).sum())


def load_vehicle(name_or_path: str | Path) -> Vehicle:
    """The vehicle of a file in configs/vehicles by its bare name, or of any file by its path; UserError."""
    path = find_config("vehicles", name_or_path)
    return validated(path, Vehicle, read_yaml(path))


def moved(pose: Array, velocity: Array, force: Array, masses: Array, drags: Array, lift: float) -> None:
    """Advance pose (4,) and velocity (3,) over `STEP` in place, the force (3,) held: four Euler substeps."""
    for _ in range(4):
        h = 0.25 * STEP
        push = force - np.array([0.0, lift, 0.0]) - drags * velocity * np.abs(velocity)
        velocity += h * push / masses
        if pose[2] <= 0.0 and velocity[1] < 0.0:
            velocity[1] = 0.0  # it floats
        pose += h * np.array(
            [velocity[0] * math.cos(pose[3]), velocity[0] * math.sin(pose[3]), velocity[1], velocity[2]]
        )


def motions(vehicle: Vehicle) -> list[tuple[int, float]]:
    """The elementary motions of the square: axis (surge 0, heave 1, yaw 2) and how far [m, m, rad]."""
    side, corner = (0, vehicle.side), (2, 0.5 * math.pi)
    dive = [(1, vehicle.depth)] if vehicle.depth else []
    rise = [(1, -vehicle.depth)] if vehicle.depth else []
    return [side, corner, side, *dive, corner, side, corner, side, *rise]


def sail(vehicle: Vehicle, seed: int = 0) -> Log:
    """Sail the square with the elementary motions one after another, each from rest to rest."""
    pose, velocity = np.zeros(4), np.zeros(3)
    drift = vehicle.current * math.sqrt(0.5) * STEP * np.array([1.0, 1.0, 0.0, 0.0])
    rows: list[tuple[Array, Array, Array, int]] = []
    for axis, way in motions(vehicle):
        gone, moving = 0.0, True
        patience = _patience(vehicle, axis, way)
        started = len(rows)
        while moving and (len(rows) - started) * STEP < patience:
            force = commanded(vehicle, pose, velocity, axis, way - gone)
            rows.append((force, velocity.copy(), pose.copy(), axis))
            given = (1.0 + vehicle.thrust_error) * force
            moved(pose, velocity, given, vehicle.masses, vehicle.drags, lift_at(vehicle, pose))
            pose += drift
            gone += STEP * velocity[axis]
            moving = abs(way - gone) > (REACHED, DIVED, TURNED)[axis] or abs(velocity[axis]) > STILL
    force, speed, where, axis_of = (np.array(column) for column in zip(*rows, strict=True))
    noise = np.array([vehicle.velocity_noise, vehicle.velocity_noise, vehicle.yaw_rate_noise])
    rng = np.random.default_rng(seed)
    return Log(force, speed + noise * rng.standard_normal(speed.shape), where, axis_of.astype(np.int64))


def _patience(vehicle: Vehicle, axis: int, way: float) -> float:
    """Seconds after which a motion is given up."""
    return PATIENCE * (abs(way) + 1.0) / math.sqrt(vehicle.forces[axis] / vehicle.drags[axis])


def lift_at(vehicle: Vehicle, pose: Array) -> float:
    """Surplus buoyancy [N] at a pose (4,); none where the vehicle floats."""
    return vehicle.buoyancy if pose[2] > 0.0 else 0.0


def commanded(vehicle: Vehicle, pose: Array, velocity: Array, axis: int, left: float) -> Array:
    """(3,) force of an elementary motion with `left` [m, m, rad] to go: full ahead, then full astern in time
    to come to rest there. The other axes are held at rest, and the buoyancy under water."""
    force = -vehicle.forces * np.clip(velocity / HELD, -1.0, 1.0)
    most, mass, drag = vehicle.forces[axis], vehicle.masses[axis], vehicle.drags[axis]
    speed = velocity[axis]
    braking = 0.5 * mass / drag * math.log1p(drag * speed * abs(speed) * math.copysign(1.0, speed) / most)
    there = left - math.copysign(braking, speed)
    force[axis] = most * max(-1.0, min(1.0, SHARPNESS * there))
    force[1] += lift_at(vehicle, pose)
    return force

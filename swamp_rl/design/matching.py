"""Matching propellers to a hull, and its speed of best range (Allotta et al. 2014, 004; equations are its).

A vehicle's drag is X = k_x u² (9). In a steady run all propellers together make it (11, 12):

    k_x J² = K_h n_prop K_t(J) ρ d²,   K_t = K_tb (1 − J/(k_null p/d))   (14)

and (15), k_x J² + K_h n_prop K_tb ρ d² (J/(k_null p/d) − 1) = 0, whose positive root is J*.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, Self, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator
from scipy.optimize import minimize_scalar

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.part import FILLED, FROM_LIST, NAME, POSITIVE, WATER, Part
from swamp_rl.boat.quantity import Unit
from swamp_rl.boat.resistance import TankResistance
from swamp_rl.design.read import computable, read_design
from swamp_rl.errors import UserError, errors_at
from swamp_rl.manoeuvres.captive import resistance_at

Advance = TypeVar("Advance", float, NDArray[np.float64])
SHARE = Field(gt=0, le=1)
MOST = 20
GRID = 200  # speeds that the best range is looked for at first
Several = Annotated[tuple[Annotated[float, POSITIVE], ...], FROM_LIST, FILLED, Field(max_length=MOST)]


class Vehicle(Part):
    """What is driven: a body of revolution by its drag coefficient, or a boat by its file."""

    boat: Annotated[str, Field(min_length=1)] | None = None
    "A name in configs/boats, or a boat file; or give the next two."
    drag_coefficient: Annotated[float | None, POSITIVE, Field(le=10), Unit("1")] = None
    "C_DX on the frontal area (1)."
    diameter: Annotated[float | None, POSITIVE, Field(le=100), Unit("m")] = None
    "D: of the body."

    @model_validator(mode="after")
    def _is_one_of_both(self) -> Self:
        body = self.drag_coefficient is not None, self.diameter is not None
        if any(body) != all(body) or (self.boat is None) != all(body):
            raise ValueError("give either boat, or drag_coefficient and diameter")
        return self


class Pitch(Part):
    """A propeller of the series."""

    name: Annotated[str, NAME]
    "Name in tables and figures."
    pitch_ratio: Annotated[float, Field(gt=0, le=10), Unit("1")]
    "p/d."
    bollard_coefficient: Annotated[float, Field(gt=0, le=10), Unit("1")]
    "K_tb = K_t(0)."


class Propellers(Part):
    """Equal propellers side by side, of a series that differs in pitch."""

    count: Annotated[int, Field(ge=1, le=100)]
    "n_prop."
    diameter: Annotated[float, POSITIVE, Field(le=20), Unit("m")]
    "d."
    hull_efficiency: Annotated[float, SHARE, Unit("1")]
    "K_h: share of the thrust that the hull's flow leaves."
    null_factor: Annotated[float, Field(gt=0, le=3), Unit("1")]
    "k_null: J without thrust over p/d."
    series: Annotated[tuple[Pitch, ...], FROM_LIST, FILLED, Field(max_length=MOST)]
    "The pitches to compare."


class MatchDesign(Part):
    """A vehicle, the propellers to choose from, and what else draws power."""

    design: Literal["match"]
    "Kind of design."
    name: Annotated[str, Field(min_length=1)]
    "Name in tables; the file's by default."
    water_density: Annotated[float | None, WATER, Unit("kg/m3")] = None
    "Density of the water; a boat's file has its own."
    vehicle: Vehicle
    "Vehicle to be propelled."
    propellers: Propellers
    "Propellers."
    design_speed: Annotated[float, POSITIVE, Field(le=50), Unit("m/s")]
    "Speed of the revolutions and thrust that are reported."
    efficiency: Annotated[float, SHARE, Unit("1")]
    "η: drag times speed over electric power."
    energy: Annotated[float, POSITIVE, Unit("J")]
    "Energy of the accumulators."
    onboard_power: Annotated[Several, Unit("W")]
    "W_inst: each that the best range is looked for at."

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        if (self.water_density is None) == (self.vehicle.boat is None):
            raise ValueError("water_density: give it, unless vehicle.boat is given, whose file has its own")
        names = [one.name for one in self.propellers.series]
        if len(set(names)) < len(names):
            raise ValueError(f"propellers.series: names must differ, but are {', '.join(names)}")
        return self


@dataclass(frozen=True)
class Match:
    """A propeller on the hull at the design speed: J*, K_t(J*), revolutions [1/s], thrust of each [N]."""

    pitch: Pitch
    advance: float
    thrust_coefficient: float
    revolutions: float
    thrust: float


@dataclass(frozen=True)
class BestRange:
    """Speed [m/s] that takes the least energy a metre at an on-board power [W]; powers [W], range [m]."""

    onboard_power: float
    speed: float
    propulsion_power: float
    range: float

    @property
    def total_power(self) -> float:
        """W_tot = W_e + W_inst [W] (22)."""
        return self.propulsion_power + self.onboard_power

    @property
    def energy_per_metre(self) -> float:
        """W_tot / v [J/m]."""
        return self.total_power / self.speed


@dataclass(frozen=True)
class Drag:
    """Of a vehicle: force [N] over speed [m/s], known from `low` to `high` [m/s]; density of its water."""

    force: Callable[[float], float]
    low: float
    high: float
    water_density: float

    def factor(self, speed: float) -> float:
        """k_x = X/u² [kg/m] at a speed [m/s]."""
        return self.force(speed) / speed**2


def load_match(name_or_path: str | Path) -> MatchDesign:
    """The matching task of a file; UserError as in `read_design`."""
    return read_design(name_or_path, "match", MatchDesign)


def drag_factor(drag_coefficient: float, diameter: float, density: float) -> float:
    """k_x = C_DX ρ π D²/8 [kg/m] of X = k_x u² (9); (9) leaves out the square, the text below it has it."""
    return drag_coefficient * density * math.pi * diameter**2 / 8.0


def drag_of(design: MatchDesign) -> Drag:
    """Drag of the vehicle; UserError where its boat was never towed."""
    vehicle = design.vehicle
    if vehicle.boat is not None:
        with errors_at(f"{design.name}: vehicle.boat"):
            boat = load_boat(vehicle.boat)
        return Drag(lambda speed: resistance_at(boat, speed), *_known_speeds(boat), boat.water_density)
    density = design.water_density
    assert density is not None and vehicle.drag_coefficient is not None and vehicle.diameter is not None
    with computable(design.name):
        factor = drag_factor(vehicle.drag_coefficient, vehicle.diameter, density)
    return Drag(lambda speed: factor * speed**2, 0.0, math.inf, density)


def _known_speeds(boat: Boat) -> tuple[float, float]:
    """Of the deepest towing test; a boat that was not towed has none."""
    if not isinstance(boat.resistance, TankResistance):
        raise UserError(
            f"vehicle.boat: {boat.name} has no table of a towing tank; give drag_coefficient, diameter"
        )
    deepest = max(boat.resistance.table, key=lambda curve: curve.h_over_t)
    return deepest.speed[0], deepest.speed[-1]


def matched_advance(factor: float, density: float, of: Propellers, pitch: Pitch) -> float:
    """J*, the positive root of (15), for k_x = `factor` [kg/m] in water of that density [kg/m³]."""
    thrust = of.hull_efficiency * of.count * pitch.bollard_coefficient * density * of.diameter**2
    slope = thrust / (of.null_factor * pitch.pitch_ratio)
    return 2.0 * thrust / (slope + math.sqrt(slope**2 + 4.0 * factor * thrust))


def thrust_coefficient(advance: Advance, of: Propellers, pitch: Pitch) -> Advance:
    """K_t [1] of (14) at J [1]."""
    return pitch.bollard_coefficient * (1.0 - advance / (of.null_factor * pitch.pitch_ratio))


def matches(design: MatchDesign) -> list[Match]:
    """Every propeller of the series at the design speed; UserError where the drag there is not known."""
    drag, speed, of = drag_of(design), design.design_speed, design.propellers
    if not drag.low <= speed <= drag.high:
        raise UserError(
            f"{design.name}: design_speed {speed:g} m/s is not within the towed {drag.low:g} to "
            f"{drag.high:g} m/s"
        )
    found = []
    with computable(design.name):
        for pitch in of.series:
            advance = matched_advance(drag.factor(speed), drag.water_density, of, pitch)
            revolutions = speed / (advance * of.diameter)
            coefficient = thrust_coefficient(advance, of, pitch)
            thrust = coefficient * drag.water_density * revolutions**2 * of.diameter**4
            found.append(Match(pitch, advance, coefficient, revolutions, thrust))
    return found


def energy_per_metre(design: MatchDesign, drag: Drag, onboard: float, speed: float) -> float:
    """(W_e + W_inst)/v [J/m] at a speed v [m/s], W_e = X v/η."""
    return drag.force(speed) / design.efficiency + onboard / speed


def best_ranges(design: MatchDesign) -> list[BestRange]:
    """The speed of best range at each on-board power; UserError where none lies within what was towed.

    It makes (W_e + W_inst)/v least. For X = k_x v² that is (23), v = (W_inst/2f)^⅓ with f = W_e/v³ = k_x/η,
    and W_e = W_inst/2 = W_tot/3 (24).
    """
    drag = drag_of(design)
    found = []
    with computable(design.name):
        for onboard in design.onboard_power:
            closed = math.isinf(drag.high)
            speed = _closed_form(design, drag, onboard) if closed else _searched(design, drag, onboard)
            power = drag.force(speed) * speed / design.efficiency
            found.append(BestRange(onboard, speed, power, design.energy * speed / (power + onboard)))
    return found


def _closed_form(design: MatchDesign, drag: Drag, onboard: float) -> float:
    return float((0.5 * onboard * design.efficiency / drag.factor(1.0)) ** (1.0 / 3.0))


def _searched(design: MatchDesign, drag: Drag, onboard: float) -> float:
    """The tank's curve bends between its points: the best of a grid, then the minimum beside it."""

    def spent(speed: float) -> float:
        return energy_per_metre(design, drag, onboard, speed)

    grid = np.linspace(drag.low, drag.high, GRID)
    best = int(np.argmin([spent(float(speed)) for speed in grid]))
    if best in (0, GRID - 1):
        side = "below" if best == 0 else "above"
        raise UserError(
            f"{design.name}: no solution: with {onboard:g} W on board the best range lies {side} the towed "
            f"{drag.low:g} to {drag.high:g} m/s; change onboard_power"
        )
    beside = float(grid[best - 1]), float(grid[best + 1])
    return float(minimize_scalar(spent, bounds=beside, method="bounded", options={"xatol": 1e-6}).x)

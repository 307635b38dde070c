"""What a boat file holds of a thruster whose thrust depends on its speed of advance: propeller or table."""

import math
from typing import Annotated, Literal, Self, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from swamp_rl.boat.part import BELOW_ONE, FROM_LIST, NAME, NOT_NEGATIVE, POSITIVE, Part
from swamp_rl.boat.quantity import Unit
from swamp_rl.boat.resistance import increasing

Revolutions = TypeVar("Revolutions", float, NDArray[np.float64])
REACHED, STEPS = 0.9, 200  # share of full revolutions that the mean acceleration counts to; its steps
MOST = 100  # throttles or speeds of a table
SERIES = Annotated[tuple[float, ...], FROM_LIST, Field(min_length=1, max_length=41), Unit("1")]
SEVERAL = Field(min_length=1, max_length=MOST)


class Disc(Part):
    """Bladed actuator disc without losses (Allotta et al. 2018, 11 and 15): of propellers of high area ratio.

    It holds in the first quadrant: beyond J = p/d it gives no thrust, and in water from astern that at rest.
    Turning astern it is its mirror image.
    """

    kind: Literal["disc"]
    "Kind of model."
    pitch_ratio: Annotated[float, Field(gt=0, le=10), Unit("1")]
    "p/d."


class Linear(Part):
    """K_t = K_t(0) (1 − J/J_0) (Allotta et al. 2018, 18 and 19), turning astern its mirror image."""

    kind: Literal["linear"]
    "Kind of model."
    bollard_coefficient: Annotated[float, Field(gt=0, le=10), Unit("1")]
    "K_t(0)."
    null_advance: Annotated[float, Field(gt=0, le=10), Unit("1")]
    "J_0 = k_null p/d: the advance coefficient without thrust."


class FourQuadrant(Part):
    """C_t* over the advance angle β = atan2(V_a, 0.7 π n d) (Allotta et al. 2018, 20, 21 and 23).

    C_t* = Σ A_k cos kβ + B_k sin kβ; it holds in all four quadrants.
    """

    kind: Literal["four_quadrant"]
    "Kind of model."
    cosines: SERIES
    "A_0, A_1, ..."
    sines: SERIES
    "B_0, B_1, ..., as many; B_0 counts for nothing."

    @model_validator(mode="after")
    def _pushes(self) -> Self:
        if len(self.cosines) != len(self.sines):
            raise ValueError("cosines and sines must be as many; B_0 is 0")
        if sum(self.cosines) <= 0.0:
            raise ValueError("C_t* at β = 0, the sum of the cosines, must be above 0: it would never push")
        return self

    def at(self, angle: float) -> float:
        """C_t* [1] at an advance angle [rad]."""
        pairs = enumerate(zip(self.cosines, self.sines, strict=True))
        return sum(a * math.cos(k * angle) + b * math.sin(k * angle) for k, (a, b) in pairs)


OpenWater = Annotated[Disc | Linear | FourQuadrant, Field(discriminator="kind")]
OPEN_WATER = ("disc", "linear", "four_quadrant")


def bollard_factor(model: Disc | Linear | FourQuadrant, astern: bool = False) -> float:
    """|K_t| at rest [1]: T = ρ n² d⁴ K_t."""
    if isinstance(model, Linear):
        return model.bollard_coefficient
    if isinstance(model, FourQuadrant):
        tangential = math.pi / 8.0 * (0.7 * math.pi) ** 2  # (21) at J = 0
        return tangential * (-model.at(math.pi) if astern else model.at(0.0))
    increase = math.pi / math.sqrt(1.0 + 0.25 * (math.pi / model.pitch_ratio) ** 2)  # (15) at J = 0
    return math.pi / 16.0 * increase**2


class Wash(Part):
    """The race of a thruster ahead, in which this one stands (Allotta et al. 2018, figure 16).

    It adds share · Δ_v to the speed of advance, Δ_v = √(V_a² + 2T/(ρ A)) − V_a the speed that the disc ahead
    gives the water (9).
    """

    of: Annotated[str, NAME]
    "The thruster ahead; it has a propeller too."
    share: Annotated[float, NOT_NEGATIVE, Field(le=1), Unit("1")]
    "Share of the race's increase of speed that arrives."


class Motor(Part):
    """The electric motor that turns a propeller, speed-controlled (Allotta et al. 2018, 29 to 31).

    Its torque falls from stall_torque to nominal_torque at nominal_speed, then to 0 at no_load_speed.
    """

    stall_torque: Annotated[float, POSITIVE, Unit("N m")]
    "Q_stall, at rest."
    nominal_torque: Annotated[float, POSITIVE, Unit("N m")]
    "Q_nom."
    nominal_speed: Annotated[float, POSITIVE, Unit("rad/s")]
    "ω_nom of the motor."
    no_load_speed: Annotated[float, POSITIVE, Unit("rad/s")]
    "ω_noload of the motor."
    gear_ratio: Annotated[float, POSITIVE, Unit("1")]
    "τ: the propeller's speed over the motor's."
    inertia: Annotated[float, POSITIVE, Unit("kg m2")]
    "I_m/τ² + I_p + I_eq: of motor, propeller and the water with it, at the propeller."

    @model_validator(mode="after")
    def _falls(self) -> Self:
        if self.nominal_torque > self.stall_torque:
            raise ValueError("nominal_torque must not be above stall_torque")
        if self.nominal_speed >= self.no_load_speed:
            raise ValueError("nominal_speed must be below no_load_speed")
        return self

    def torque(self, speed: float) -> float:
        """Torque [N m] at the propeller at its speed [rad/s] ≥ 0: Q_m(ω/τ)/τ (29)."""
        motor = speed / self.gear_ratio
        if motor <= self.nominal_speed:
            lost = self.stall_torque - self.nominal_torque
            torque = self.stall_torque - lost * motor / self.nominal_speed
        else:
            fall = (self.no_load_speed - motor) / (self.no_load_speed - self.nominal_speed)
            torque = self.nominal_torque * max(fall, 0.0)
        return torque / self.gear_ratio


class Screw(Part):
    """A propeller without a rudder, of an `azimuth` or `fixed` thruster; throttle p turns it at p n_max."""

    diameter: Annotated[float, POSITIVE, Unit("m")]
    "d."
    revolutions_max: Annotated[float, POSITIVE, Unit("rps")]
    "Revolutions at throttle 1."
    revolutions_max_astern: Annotated[float, NOT_NEGATIVE, Unit("rps")] = 0.0
    "Revolutions at throttle −1; 0: it does not turn astern."
    wake: Annotated[float, NOT_NEGATIVE, BELOW_ONE, Unit("1")] = 0.0
    "w: V_a = (1 − w) V in water from ahead, V in water from astern."
    crossflow_loss: Annotated[float, NOT_NEGATIVE, Unit("1")] = 0.0
    "c of the factor exp(−c (V_t/V_j)²) (24), V_t the flow across, V_j = √(T/(ρ A)) the race's speed."
    side_share: Annotated[float, Unit("1")] = 0.0
    "Force across, to starboard of a thrust ahead, as a share of the thrust: of two that interact (28)."
    torque_coefficient: Annotated[float | None, POSITIVE, Unit("1")] = None
    "K_q at rest, Q = K_q ρ n² d⁵; needed by `motor`."
    open_water: OpenWater
    "Thrust in open water."
    wash: Wash | None = None
    "The race that it stands in."
    motor: Motor | None = None
    "Motor; limits the rate of change of the revolutions."

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        if self.motor is not None and self.torque_coefficient is None:
            raise ValueError("motor: needs torque_coefficient; add it")
        if self.revolutions_max_astern > 0.0 and bollard_factor(self.open_water, astern=True) <= 0.0:
            raise ValueError(
                "open_water: C_t* at β = π must be below 0: astern it would never push; or give no "
                "revolutions_max_astern"
            )
        return self

    @property
    def area(self) -> float:
        """A of the disc [m²]."""
        return 0.25 * math.pi * self.diameter**2

    def bollard(self, water_density: float, astern: bool = False) -> float:
        """Size of the thrust [N] at rest at full revolutions."""
        most = self.revolutions_max_astern if astern else self.revolutions_max
        return water_density * self.diameter**4 * most**2 * bollard_factor(self.open_water, astern)

    def mean_acceleration(self, water_density: float) -> float:
        """Throttle [1/s] that the motor's full torque gains on average from 0 to 90 % of n_max; 0: never.

        ω̇ = (Q_m − Q)/I (31), by the rectangle rule in ω.
        """
        assert self.motor is not None
        spans = [(i + 0.5) / STEPS * REACHED * self.revolutions_max for i in range(STEPS)]
        left = [self.motor.torque(2.0 * math.pi * n) - self.torque(n, water_density) for n in spans]
        if min(left) <= 0.0:
            return 0.0
        width = 2.0 * math.pi * REACHED * self.revolutions_max / STEPS
        return REACHED / sum(width * self.motor.inertia / torque for torque in left)

    def torque(self, revolutions: Revolutions, water_density: float) -> Revolutions:
        """Q = K_q ρ n² d⁵ [N m] at rest."""
        return (self.torque_coefficient or 0.0) * water_density * revolutions**2 * self.diameter**5


class ThrustRow(Part):
    """Thrust at one throttle."""

    throttle: Annotated[float, Field(ge=-1, le=1), Unit("1")]
    "Throttle of the test."
    thrust: Annotated[tuple[float, ...], FROM_LIST, SEVERAL, Unit("N")]
    "Thrust at each of the table's speeds, negative astern."


class ThrustTable(Part):
    """Thrust over throttle and speed of advance, of a test on a bollard or in a tank.

    Linear between its points, constant beyond its speeds. A row of no thrust at throttle 0 may be left out.
    """

    speed: Annotated[tuple[float, ...], FROM_LIST, SEVERAL, Unit("m/s")]
    "V_a along the thrust, increasing; 0 is among them."
    rows: Annotated[tuple[ThrustRow, ...], FROM_LIST, SEVERAL]
    "Rows by increasing throttle, the last at 1, the first at −1 or above 0."

    @model_validator(mode="after")
    def _is_a_table(self) -> Self:
        throttles = [row.throttle for row in self.rows]
        if not increasing(self.speed) or 0.0 not in self.speed:
            raise ValueError("speed must increase from each to the next, and hold 0: the bollard test")
        if not increasing(throttles) or throttles[-1] != 1.0 or -1.0 < throttles[0] < 0.0:
            raise ValueError("rows: throttle must increase from row to row, from −1 or 0 or above, to 1")
        if any(len(row.thrust) != len(self.speed) for row in self.rows):
            raise ValueError("rows: thrust needs a number for each speed")
        if self.thrust_at_rest(0.0) != 0.0:
            raise ValueError("rows: there must be no thrust at throttle 0 and speed 0")
        if not increasing([self.thrust_at_rest(throttle) for throttle in self.throttles]):
            raise ValueError("rows: thrust must increase with throttle at speed 0")
        return self

    @property
    def throttles(self) -> tuple[float, ...]:
        """Of the rows, 0 among them."""
        return tuple(sorted({0.0, *(row.throttle for row in self.rows)}))

    @property
    def filled(self) -> tuple[tuple[float, ...], ...]:
        """Thrust [N] at each of `throttles` and `speed`."""
        known = {row.throttle: row.thrust for row in self.rows}
        return tuple(known.get(throttle, (0.0,) * len(self.speed)) for throttle in self.throttles)

    def thrust_at_rest(self, throttle: float) -> float:
        """Thrust [N] of the bollard test at a throttle of the table."""
        return self.filled[self.throttles.index(throttle)][self.speed.index(0.0)]

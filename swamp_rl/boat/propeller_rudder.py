"""What a boat file holds of a propeller with a rudder behind it (MMG form, four quadrants)."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from swamp_rl.boat.battery import Power, ShaftPower
from swamp_rl.boat.part import BELOW_ONE, FROM_LIST, NAME, NOT_NEGATIVE, POSITIVE, Part
from swamp_rl.boat.quantity import Unit
from swamp_rl.boat.screw import OpenWater, bollard_factor

RUDDER_ANGLE = Field(gt=0, lt=math.pi / 2)
Coefficients = Annotated[tuple[float, ...], FROM_LIST, Unit("1")]


class Propeller(Part):
    """A propeller of fixed pitch (Miyauchi et al. 2022, after Hachii and Ueno; `swamp_rl.physics.propeller`).

    J is the advance ratio u (1 − w)/(n D), J_s is u/(n D).
    """

    diameter: Annotated[float, POSITIVE, Unit("m")]
    "D."
    pitch_ratio: Annotated[float, POSITIVE, Unit("1")]
    "Pitch over diameter."
    thrust_deduction: Annotated[float, NOT_NEGATIVE, BELOW_ONE, Unit("1")]
    "t_P: share of the thrust that the hull loses, for a propeller turning ahead."
    wake_zero: Annotated[float, NOT_NEGATIVE, BELOW_ONE, Unit("1")]
    "w_P0 of the wake w_P0 − τ |b| − C_P b², b = (v + x'_P L r)/U: in straight motion."
    wake_tau: Annotated[float, Unit("1")]
    "τ of the wake."
    wake_c_p: Annotated[float, Unit("1")]
    "C_P of the wake."
    x_wake: Annotated[float, Unit("1")]
    "x'_P of b, lengths forward of midship."
    k_t: Annotated[tuple[float, ...] | None, FROM_LIST, Unit("1")] = None
    "Three coefficients of K_T(J) = k_0 + k_1 J + k_2 J²."
    astern_thrust: Annotated[tuple[float, ...] | None, FROM_LIST, Unit("1")] = None
    "C0 to C3 of Hachii: turning astern, K_T = C1 + C2 J_s where J_s ≥ C3, else C0."
    open_water: OpenWater | None = None
    "In place of `k_t` and `astern_thrust`: a model of the thrust in open water."
    side_force: Coefficients
    "A0 to A4 of Hachii, turning astern; A5 to A7 of Ueno, turning ahead in sternway."
    yaw_moment: Coefficients
    "B0 to B7: the same for the yaw moment."
    side_share: Annotated[float, Unit("1")] = 0.0
    "Further force to starboard, as a share of the thrust along the boat, to port astern."

    @model_validator(mode="after")
    def _coefficients_are_whole(self) -> Self:
        for name, count in (("k_t", 3), ("astern_thrust", 4), ("side_force", 8), ("yaw_moment", 8)):
            given = getattr(self, name)
            if given is not None and len(given) != count:
                raise ValueError(f"{name} needs {count} coefficients, not {len(given)}")
        if self.open_water is not None:
            if self.k_t is not None or self.astern_thrust is not None:
                raise ValueError("has open_water beside k_t or astern_thrust; set these two to null")
            return self
        if self.k_t is None or self.astern_thrust is None:
            raise ValueError("lacks k_t or astern_thrust; give both, or open_water")
        if self.k_t[0] <= 0:
            raise ValueError("k_t[0], the thrust coefficient at rest, must be above 0: it would never push")
        return self

    @property
    def bollard_coefficient(self) -> float:
        """K_T at rest, turning ahead [1]."""
        if self.open_water is not None:
            return bollard_factor(self.open_water)
        assert self.k_t is not None
        return self.k_t[0]

    @property
    def bollard_coefficient_astern(self) -> float:
        """-K_T at rest, turning astern [1]."""
        if self.open_water is not None:
            return bollard_factor(self.open_water, astern=True)
        assert self.astern_thrust is not None
        c0, c1, _, c3 = self.astern_thrust
        return -(c1 if c3 <= 0.0 else c0)


class Rudder(Part):
    """A rudder in the propeller's race (Miyauchi et al. 2022, after Yoshimura and Kitagawa).

    `swamp_rl.physics.rudder` has the equations.
    """

    x: Annotated[float, Unit("m")]
    "x_R, forward of midship."
    area: Annotated[float, POSITIVE, Unit("m2")]
    "A_R."
    aspect_ratio: Annotated[float, POSITIVE, Unit("1")]
    "Λ: height squared over area."
    thrust_deduction: Annotated[float, NOT_NEGATIVE, BELOW_ONE, Unit("1")]
    "t_R: share of the rudder's surge force that is lost."
    a_h: Annotated[float, Unit("1")]
    "a_H: lateral force that the rudder induces on the hull, as a share of its own."
    x_h: Annotated[float, Unit("1")]
    "x'_H: where that force acts, lengths forward of midship."
    flow_lever: Annotated[float, Unit("1")]
    "l'_R of v_R = −γ_R (v + l'_R L r)."
    drift_slope: Annotated[float, Unit("1/rad")] = 0.0
    "s of γ_R (1 + s |β_R|): what the drift at the rudder adds to γ_R, of that flow against u."
    gamma_p: Annotated[float, NOT_NEGATIVE, Unit("1")]
    "γ_R where the stern moves to starboard."
    gamma_n: Annotated[float, NOT_NEGATIVE, Unit("1")]
    "γ_R where the stern moves to port."
    epsilon: Annotated[float, POSITIVE, Unit("1")]
    "ε: wake at the rudder over wake at the propeller, 1 − w_R = ε (1 − w_P)."
    k_x: Annotated[float, NOT_NEGATIVE, Unit("1")]
    "k_x: acceleration of the flow by the propeller, turning ahead."
    k_x_astern: Annotated[float, NOT_NEGATIVE, Unit("1")]
    "k_x where the propeller does not drive the boat ahead (Kitagawa)."
    c_pr: Annotated[float, Unit("1")]
    "C_PR of C_PR u², added to u_R² where the propeller does not drive the boat ahead (Kitagawa)."


class PropellerRudder(Part):
    """One propeller with the rudder behind it, on the centre line.

    Commanded by the rudder's angle [rad], positive turning the bow to starboard, which follows within its
    rate and time constant, and by revolutions [rps], negative astern.
    """

    name: Annotated[str, NAME]
    "Name in runs, effects and the joypad."
    kind: Literal["propeller_rudder"]
    "A propeller with its rudder."
    rudder_max: Annotated[float, RUDDER_ANGLE, Unit("rad")]
    "Greatest rudder angle to either side."
    rudder_rate: Annotated[float, POSITIVE, Unit("rad/s")]
    "Greatest rate of the rudder."
    rudder_time_constant: Annotated[float, NOT_NEGATIVE, Unit("s")]
    "First-order lag of the rudder; 0: none."
    revolutions_max: Annotated[float, POSITIVE, Unit("rps")]
    "Greatest revolutions ahead."
    revolutions_max_astern: Annotated[float, NOT_NEGATIVE, Unit("rps")]
    "Greatest revolutions astern; 0: it does not turn astern."
    revolutions_time_constant: Annotated[float, NOT_NEGATIVE, Unit("s")]
    "First-order lag of the revolutions; 0: none."
    dead_band: Annotated[float, NOT_NEGATIVE, Field(lt=0.9), Unit("1")] = 0.0
    "Share of the greatest revolutions, either way, below which there is no thrust; stretched over the rest."
    propeller: Propeller
    "The propeller."
    rudder: Rudder
    "The rudder."
    power: Power | None = None
    "Electric power: against the thrust at rest, or as measured over the share of the greatest revolutions."

    @model_validator(mode="after")
    def _power_fits(self) -> Self:
        if isinstance(self.power, ShaftPower):
            raise ValueError("power.efficiency: is for a propeller without a rudder; give a curve or a table")
        return self

    @property
    def x(self) -> float:
        """Of the rudder, forward of midship [m]."""
        return self.rudder.x

    @property
    def y(self) -> float:
        """On the centre line [m]."""
        return 0.0

    @property
    def throttle_min(self) -> float:
        """The lowest command [rps]."""
        return -self.revolutions_max_astern

    @property
    def throttle_max(self) -> float:
        """The highest command [rps]."""
        return self.revolutions_max

    @property
    def command_columns(self) -> tuple[str | None, str]:
        """Columns of a run that hold its commands."""
        return f"rudder_{self.name}", f"propeller_{self.name}"

    def thrust_curve(self, water_density: float) -> tuple[float, float]:
        """Linear and quadratic coefficient of the thrust at rest [N] against the command."""
        return 0.0, water_density * self.propeller.diameter**4 * self.propeller.bollard_coefficient

"""What a boat file holds of a propeller with a rudder behind it (MMG form, four quadrants)."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from swamp_rl.boat.part import FROM_LIST, NAME, NOT_NEGATIVE, POSITIVE, Part
from swamp_rl.boat.quantity import Unit

BELOW_ONE = Field(lt=1)
RUDDER_ANGLE = Field(gt=0, lt=math.pi / 2)
Coefficients = Annotated[tuple[float, ...], FROM_LIST, Unit("1")]


class Propeller(Part):
    """A propeller of fixed pitch.

    k_t: thrust coefficients (3) in powers of J. wake_zero, wake_tau, wake_c_p: w_P0, τ and C_P of the wake,
    felt at x_wake lengths forward of midship. astern_thrust: C0 to C3 (4) of Hachii; side_force,
    yaw_moment: A0 to A7 and B0 to B7 (8), Hachii's astern and Ueno's for sternway.
    """

    diameter: Annotated[float, POSITIVE, Unit("m")]
    pitch_ratio: Annotated[float, POSITIVE, Unit("1")]
    thrust_deduction: Annotated[float, NOT_NEGATIVE, BELOW_ONE, Unit("1")]
    wake_zero: Annotated[float, NOT_NEGATIVE, BELOW_ONE, Unit("1")]
    wake_tau: Annotated[float, Unit("1")]
    wake_c_p: Annotated[float, Unit("1")]
    x_wake: Annotated[float, Unit("1")]
    k_t: Coefficients
    astern_thrust: Coefficients
    side_force: Coefficients
    yaw_moment: Coefficients

    @model_validator(mode="after")
    def _coefficients_are_whole(self) -> Self:
        for name, count in (("k_t", 3), ("astern_thrust", 4), ("side_force", 8), ("yaw_moment", 8)):
            given = len(getattr(self, name))
            if given != count:
                raise ValueError(f"{name} needs {count} coefficients, not {given}")
        if self.k_t[0] <= 0:
            raise ValueError("k_t[0], the thrust coefficient at rest, must be above 0: it would never push")
        return self


class Rudder(Part):
    """A rudder at x forward of midship [m].

    a_h, x_h: how much of its force the hull repeats, and where [lengths forward of midship]; flow_lever
    (l'_R), gamma_p and gamma_n (stern moving to starboard, to port): of the flow straightened by the hull;
    epsilon, k_x, k_x_astern, c_pr: of the propeller's race, the last two for one that turns astern.
    """

    x: Annotated[float, Unit("m")]
    area: Annotated[float, POSITIVE, Unit("m2")]
    aspect_ratio: Annotated[float, POSITIVE, Unit("1")]
    thrust_deduction: Annotated[float, NOT_NEGATIVE, BELOW_ONE, Unit("1")]
    a_h: Annotated[float, Unit("1")]
    x_h: Annotated[float, Unit("1")]
    flow_lever: Annotated[float, Unit("1")]
    gamma_p: Annotated[float, NOT_NEGATIVE, Unit("1")]
    gamma_n: Annotated[float, NOT_NEGATIVE, Unit("1")]
    epsilon: Annotated[float, POSITIVE, Unit("1")]
    k_x: Annotated[float, NOT_NEGATIVE, Unit("1")]
    k_x_astern: Annotated[float, NOT_NEGATIVE, Unit("1")]
    c_pr: Annotated[float, Unit("1")]


class PropellerRudder(Part):
    """One propeller with the rudder behind it, on the centre line.

    Commanded by the rudder's angle [rad], positive turning the bow to starboard, which follows within its
    rate and time constant, and by revolutions [rps], negative astern.
    """

    name: Annotated[str, NAME]
    kind: Literal["propeller_rudder"]
    rudder_max: Annotated[float, RUDDER_ANGLE, Unit("rad")]
    rudder_rate: Annotated[float, POSITIVE, Unit("rad/s")]
    rudder_time_constant: Annotated[float, NOT_NEGATIVE, Unit("s")]
    revolutions_max: Annotated[float, POSITIVE, Unit("rps")]
    revolutions_max_astern: Annotated[float, NOT_NEGATIVE, Unit("rps")]
    revolutions_time_constant: Annotated[float, NOT_NEGATIVE, Unit("s")]
    propeller: Propeller
    rudder: Rudder

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
        return 0.0, water_density * self.propeller.diameter**4 * self.propeller.k_t[0]

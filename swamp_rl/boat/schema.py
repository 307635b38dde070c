"""What a boat file may hold. Once loaded, all numbers are plain floats in SI units, angles in radians."""

import math
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, InstanceOf, PrivateAttr, Tag, model_validator

from swamp_rl.boat.battery import Battery, Power, ShaftPower
from swamp_rl.boat.covariance import Covariance
from swamp_rl.boat.foil import Foil
from swamp_rl.boat.loading import Loading
from swamp_rl.boat.part import (
    ANGLE,
    FROM_LIST,
    KIND,
    NAME,
    NOT_NEGATIVE,
    NOT_POSITIVE,
    POSITIVE,
    PRINTED,
    Part,
)
from swamp_rl.boat.propeller_rudder import PropellerRudder
from swamp_rl.boat.quantity import Provenance, Unit
from swamp_rl.boat.resistance import Resistance
from swamp_rl.boat.screw import Screw, ThrustTable
from swamp_rl.boat.thrust_deduction import ThrustDeduction
from swamp_rl.effects import EffectEntry

DEAD_BAND = Field(lt=0.9)
JET, PROPELLER = "a jet", "a propeller with its rudder"  # tags of the two kinds, never seen in a message


class Hull(Part):
    """Nondimensional coefficients of the hull forces (thesis 8.16)."""

    x_vr: Annotated[float, Unit("1")]
    "X'_vr + m'_y: surge force with v r."
    y_v: Annotated[float, Unit("1")]
    "Y'_v: sway force with v |u|."
    y_r: Annotated[float, Unit("1")]
    "Y'_r − m'_x: sway force with r u."
    n_v: Annotated[float, Unit("1")]
    "N'_v: yaw moment with v u."
    n_r: Annotated[float, Unit("1")]
    "N'_r: yaw moment with r |u|."
    c_d: Annotated[float, NOT_NEGATIVE, Unit("1")]
    "Drag coefficient of the cross flow; `yoshimura` in the file: his regression on length over draught."
    c_ry: Annotated[float, Unit("1")]
    "C_rY: factor of the yaw rate in the cross flow of the sway force."
    c_rn: Annotated[float, Unit("1")]
    "C_rN: the same for the yaw moment."
    spacing: Annotated[float, NOT_NEGATIVE, Unit("m")] = 0.0
    "Distance of the centre planes of two demihulls, each at its own surge speed; 0: resistance at midship."


class Thruster(Part):
    """One thruster, at x forward and y starboard of midship [m].

    Its azimuth [rad] is the direction of the force on the boat, positive to starboard. Bollard thrust [N] at
    throttle p is linear p + quadratic p |p|, with the astern pair for p < 0; a zero astern pair: it does not
    reverse. An `azimuth` one turns from azimuth_min to azimuth_max, without end where the file gives neither:
    then its angle counts the turns. A `fixed` one pushes along azimuth_min = azimuth_max. nozzle_area [m²] is
    the jet's, 0 where the thruster has none: then it loses no momentum to the water's own way. advance_loss:
    c_a of T = T_bollard (1 − c_a V_a/V_o), see `swamp_rl.physics.thrusters.loss_under_way`.
    In place of that curve: `propeller`, a model of its thrust over revolutions and speed of advance, or
    `thrust_table`, a measured one.
    """

    name: Annotated[str, NAME]
    "Name in runs, effects and the joypad."
    kind: Annotated[Literal["azimuth", "fixed"], KIND]
    "Whether it turns."
    x: Annotated[float, Unit("m")]
    "Forward of midship."
    y: Annotated[float, Unit("m")]
    "Position to starboard of the centre line."
    azimuth_min: Annotated[float, ANGLE, Unit("rad")] = -math.inf
    "Least azimuth; none: it turns without end."
    azimuth_max: Annotated[float, ANGLE, Unit("rad")] = math.inf
    "Greatest azimuth; none: it turns without end."
    azimuth_rate: Annotated[float, POSITIVE, Unit("rad/s")] = math.inf
    "Greatest rate of the azimuth."
    azimuth_time_constant: Annotated[float, NOT_NEGATIVE, Unit("s")] = 0.0
    "First-order lag of the azimuth."
    azimuth_offset: Annotated[float, ANGLE, Unit("rad")] = 0.0
    "Added to the commanded azimuth."
    pump_time_constant: Annotated[float, NOT_NEGATIVE, Unit("s")]
    "First-order lag of the throttle."
    throttle_rate: Annotated[float | None, POSITIVE, Unit("1/s")] = None
    "Greatest rate of the throttle; none: no limit but that of a propeller's motor."
    thrust_linear: Annotated[float, NOT_NEGATIVE, Unit("N")] = 0.0
    "Thrust at rest, coefficient of the throttle p."
    thrust_quadratic: Annotated[float, NOT_NEGATIVE, Unit("N")] = 0.0
    "Thrust at rest, coefficient of p |p|."
    astern_linear: Annotated[float, NOT_NEGATIVE, Unit("N")] = 0.0
    "Thrust at rest, coefficient of p, for p < 0."
    astern_quadratic: Annotated[float, NOT_NEGATIVE, Unit("N")] = 0.0
    "Thrust at rest, coefficient of p |p|, for p < 0; both 0: no reverse thrust."
    dead_band: Annotated[float, NOT_NEGATIVE, DEAD_BAND, Unit("1")] = 0.0
    "Throttle, either way, below which it gives no thrust; the curve is stretched over the rest."
    nozzle_area: Annotated[float, NOT_NEGATIVE, Unit("m2")] = 0.0
    "Outlet area of the jet; 0: no momentum drag."
    advance_loss: Annotated[float, NOT_NEGATIVE, Unit("1")] = 0.0
    "c_a of T = T_bollard (1 − c_a V_a/V_o)."
    propeller: Screw | None = None
    "In place of the thrust curve: a propeller, whose thrust depends on its speed of advance."
    thrust_table: ThrustTable | None = None
    "In place of the thrust curve: thrust as measured over throttle and speed of advance."
    foil: Foil | None = None
    "The leg, strut or nozzle as a foil that turns with the thrust; none: no force but the thrust."
    power: Power | None = None
    "Electric power: against the thrust at rest, as measured over the throttle, or by the propeller's torque."

    @model_validator(mode="after")
    def _can_be_built(self) -> Self:
        self._refuse_two_curves()
        if isinstance(self.power, ShaftPower) and (
            self.propeller is None or self.propeller.torque_coefficient is None
        ):
            raise ValueError("power.efficiency: needs propeller.torque_coefficient; add it, or give a table")
        if self.kind == "fixed" and self.azimuth_min != self.azimuth_max:
            raise ValueError("a fixed thruster pushes one way: azimuth_min and azimuth_max must be equal")
        if math.isinf(self.azimuth_min) != math.isinf(self.azimuth_max):
            raise ValueError(
                "has one of azimuth_min and azimuth_max: give both, or neither where it turns without end"
            )
        if self.kind == "azimuth" and not self.azimuth_min < self.azimuth_max:
            raise ValueError("azimuth_min must be below azimuth_max")
        if self.kind == "azimuth" and not {"azimuth_rate", "azimuth_time_constant"} <= self.model_fields_set:
            raise ValueError("an azimuth thruster needs azimuth_rate [rad/s] and azimuth_time_constant [s]")
        return self

    def _refuse_two_curves(self) -> None:
        curve = [self.thrust_linear, self.thrust_quadratic, self.astern_linear, self.astern_quadratic]
        if self.propeller is not None and self.thrust_table is not None:
            raise ValueError("has both propeller and thrust_table; give one")
        if self.propeller is None and self.thrust_table is None:
            if self.thrust_linear + self.thrust_quadratic == 0:
                raise ValueError(
                    "thrust_linear and thrust_quadratic are both 0: it would never push; give one, or "
                    "propeller, or thrust_table"
                )
            return
        other = "propeller" if self.propeller is not None else "thrust_table"
        if sum(curve) > 0 or self.advance_loss > 0:
            raise ValueError(
                f"has {other} and a thrust curve; set thrust_linear, thrust_quadratic, astern_linear, "
                "astern_quadratic and advance_loss to null"
            )

    @property
    def endless(self) -> bool:
        """Whether it turns without end, so that commands may count any number of turns."""
        return self.kind == "azimuth" and math.isinf(self.azimuth_max)

    @property
    def reverses(self) -> bool:
        """Whether throttles down to -1 are allowed."""
        if self.propeller is not None:
            return self.propeller.revolutions_max_astern > 0
        if self.thrust_table is not None:
            return self.thrust_table.rows[0].throttle < 0
        return self.astern_linear + self.astern_quadratic > 0

    @property
    def throttle_min(self) -> float:
        """The lowest command [1]."""
        return -1.0 if self.reverses else 0.0

    @property
    def throttle_max(self) -> float:
        """The highest command [1]."""
        return 1.0

    @property
    def command_columns(self) -> tuple[str | None, str]:
        """Columns of a run that hold its commands, the first None where it does not turn."""
        return f"azimuth_{self.name}" if self.kind == "azimuth" else None, f"throttle_{self.name}"

    def thrust_curve(self, water_density: float) -> tuple[float, float]:
        """Linear and quadratic coefficient of the thrust at rest [N] against the command.

        A table is taken as quadratic through full throttle.
        """
        if self.propeller is not None:
            return 0.0, self.propeller.bollard(water_density)
        if self.thrust_table is not None:
            return 0.0, self.thrust_table.thrust_at_rest(1.0)
        return self.thrust_linear, self.thrust_quadratic

    def greatest_throttle_rate(self, water_density: float) -> float | None:
        """Of the throttle [1/s]; None where nothing limits it.

        Of a motor: 0.9 over the time in which its full torque brings the propeller, at rest in the water,
        from 0 to 90 % of its revolutions (Allotta et al. 2018, 31).
        """
        rates = [self.throttle_rate] if self.throttle_rate is not None else []
        if self.propeller is not None and self.propeller.motor is not None:
            rates.append(self.propeller.mean_acceleration(water_density))
        return min(rates, default=None)


def kind_of_thruster(given: Any) -> str:
    """Which model an item of `thrusters`, in a file or loaded, is of."""
    kind = given.get("kind") if isinstance(given, dict) else getattr(given, "kind", None)
    return PROPELLER if kind == "propeller_rudder" else JET


def refuse_wash(thrusters: "tuple[Thruster | PropellerRudder, ...]") -> None:
    """ValueError unless every propeller in a race stands in that of a fixed one with a propeller in none."""
    known = {item.name: item for item in thrusters}
    for item in thrusters:
        wash = item.propeller.wash if isinstance(item, Thruster) and item.propeller else None
        if wash is None:
            continue
        ahead = known.get(wash.of)
        if not isinstance(ahead, Thruster) or ahead.propeller is None or ahead.propeller.wash is not None:
            raise ValueError(
                f"thrusters.{item.name}.propeller.wash.of must name a thruster with a propeller that stands "
                f"in no race itself, not {wash.of!r}"
            )
        if item.kind != "fixed" or ahead.kind != "fixed":
            raise ValueError(
                f"thrusters.{item.name}.propeller.wash: needs both thrusters fixed; a race that turns is in "
                "no model"
            )


AnyThruster = Annotated[
    Annotated[Thruster, Tag(JET)] | Annotated[PropellerRudder, Tag(PROPELLER)],
    Discriminator(kind_of_thruster),
]


class Wind(Part):
    """What the wind meets: areas [m²], lateral centre forward of midship [m], coefficients (8.17 to 8.19)."""

    air_density: Annotated[float, POSITIVE, Unit("kg/m3")]
    "Density of the air."
    frontal_area: Annotated[float, NOT_NEGATIVE, Unit("m2")]
    "Projected area ahead."
    lateral_area: Annotated[float, NOT_NEGATIVE, Unit("m2")]
    "Projected area abeam."
    lateral_centre: Annotated[float, Unit("m")]
    "Centre of the lateral area, forward of midship."
    c_x: Annotated[float, NOT_NEGATIVE, Unit("1")]
    "Surge coefficient (8.17)."
    c_y: Annotated[float, NOT_NEGATIVE, Unit("1")]
    "Sway coefficient (8.18)."
    c_n: Annotated[float, Unit("1")]
    "Yaw: lever of the sway force in lengths, c_n (1 − 2 |a|/π)."


class Current(Part):
    """How a current acts.

    model `relative`: through the velocity over the water alone; `dnv_force`: the thesis's extra force (8.20
    to 8.22), on these underwater areas [m²] with lateral centre forward of midship [m].
    """

    model: Literal["relative", "dnv_force"]
    "Model of the current's action."
    frontal_area: Annotated[float, NOT_NEGATIVE, Unit("m2")]
    "Underwater area ahead."
    lateral_area: Annotated[float, NOT_NEGATIVE, Unit("m2")]
    "Underwater area abeam."
    lateral_centre: Annotated[float, Unit("m")]
    "Centre of the lateral area, forward of midship."
    c_x: Annotated[float, NOT_NEGATIVE, Unit("1")]
    "Surge coefficient."
    c_y: Annotated[float, NOT_NEGATIVE, Unit("1")]
    "Sway coefficient."


class Joypad(Part):
    """What a pilot's levers command: ends of the throttle [1] and azimuth [rad] of the named thrusters.

    For a propeller with a rudder: shares of its highest revolutions, and rudder angles. The lever to
    starboard turns the bow to starboard: thrusters aft of midship take the azimuth with the other sign, and
    fixed ones steer by differential thrust. A joypad of fixed ones alone needs no azimuth.
    """

    thrusters: Annotated[tuple[str, ...], Field(strict=False, min_length=1)]
    "Names of the thrusters that it drives."
    throttle: Annotated[tuple[float, float], FROM_LIST, Unit("1")]
    "Throttle at the lever's two ends."
    azimuth: Annotated[tuple[float, float], FROM_LIST, Unit("rad")] = (0.0, 0.0)
    "Azimuth at the lever's two ends."

    @model_validator(mode="after")
    def _ends_are_in_order(self) -> Self:
        if not -1 <= self.throttle[0] < self.throttle[1] <= 1:
            raise ValueError("throttle must be [low, high] within [-1, 1]")
        if not -2 * math.pi <= self.azimuth[0] <= self.azimuth[1] <= 2 * math.pi:
            raise ValueError("azimuth must be [low, high] in radians, within a full turn")
        return self


class Boat(Part):
    """A boat file: particulars, hull, resistance, thrusters, what wind and current meet, and its effects.

    Added masses are the hydrodynamic derivatives, hence negative or zero.
    """

    name: Annotated[str, Field(min_length=1, max_length=100), PRINTED]
    "Name in reports."
    length: Annotated[float, POSITIVE, Unit("m")]
    "Length of the hull, L."
    breadth: Annotated[float, POSITIVE, Unit("m")]
    "Breadth of the hull, B."
    draught: Annotated[float, POSITIVE, Unit("m")]
    "Draught of the hull, d; `loading` in the file: that of `mass` by the table `loading`."
    mass: Annotated[float, POSITIVE, Unit("kg")]
    "Without added mass."
    inertia_z: Annotated[float, POSITIVE, Unit("kg m2")]
    "About the centre of gravity, without added inertia."
    x_g: Annotated[float, Unit("m")]
    "Centre of gravity, forward of midship."
    added_mass_surge: Annotated[float, NOT_POSITIVE, Unit("kg")]
    "Hydrodynamic derivative by surge acceleration."
    added_mass_sway: Annotated[float, NOT_POSITIVE, Unit("kg")]
    "Hydrodynamic derivative by sway acceleration."
    added_inertia_yaw: Annotated[float, NOT_POSITIVE, Unit("kg m2")]
    "Hydrodynamic derivative by yaw acceleration."
    water_density: Annotated[float, POSITIVE, Unit("kg/m3")]
    "Density of the water."
    hull: Hull
    "Hull coefficients."
    resistance: Resistance
    "A towing tank's table, or coefficients by drift angle."
    thrusters: Annotated[tuple[AnyThruster, ...], Field(strict=False, min_length=1)]
    "Thrusters, in the order of every per-thruster array."
    thrust_deduction: ThrustDeduction | None = None
    "Thrust deduction of the jets, none where it is left out; a propeller has its own."
    wind: Wind
    "Areas and coefficients above water."
    current: Current
    "Model of the current."
    joypad: Joypad
    "What a pilot's two levers command."
    loading: Loading | None = None
    "Draught over load; none where it is left out."
    battery: Battery | None = None
    "Packs, their limits and the hotel load; none where it is left out."
    covariance: Covariance | None = None
    "Errors of fitted numbers, as `swamp-rl identify boat` writes them."
    effects: tuple[InstanceOf[EffectEntry], ...] = ()
    "Departures from the file, see the catalogue."
    _provenance: dict[str, Provenance] = PrivateAttr(default_factory=dict)

    @property
    def thruster_names(self) -> tuple[str, ...]:
        """Names in the order of every per-thruster array."""
        return tuple(thruster.name for thruster in self.thrusters)

    @property
    def beside_joypad(self) -> tuple[str, ...]:
        """Names of the thrusters that the joypad's levers do not drive."""
        return tuple(name for name in self.thruster_names if name not in self.joypad.thrusters)

    @property
    def provenance(self) -> dict[str, Provenance]:
        """Unit, provenance and source of each number by its dotted key, such as `thrusters.bs.x`."""
        return self._provenance

    @model_validator(mode="after")
    def _thrusters_fit(self) -> Self:
        names = self.thruster_names
        if len(set(names)) < len(names):
            raise ValueError(f"thruster names must differ, but are {', '.join(names)}")
        refuse_wash(self.thrusters)
        if "all" in names:
            raise ValueError(
                "thrusters.all: a thruster cannot be named 'all': effects use it for all of them"
            )
        joypad = self.joypad.thrusters
        if not set(joypad) <= set(names) or len(set(joypad)) < len(joypad):
            raise ValueError(f"joypad.thrusters must be different names out of {', '.join(names)}")
        turning = [item.name for item in self.thrusters if item.name in joypad and item.kind != "fixed"]
        if turning and "azimuth" not in self.joypad.model_fields_set:
            raise ValueError(f"joypad.azimuth: is missing; add it, for {', '.join(turning)} can turn")
        return self

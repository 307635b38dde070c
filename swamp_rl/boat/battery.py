"""What a boat file may hold of its batteries and of the electric power that a thruster draws."""

from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import Discriminator, Field, Tag, model_validator

from swamp_rl.boat.part import FRACTION, FROM_LIST, NOT_NEGATIVE, POSITIVE, Part
from swamp_rl.boat.quantity import Unit
from swamp_rl.boat.resistance import increasing

CURVE, MEASURED, SHAFT = (
    "a power curve",
    "a table of powers",
    "power by the shaft's torque",
)  # tags, never seen


class PowerCurve(Part):
    """Electric power of a thruster, P = P_0 + k T^1.5, T [N] its thrust at rest at the same throttle.

    The exponent is that of momentum theory: a jet of area A leaves ½ T^1.5 / √(ρ A) in the water.
    """

    idle: Annotated[float, NOT_NEGATIVE, Unit("W")]
    "P_0, drawn at every throttle, 0 included."
    coefficient: Annotated[float, NOT_NEGATIVE, Unit("W/N1.5")]
    "k."


class PowerTable(Part):
    """Electric power of a thruster as measured over the share of its greatest command, linear between."""

    throttle: Annotated[tuple[float, ...], FROM_LIST, Field(min_length=2, max_length=1000), Unit("1")]
    "Share of the greatest command, from 0 to 1; astern as ahead."
    power: Annotated[
        tuple[Annotated[float, NOT_NEGATIVE], ...], FROM_LIST, Field(min_length=2, max_length=1000), Unit("W")
    ]
    "Power at each of these throttles."

    @model_validator(mode="after")
    def _is_a_curve(self) -> Self:
        if len(self.throttle) != len(self.power):
            raise ValueError("throttle and power must be as many")
        if not increasing(self.throttle) or self.throttle[0] != 0.0 or self.throttle[-1] != 1.0:
            raise ValueError("throttle must increase from 0 to 1")
        return self


class ShaftPower(Part):
    """Electric power by the propeller's torque at rest, P = P_0 + 2π n Q/η, Q = K_q ρ n² d⁵.

    K_q is the propeller's `torque_coefficient`.
    """

    idle: Annotated[float, NOT_NEGATIVE, Unit("W")]
    "P_0, drawn at every throttle, 0 included."
    efficiency: Annotated[float, POSITIVE, Field(le=1), Unit("1")]
    "η of motor, drive and gear: shaft power over electric power."


def kind_of_power(given: Any) -> str:
    """Which of the three a section `power`, in a file or loaded, is."""
    keys = given if isinstance(given, Mapping) else getattr(type(given), "model_fields", ())
    return MEASURED if "throttle" in keys else SHAFT if "efficiency" in keys else CURVE


Power = Annotated[
    Annotated[PowerCurve, Tag(CURVE)]
    | Annotated[PowerTable, Tag(MEASURED)]
    | Annotated[ShaftPower, Tag(SHAFT)],
    Discriminator(kind_of_power),
]


class Battery(Part):
    """One pack, or two equal ones, each with its own thrusters and its own hotel load.

    Of two packs the first lies in the starboard hull and feeds the thrusters at y > 0, the second in the port
    hull those at y < 0; one on the centre line draws half of its power from each. The voltage falls linearly
    with the charge drawn, V(s) = V_e + (V_f − V_e) s, s in [0, 1] the state of charge.
    """

    voltage_full: Annotated[float, POSITIVE, Unit("V")]
    "V_f of a full pack."
    voltage_empty: Annotated[float, POSITIVE, Unit("V")]
    "V_e at s = 0."
    capacity: Annotated[float, POSITIVE, Unit("C")]
    "Charge of a pack; 3600 C are 1 Ah."
    depth_of_discharge: Annotated[float, FRACTION, Unit("1")]
    "Share of the capacity that may be drawn; the rest is the reserve."
    current_continuous: Annotated[float, POSITIVE, Unit("A")]
    "Greatest current of a pack for any time."
    current_peak: Annotated[float, POSITIVE, Unit("A")]
    "Greatest current of a pack for a short time."
    hotel_power: Annotated[float, NOT_NEGATIVE, Unit("W")]
    "Drawn from each pack by all but its thrusters."
    packs: Annotated[int, Field(ge=1, le=2), Unit("1")]
    "1, or 2 where each hull has its own."
    thrust_exponent: Annotated[float, Field(ge=0.0, le=4.0), Unit("1")] = 0.0
    "e of T ∝ (V/V_f)^e in a mission: 0 of drives that regulate their speed, 2 of motors at V itself."

    @model_validator(mode="after")
    def _limits_are_in_order(self) -> Self:
        if self.voltage_empty > self.voltage_full:
            raise ValueError("voltage_empty must not be above voltage_full")
        if self.current_continuous > self.current_peak:
            raise ValueError("current_continuous must not be above current_peak")
        return self

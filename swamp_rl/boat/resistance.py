"""What a boat file holds of the hull's resistance: a towing tank's results, or published coefficients."""

from itertools import pairwise
from typing import Annotated, Any, Self

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from swamp_rl.boat.part import FROM_LIST, NOT_POSITIVE, POSITIVE, Part
from swamp_rl.boat.quantity import Unit

TABLE, DRIFT = "from a towing tank", "by drift angle"  # tags of the two kinds, never seen in a message


class ResistanceCurve(Part):
    """Resistance [N] against speed [m/s], as towed at one ratio of water depth to draught."""

    h_over_t: Annotated[float, POSITIVE, Unit("1")]
    "Ratio of water depth to draught at which it was towed."
    speed: Annotated[tuple[Annotated[float, POSITIVE], ...], FROM_LIST, Unit("m/s")]
    "Through the water, increasing."
    resistance: Annotated[tuple[Annotated[float, POSITIVE], ...], FROM_LIST, Unit("N")]
    "Resistance at each of these speeds."

    @model_validator(mode="after")
    def _is_a_curve(self) -> Self:
        if len(self.speed) != len(self.resistance) or len(self.speed) < 2:
            raise ValueError("needs two or more speeds and as many resistances")
        if not increasing(self.speed):
            raise ValueError("the speeds must increase from each to the next")
        return self


class TankResistance(Part):
    """The towing tank's results, with the mass [kg] and water density [kg/m³] they hold for."""

    reference_mass: Annotated[float, POSITIVE, Unit("kg")]
    "Mass of the model as towed; the resistance is scaled from it to the boat's `mass`."
    reference_density: Annotated[float, POSITIVE, Unit("kg/m3")]
    "Density of the tank's water; the resistance is scaled from it to `water_density`."
    table: Annotated[tuple[ResistanceCurve, ...], Field(strict=False, min_length=1)]
    "Curves by increasing `h_over_t`."

    @field_validator("table")
    @classmethod
    def _depths_increase(cls, table: tuple[ResistanceCurve, ...]) -> tuple[ResistanceCurve, ...]:
        if not increasing([curve.h_over_t for curve in table]):
            raise ValueError("h_over_t must increase from each curve to the next")
        return table


class DriftResistance(Part):
    """X'_0 ahead and astern, between them linear in the drift angle: ½ρLd X'_0 u U [N], in deep water."""

    x_0_ahead: Annotated[float, NOT_POSITIVE, Unit("1")]
    "X'_0F: surge force in straight motion ahead."
    x_0_astern: Annotated[float, NOT_POSITIVE, Unit("1")]
    "X'_0A: surge force in straight motion astern."


def kind(given: Any) -> str:
    """Which of the two a section of a file, or a model of one, is."""
    by_drift = isinstance(given, DriftResistance) or (
        isinstance(given, dict) and not given.keys().isdisjoint(DriftResistance.model_fields)
    )
    return DRIFT if by_drift else TABLE


Resistance = Annotated[
    Annotated[TankResistance, Tag(TABLE)] | Annotated[DriftResistance, Tag(DRIFT)], Discriminator(kind)
]


def increasing(values: tuple[float, ...] | list[float]) -> bool:
    """Whether each value is above the one before."""
    return all(low < high for low, high in pairwise(values))

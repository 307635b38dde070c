"""Draught over load: the hull's hydrostatics as a table of the boat file."""

from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, model_validator

from swamp_rl.boat.part import FROM_LIST, POSITIVE, Part
from swamp_rl.boat.quantity import Unit
from swamp_rl.boat.resistance import increasing


class Loading(Part):
    """Draught against displaced mass, as `swamp-rl design hull` writes it.

    `draught: loading` takes the draught of the boat's `mass` from it, linear in the displaced volume.
    """

    density: Annotated[float, POSITIVE, Unit("kg/m3")]
    "Density of the water that the table holds for."
    mass: Annotated[tuple[Annotated[float, POSITIVE], ...], FROM_LIST, Field(max_length=1000), Unit("kg")]
    "Increasing."
    draught: Annotated[tuple[Annotated[float, POSITIVE], ...], FROM_LIST, Field(max_length=1000), Unit("m")]
    "Draught at each of these masses, increasing."

    @model_validator(mode="after")
    def _is_a_curve(self) -> Self:
        if len(self.mass) != len(self.draught) or len(self.mass) < 2:
            raise ValueError("needs two or more masses and as many draughts")
        if not (increasing(self.mass) and increasing(self.draught)):
            raise ValueError("mass and draught must increase from each to the next")
        return self

    def draught_at(self, mass: float, density: float) -> float:
        """Draught [m] of a mass [kg] in water of a density [kg/m³]; ValueError beyond the table."""
        as_of_table = mass * self.density / density
        if not self.mass[0] <= as_of_table <= self.mass[-1]:
            low, high = (end * density / self.density for end in (self.mass[0], self.mass[-1]))
            raise ValueError(f"mass {mass:g} kg lies outside the table, {low:.4g} to {high:.4g} kg")
        return float(np.interp(as_of_table, self.mass, self.draught))


def is_loading(given: Any) -> bool:
    """Whether a value of the file asks for the draught of the load."""
    return isinstance(given, str) and given == "loading"

"""What a boat file holds of the thrust that the hull loses to its jets."""

from typing import Annotated, Self

from pydantic import model_validator

from swamp_rl.boat.part import FRACTION, Part
from swamp_rl.boat.quantity import Unit


class ThrustDeduction(Part):
    """1 - t against throttle: linear between two points, constant outside them; 1 where a file has none."""

    throttle_low: Annotated[float, FRACTION, Unit("1")]
    "Throttle at the lower point."
    factor_low: Annotated[float, FRACTION, Unit("1")]
    "1 − t there."
    throttle_high: Annotated[float, FRACTION, Unit("1")]
    "Throttle at the upper point."
    factor_high: Annotated[float, FRACTION, Unit("1")]
    "1 − t there."

    @model_validator(mode="after")
    def _low_is_below_high(self) -> Self:
        if not self.throttle_low < self.throttle_high:
            raise ValueError("throttle_low must be below throttle_high")
        return self

"""What a boat file holds of the leg, strut or nozzle of a thruster, a foil in the flow."""

import math
from typing import Annotated

from pydantic import Field

from swamp_rl.boat.part import NOT_NEGATIVE, POSITIVE, Part
from swamp_rl.boat.quantity import Unit

HALF_PI = 0.5 * math.pi


class Foil(Part):
    """A foil at the thruster, its chord along the thrust (`swamp_rl.physics.foil`).

    It has the lift and the induced drag of a rudder of its size outside of a propeller's race, also with the
    thruster stopped.
    """

    area: Annotated[float, POSITIVE, Unit("m2")]
    "A: lateral area."
    aspect_ratio: Annotated[float, POSITIVE, Unit("1")]
    "Λ: height squared over area."
    gamma: Annotated[float, NOT_NEGATIVE, Unit("1")] = 1.0
    "γ of the flow across the boat at the foil, γ (v + x r): below 1 the hull straightens it."
    stall_angle: Annotated[float, Field(gt=0, le=HALF_PI), Unit("rad")] = HALF_PI
    "α_s: angle of attack beyond which the force across the chord does not rise; none: it rises up to π/2."

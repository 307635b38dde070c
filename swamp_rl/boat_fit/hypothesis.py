"""A boat whose numbers are free, as a hypothesis of the critic's output-error fit."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat_numbers.number import Number
from swamp_rl.boat_numbers.numbers import write_numbers
from swamp_rl.criticism.model.candidates import (
    ONE_RUN,
    EffectInstance,
    Hypothesis,
    Spec,
    differing,
    instances_of,
)
from swamp_rl.effects import LIBRARY, Effect
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]

WIND_SD = 3.0  # m/s, prior of each component of a run's mean wind
OF_ACTUATORS = ("pump_time_constant", "azimuth_time_constant", "command_delay")  # fields of the record
OF_LIKE_THRUSTERS = (  # fields of the record, one number for each thruster
    "thrust_linear",
    "thrust_quadratic",
    "astern_linear",
    "astern_quadratic",
    "advance_loss",
    "efficiency_100",
    "dead_band",
)
LIKENESS = 0.9  # prior correlation [1] of such numbers of thrusters that are equal in the start file
CALM = 0.3  # m/s, where the fit of a wind begins: at none a boat at rest does not feel it change
NUMBERS = Effect("boat", (), "actuator", "replace", "numbers of the boat file", "", moves_actuators=True)


@dataclass(frozen=True)
class FreeBoat(Hypothesis):
    """Free numbers of the boat file, and a mean wind for each run where `instances` has a second effect.

    x: the numbers in their order, then the wind's north and east component, run after run.
    """

    numbers: tuple[Number, ...] = ()

    @property
    def winds(self) -> Hypothesis:
        """The winds alone."""
        return Hypothesis(self.instances[1:])

    def prior(self) -> tuple[Array, Array]:
        """(p,) mean and (p,) precision of the Gaussian prior."""
        winds = self.size - len(self.numbers)
        mean = np.array([number.mean for number in self.numbers] + [0.0] * winds)
        sd = np.array([number.sd for number in self.numbers] + [WIND_SD] * winds)
        return mean, sd**-2

    @cached_property
    def prior_precision(self) -> Array:
        """(p, p) inverse covariance of the prior; equal thrusters of the start file are correlated."""
        sd = self.prior()[1] ** -0.5
        correlation = np.eye(len(sd))
        for i, one in enumerate(self.numbers):
            for k, other in enumerate(self.numbers[:i]):
                if one.field in OF_LIKE_THRUSTERS and _of_equals(one, other):
                    correlation[i, k] = correlation[k, i] = LIKENESS
        return np.asarray(np.linalg.inv(correlation) / np.outer(sd, sd))

    def start(self) -> Array:
        """(p,) where a fit begins: the boat file, and next to no wind."""
        winds = self.size - len(self.numbers)
        return np.array([number.begin for number in self.numbers] + [CALM] * winds)

    def of_actuators(self, x: Array) -> Array:
        """(V, p) the numbers x (V, p), those that do not move the actuators at their prior mean."""
        mean = np.repeat(self.prior()[0][None], len(x), axis=0)
        moving = [i for i, number in enumerate(self.numbers) if number.field in OF_ACTUATORS]
        mean[:, moving] = x[:, moving]
        return mean

    def records(
        self, boat: Boat, x: Array, plain: NDArray[Any] | None = None, runs: NDArray[np.int64] = ONE_RUN
    ) -> NDArray[Any]:
        """(V W,) parameter records with x (V, p) in the runs (W,), as `Hypothesis.records`."""
        record = parameters(boat) if plain is None else plain
        count = len(self.numbers)
        made = self.winds.records(boat, x[:, count:], record, runs)
        write_numbers(self.numbers, made, np.repeat(x[:, :count], len(runs), axis=0))
        return made


def _of_equals(one: Number, other: Number) -> bool:
    """Whether two numbers differ by their thruster alone."""
    return replace(one, name="", trial="", thrusters=()) == replace(other, name="", trial="", thrusters=())


def free_boat(boat: Boat, numbers: tuple[Number, ...], runs: int) -> FreeBoat:
    """The hypothesis of a boat with those numbers free; runs: how many have an own wind."""
    specs = tuple(
        Spec(number.sd, *number.bounds, (number.mean,), number.step * number.sd) for number in numbers
    )
    instances = [EffectInstance(NUMBERS, (), specs, ())]
    if runs:
        instances.append(differing(instances_of(LIBRARY["wind"], boat)[0], "run", tuple(range(runs))))
    return FreeBoat(tuple(instances), numbers)

"""A boat whose numbers are free, as a hypothesis of the critic's output-error fit."""

from collections.abc import Sequence
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

WEATHER_SD = {"wind": 3.0, "current": 0.3}  # m/s, prior of each component of a run's mean
OF_ACTUATORS = ("pump_time_constant", "azimuth_time_constant", "command_delay")  # fields of the record
OF_LIKE_THRUSTERS = (  # fields of the record, one number for each thruster
    "thrust_linear",
    "thrust_quadratic",
    "astern_linear",
    "astern_quadratic",
    "advance_loss",
    "efficiency_100",
    "dead_band",
    "foil_area",
    "foil_gamma",
)
LIKENESS = 0.9  # prior correlation [1] of such numbers of thrusters that are equal in the start file
# m/s, where the fit of a weather begins: at no wind a boat at rest does not feel it change
CALM = {"wind": 0.3, "current": 0.0}
NUMBERS = Effect("boat", (), "actuator", "replace", "numbers of the boat file", "", moves_actuators=True)


@dataclass(frozen=True)
class FreeBoat(Hypothesis):
    """Free numbers of the boat file, and a mean wind or current for each run where `instances` has more.

    x: the numbers in their order, then of each weather the north and east component, run after run.
    """

    numbers: tuple[Number, ...] = ()

    @property
    def weather(self) -> Hypothesis:
        """Winds and currents alone."""
        return Hypothesis(self.instances[1:])

    def of_weather(self, each: dict[str, float]) -> list[float]:
        """A number of each weather, by name, for each of its parameters in all runs."""
        return [each[one.effect.name] for one in self.weather.instances for _ in one.specs]

    def prior(self) -> tuple[Array, Array]:
        """(p,) mean and (p,) precision of the Gaussian prior."""
        mean = np.array([number.mean for number in self.numbers] + [0.0] * self.weather.size)
        sd = np.array([number.sd for number in self.numbers] + self.of_weather(WEATHER_SD))
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
        """(p,) where a fit begins: the boat file, and next to no weather."""
        return np.array([number.begin for number in self.numbers] + self.of_weather(CALM))

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
        made = self.weather.records(boat, x[:, count:], record, runs)
        write_numbers(self.numbers, made, np.repeat(x[:, :count], len(runs), axis=0))
        return made


def _of_equals(one: Number, other: Number) -> bool:
    """Whether two numbers differ by their thruster alone."""
    return replace(one, name="", trial="", thrusters=()) == replace(other, name="", trial="", thrusters=())


def free_boat(
    boat: Boat, numbers: tuple[Number, ...], runs: int = 0, weather: Sequence[str] = ()
) -> FreeBoat:
    """The hypothesis of a boat with those numbers free; weather: `wind` and `current`, of which each of so
    many runs has its own.
    """
    specs = tuple(
        Spec(number.sd, *number.bounds, (number.mean,), number.step * number.sd) for number in numbers
    )
    instances = [EffectInstance(NUMBERS, (), specs, ())]
    for name in weather:
        instances.append(differing(instances_of(LIBRARY[name], boat)[0], "run", tuple(range(runs))))
    return FreeBoat(tuple(instances), numbers)

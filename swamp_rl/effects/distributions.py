"""How a disturbance's number is drawn: a distribution turns a uniform number in [0, 1) into a value."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.effects.entries import is_number
from swamp_rl.errors import UserError
from swamp_rl.explain import in_yaml

Array = NDArray[np.float64]
KINDS = ("uniform", "log_uniform", "choice", "normal")


@dataclass(frozen=True)
class Distribution:
    """A number, or one drawn.

    kind `number`: numbers holds it alone; `uniform`, `log_uniform`: the two ends; `choice`: the options;
    `normal`: mean, standard deviation and the two ends beyond which it is cut off.
    """

    kind: str
    numbers: tuple[float, ...]

    @property
    def reach(self) -> tuple[float, ...]:
        """Numbers that it lies among: if these are allowed, so is whatever is drawn."""
        return self.numbers[2:] if self.kind == "normal" else self.numbers

    @property
    def draws(self) -> int:
        """How many uniforms a value takes: none for a fixed number."""
        return 0 if self.kind == "number" else 1

    def values(self, uniforms: Array) -> Array:
        """(n,) values from (n, draws) uniforms, each from its own row alone."""
        if self.kind == "number":
            return np.full(len(uniforms), self.numbers[0])
        uniform = uniforms[:, 0]
        if self.kind == "choice":
            return np.array(self.numbers)[option(uniform, len(self.numbers))]
        if self.kind == "normal":
            return _cut_normal(uniform, *self.numbers)
        low, high = self.numbers
        spread = uniform * (high - low) + low
        if self.kind == "log_uniform":
            spread = low * each(math.exp, math.log(high / low) * uniform)
        return np.clip(spread, low, high)  # rounding must not carry a value past the end that was checked


def columns(uniforms: Array, widths: Sequence[int]) -> list[Array]:
    """Cut (n, sum(widths)) into blocks (n, width)."""
    ends = np.cumsum(widths)
    return [uniforms[:, end - width : end] for width, end in zip(widths, ends, strict=True)]


def each(function: Callable[[float], float], values: Array) -> Array:
    """The function of each value, one by one.

    NumPy's own vectorised functions may differ in the last bit with the length and layout of the array, which
    would make an episode depend on the batch it is drawn in.
    """
    return np.array([function(value) for value in values.tolist()], dtype=float)


def option(uniform: Array, options: int) -> NDArray[np.intp]:
    """(n,) index of the equally likely option that each uniform falls on."""
    return np.minimum((uniform * options).astype(np.intp), options - 1)


def _cut_normal(uniform: Array, mean: float, deviation: float, low: float, high: float) -> Array:
    """(n,) values of the normal distribution between low and high, by the inverse of its integral."""
    bell = NormalDist(mean, deviation)
    below, above = bell.cdf(low), bell.cdf(high)
    least = math.nextafter(0.0, 1.0), math.nextafter(1.0, 0.0)
    shares = np.clip(below + uniform * (above - below), *least)
    return np.clip(each(bell.inv_cdf, shares), low, high)


def parse_distribution(given: Any, where: str) -> Distribution:
    """A number, or a mapping of one of KINDS to its numbers, see `Distribution`; UserError otherwise."""
    if is_number(given):
        return Distribution("number", (float(given),))
    if not isinstance(given, Mapping) or len(given) != 1 or next(iter(given)) not in KINDS:
        raise UserError(
            f"{where}: must be a number, {{uniform: [a, b]}}, {{log_uniform: [a, b]}}, {{choice: [a, ...]}} "
            f"or {{normal: [mean, deviation, low, high]}}, not {in_yaml(given)}"
        )
    ((kind, numbers),) = given.items()
    if not isinstance(numbers, list | tuple) or not numbers or not all(map(is_number, numbers)):
        raise UserError(f"{where}: {kind} must be a list of numbers, not {in_yaml(numbers)}")
    if kind == "normal":
        _check_normal(numbers, where)
    elif kind != "choice" and (len(numbers) != 2 or not numbers[0] <= numbers[1]):
        raise UserError(f"{where}: {kind} must be [low, high] with low at most high, not {in_yaml(numbers)}")
    if kind == "log_uniform" and numbers[0] <= 0:
        raise UserError(f"{where}: log_uniform must begin above 0, not at {numbers[0]!r}")
    return Distribution(str(kind), tuple(map(float, numbers)))


def _check_normal(numbers: Sequence[float], where: str) -> None:
    if len(numbers) != 4 or not numbers[1] > 0.0 or not numbers[2] < numbers[3]:
        raise UserError(
            f"{where}: normal must be [mean, deviation, low, high] with a deviation above 0 and low below "
            f"high, not {in_yaml(numbers)}"
        )
    mean, deviation, low, high = numbers
    if not low - 3.0 * deviation <= mean <= high + 3.0 * deviation:
        raise UserError(
            f"{where}: normal has its mean {mean!r} more than 3 deviations outside of {low!r} to {high!r}; "
            "widen them"
        )

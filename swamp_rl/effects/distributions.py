"""How a disturbance's number is drawn: a distribution turns a uniform number in [0, 1) into a value."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.effects.entries import is_number
from swamp_rl.errors import UserError

Array = NDArray[np.float64]
KINDS = ("uniform", "log_uniform", "choice")


@dataclass(frozen=True)
class Distribution:
    """A number, or one drawn.

    kind `number`: numbers holds it alone; `uniform`, `log_uniform`: the two ends; `choice`: the options.
    """

    kind: str
    numbers: tuple[float, ...]

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


def parse_distribution(given: Any, where: str) -> Distribution:
    """A number, {uniform: [a, b]}, {log_uniform: [a, b]} or {choice: [...]}; UserError otherwise."""
    if is_number(given):
        return Distribution("number", (float(given),))
    if not isinstance(given, Mapping) or len(given) != 1 or next(iter(given)) not in KINDS:
        raise UserError(
            f"{where}: must be a number, {{uniform: [a, b]}}, {{log_uniform: [a, b]}} or "
            f"{{choice: [a, ...]}}, not {given!r}"
        )
    ((kind, numbers),) = given.items()
    if not isinstance(numbers, list | tuple) or not numbers or not all(map(is_number, numbers)):
        raise UserError(f"{where}: {kind} must be a list of numbers, not {numbers!r}")
    if kind != "choice" and (len(numbers) != 2 or not numbers[0] <= numbers[1]):
        raise UserError(f"{where}: {kind} must be [low, high] with low at most high, not {numbers!r}")
    if kind == "log_uniform" and numbers[0] <= 0:
        raise UserError(f"{where}: log_uniform must begin above 0, not at {numbers[0]!r}")
    return Distribution(str(kind), tuple(map(float, numbers)))

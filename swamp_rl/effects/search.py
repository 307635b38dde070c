"""How a diagnosis searches for an effect: sizes and bounds of its numbers, in quantities of the boat."""

from dataclasses import dataclass
from typing import Literal

Quantity = Literal[
    "one",
    "length",
    "breadth",
    "mass",
    "speed",
    "thrust",
    "time",
    "rate",
    "acceleration",
    "damping",
    "yaw_damping",
    "asymmetry",
    "run",
    "time_per_run",
]


@dataclass(frozen=True)
class Reference:
    """A boat's length L [m], breadth [m], mass [kg], top speed U [m/s] and thrust T [N] of all thrusters, the
    duration of the longest run [s], and quantities made of them.
    """

    length: float
    breadth: float
    mass: float
    speed: float
    thrust: float
    run: float = 60.0

    one = 1.0

    @property
    def time(self) -> float:
        """L / U [s]."""
        return self.length / self.speed

    @property
    def rate(self) -> float:
        """U / L [1/s]."""
        return self.speed / self.length

    @property
    def acceleration(self) -> float:
        """U² / L [m/s2]."""
        return self.speed**2 / self.length

    @property
    def damping(self) -> float:
        """T / U [N s/m]."""
        return self.thrust / self.speed

    @property
    def yaw_damping(self) -> float:
        """T L² / U [N m s/rad]."""
        return self.thrust * self.length**2 / self.speed

    @property
    def asymmetry(self) -> float:
        """T L / U² [N m s2/m2]."""
        return self.thrust * self.length / self.speed**2

    @property
    def time_per_run(self) -> float:
        """L / U over the duration [1]."""
        return self.time / self.run


@dataclass(frozen=True)
class Search:
    """How a fit moves one number, in multiples of the reference quantity `of`.

    scale: a typical size; low, high: bounds; starts: where fits begin, none: at the boat file's own number;
    step: of the finite difference, None: 1e-6 scales; prior: standard deviation of a Gaussian prior about the
    neutral value, for numbers that no boat file has exactly, or the numbers of the boat file whose `sd` it is
    made of: that of the first, and its product with the relative ones of the others.
    """

    scale: float
    low: float
    high: float
    starts: tuple[float, ...] = ()
    of: Quantity = "one"
    step: float | None = None
    prior: float | tuple[str, ...] | None = None

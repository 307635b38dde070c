"""What a manoeuvre is: a pure function of what is measured and of its own phase."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

from swamp_rl.constants import GRAVITY
from swamp_rl.guidance.loop import Seen

Kind = Literal["turning-circle", "zig-zag", "spiral", "reverse-spiral", "pull-out", "stopping", "straight"]
Pattern = Literal["opposed", "bow", "parallel"]
APPROACH, EXECUTE, DONE, GAVE_UP = "approach", "execute", "done", "gave up"
PATIENCE = 1500.0  # times √(L/g): how long a phase may last that ends on what the boat does


@dataclass(frozen=True)
class Trial:
    """What is asked for, angles in rad.

    angle: of the steering, positive first to starboard; heading: where a zig-zag reverses; throttle: share
    of full; duration [s]: of a pull-out or of the measured part of a straight run; start_speed [m/s]: what
    the approach is to reach, where that is asked for.
    """

    kind: Kind
    throttle: float
    angle: float = 0.0
    heading: float = 0.0
    pattern: Pattern = "opposed"
    turns: int = 6
    executes: int = 6
    duration: float = 30.0
    astern: bool = False
    astern_throttle: float = 1.0
    start_speed: float | None = None


class Order(NamedTuple):
    """Steering angle [rad], positive turning the bow to starboard, and throttle as a share of full [1]."""

    angle: float
    throttle: float
    astern: bool = False


class Phase(NamedTuple):
    """Where a manoeuvre stands: `name` and `number` (of the execute, the turn, the step) since `began` [s].

    heading [rad]: when the manoeuvre began; memory: what the controller itself keeps; notes: what went not
    as asked for, to be reported with the results.
    """

    name: str
    began: float
    heading: float = 0.0
    number: int = 0
    memory: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()

    def then(self, name: str, time: float, number: int = 0, memory: tuple[float, ...] = ()) -> "Phase":
        """The phase that follows this one at `time`."""
        return self._replace(name=name, began=time, number=number, memory=memory)

    def noted_also(self, what: str, item: str) -> "Phase":
        """The same phase with `what: item` to tell, or with the item added where `what` was reported last."""
        if self.notes and self.notes[-1].startswith(f"{what}: "):
            return self._replace(notes=(*self.notes[:-1], f"{self.notes[-1]}, {item}"))
        return self.noted(f"{what}: {item}")

    def noted(self, note: str) -> "Phase":
        """The same phase with one thing more to tell."""
        return self._replace(notes=(*self.notes, note))


Controller = Callable[[Seen, Phase], tuple[Order, Phase]]


def patience(length: float) -> float:
    """Seconds that a phase of a boat of that length [m] may take: by Froude's law of time."""
    return PATIENCE * math.sqrt(length / GRAVITY)


def gave_up(phase: Phase, time: float, note: str) -> Phase:
    """The end of a manoeuvre that could not go on."""
    return phase.noted(note).then(GAVE_UP, time)

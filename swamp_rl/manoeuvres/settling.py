"""Whether something measured has become steady: it stays near its own slow average for a while."""

import math
from typing import NamedTuple


class Settling(NamedTuple):
    """time [s] and slow average after the last look, and since when [s] the value has stayed near it."""

    time: float
    average: float
    since: float


def started(time: float, value: float) -> Settling:
    """The first look."""
    return Settling(time, value, time)


def watched(before: Settling, time: float, value: float, time_constant: float, tolerance: float) -> Settling:
    """The next look: near is within `tolerance` of the average over about `time_constant` [s]."""
    keep = math.exp(-(time - before.time) / time_constant)
    average = keep * before.average + (1.0 - keep) * value
    near = abs(value - average) <= tolerance
    return Settling(time, average, before.since if near else time)

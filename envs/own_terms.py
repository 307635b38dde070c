"""Terms of the user's own: functions `module:function` of a batch, for the observation or the reward.

    def near_buoy(batch):
        buoys = np.array([(buoy.north, buoy.east) for buoy in batch.course.buoys])
        away = np.linalg.norm(batch.pose[:, None, :2] - buoys, axis=-1).min(axis=-1)
        return np.maximum(2.0 - away, 0.0)

    near_buoy.bounds = (0.0, 2.0)

A term takes a `Batch` of n boats and returns (n,) finite numbers, row i from row i alone. `bounds` are
those of its observation; without them there are none.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.course import Course
from swamp_rl.errors import UserError
from swamp_rl.own_code import is_code, own_code

Array = NDArray[Any]


@dataclass(frozen=True)
class Batch:
    """n boats after a step, or at the start of an episode; the arrays are copies."""

    boat: Boat
    "As `swamp_rl.load_boat` gives it."
    course: Course
    "As `swamp_rl.course.load_course` gives it, with the limits of the episode."
    step: float
    "Time of a step [s]."
    time: Array
    "(n,) since the start of the episode [s]"
    pose: Array
    "(n, 3) true north, east [m] and heading [rad, not wrapped]"
    sensed_pose: Array
    "(n, 3) as `pose`, as the sensors report it"
    velocity: Array
    "(n, 3) surge, sway [m/s over ground] and yaw rate [rad/s]"
    action: Array
    "(n, 2) throttle in [0, 1] and angle in [-1, 1] of the step; 0 at the start"
    last_action: Array
    "(n, 2) as `action`, of the step before"
    commands: Array
    "(n, 2K) asked of the K thrusters: azimuths [rad], then throttles [1]"
    applied: Array
    "(n, 2K) what they did"
    wind: Array
    "(n, 2) true velocity of the air over ground, north and east [m/s]"
    current: Array
    "(n, 2) true velocity of the current over ground, north and east [m/s]"
    gates_passed: Array
    "(n,) so far"
    gates_now: Array
    "(n,) passed in this step"
    way_made: Array
    "(n,) decrease of the distance to go in this step [m]"
    outcome: Array
    "(n,) `running`, `success`, `buoy`, `aground`, `out_of_bounds`, `timeout` or `diverged`"


@dataclass(frozen=True)
class OwnTerm:
    """A term of the user's own; use: `observation` or `reward`."""

    use: str
    name: str
    function: Callable[[Batch], Any]
    low: float
    high: float

    def of(self, batch: Batch) -> NDArray[np.float64]:
        """(n,) what the function gives; UserError where it fails or gives something else than that."""
        what, n = f"{self.use}: {self.name}", len(batch.time)
        try:
            given = np.asarray(self.function(batch))
        except Exception as error:
            message = " ".join(f"{type(error).__name__}: {error}".split())
            raise UserError(f"{what}: failed ({message}); mend the function") from error
        if given.shape != (n,) or given.dtype.kind not in "fiub":
            raise UserError(
                f"{what}: gave the shape {given.shape} of {given.dtype}, ({n},) of numbers is needed"
            )
        values = given.astype(np.float64)
        if not np.isfinite(values).all():
            raise UserError(f"{what}: gave {values[~np.isfinite(values)][0]} for a boat; give finite numbers")
        if n and not (self.low <= values.min() and values.max() <= self.high):
            raise UserError(
                f"{what}: gave {values.min():g} to {values.max():g}, outside of its bounds "
                f"{self.low:g} to {self.high:g}"
            )
        return values


def refuse_function(use: str, given: Any) -> None:
    """UserError for a function itself: a term is given by its name, so that results can tell which it was."""
    if callable(given):
        name = f"{getattr(given, '__module__', '')}:{getattr(given, '__qualname__', '')}"
        text = (
            repr(name) if is_code(name) else "'module:function' of one made by def, '__main__:function' here"
        )
        raise UserError(f"{use}: a function is given by its name as text, {text}")


def own_term(use: str, name: str) -> OwnTerm:
    """The term that the user named as `module:function`, which is imported; UserError where there is none."""
    try:
        function = own_code(name)
    except UserError as error:
        raise UserError(f"{use}: {error}") from error
    if not callable(function) or isinstance(function, type):
        raise UserError(f"{use}: {name}: is not a function; name one that takes a batch of boats")
    low, high = _bounds(f"{use}: {name}", getattr(function, "bounds", None))
    return OwnTerm(use, name, function, *((low, high) if use == "observation" else (-math.inf, math.inf)))


def _bounds(what: str, given: Any) -> tuple[float, float]:
    if given is None:
        return -math.inf, math.inf
    try:
        low, high = (float(end) for end in given)
    except (TypeError, ValueError) as error:
        raise UserError(f"{what}.bounds: must be a pair of numbers, not {given!r}") from error
    if not low < high:
        raise UserError(f"{what}.bounds: the first must be below the second, not {given!r}")
    return low, high

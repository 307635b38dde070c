"""Limits that a designed trial keeps: its duration, the area that it stays in, speed and throttle."""

import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.options import DEFAULT, options
from swamp_rl.errors import UserError

Array = NDArray[np.float64]

NUMBER = r"(\d+(?:\.\d+)?)"


@dataclass(frozen=True)
class TrialLimits:
    """seconds: duration [s]; north, east: sides of the area [m]; speed: greatest over ground [m/s]; throttle:
    greatest share of full [1].
    """

    seconds: float
    north: float
    east: float
    speed: float = math.inf
    throttle: float = 1.0

    def margin(self, length: float) -> float:
        """Distance [m] that every predicted track keeps from the edge; length: of the boat [m]."""
        lengths, share = options().area_margin_lengths, options().area_margin_side
        return max(lengths * length, share * min(self.north, self.east))


UNLIMITED = TrialLimits(math.inf, math.inf, math.inf)


def trial_limits(
    area: str,
    boat: Boat,
    seconds: float = DEFAULT.trial_seconds,
    speed: float | None = None,
    throttle: float = 1.0,
) -> TrialLimits:
    """The limits from an area as `40x30` or `40 x 30`, metres to the north and to the east.

    UserError for text that is no area, one that the boat cannot move in, and a number out of range.
    """
    found = re.fullmatch(rf"{NUMBER} ?[xX×] ?{NUMBER}", area.strip(), re.ASCII)
    if found is None:
        raise UserError(f"--next {area}: no area; give metres north and east as 40x40, without a unit")
    north, east = float(found[1]), float(found[2])
    least = (2.0 * options().area_margin_lengths + options().least_area) * boat.length
    if not least <= min(north, east) <= max(north, east) <= 100_000:
        raise UserError(
            f"--next {area}: boat {boat.name} needs {least:.3g} m each way, four lengths, and at most "
            "100000 m; give another area"
        )
    shortest, longest = options().trial_durations
    if not shortest <= seconds <= longest:
        raise UserError(f"--seconds {seconds:g}: a trial lasts {shortest:g} to {longest:g} s")
    if speed is not None and not 0.0 < speed < math.inf:
        raise UserError(f"--top-speed {speed:g}: give a speed above 0 m/s")
    if not 0.0 < throttle <= 1.0:
        raise UserError(f"--throttle {throttle:g}: give a share of full throttle above 0 and up to 1")
    return TrialLimits(seconds, north, east, math.inf if speed is None else speed, throttle)


def rows_within(limits: TrialLimits, tracks: Array, length: float) -> NDArray[np.int64]:
    """(W,) rows until a trial exceeds a limit under any of H hypotheses.

    tracks: (H, W, T, 6) true motion; length: of the boat [m]. The trial may begin anywhere in the area, so
    that what counts is the extent of all tracks together.
    """
    north, east, surge, sway = (tracks[..., column] for column in (0, 1, 3, 4))
    margin = 0.0 if limits == UNLIMITED else limits.margin(length)  # infinity less infinity is no number
    room = [side - 2.0 * margin for side in (limits.north, limits.east)]
    inside: NDArray[np.bool_] = np.asarray(np.isfinite(tracks).all(axis=(0, 3)))
    inside &= (np.hypot(surge, sway) <= limits.speed).all(axis=0)
    with np.errstate(invalid="ignore"):
        for place, side in zip((north, east), room, strict=True):
            highest = np.maximum.accumulate(place.max(axis=0), axis=1)
            lowest = np.minimum.accumulate(place.min(axis=0), axis=1)
            inside &= highest - lowest <= side
    return np.where(inside.all(axis=1), inside.shape[1], np.argmin(inside, axis=1))


def start_in(limits: TrialLimits, tracks: Array) -> Array:
    """(2,) north and east [m] of the start in the area, so that the tracks (H, T, 6) are in its middle."""
    places = tracks[..., :2].reshape(-1, 2)
    middle = 0.5 * (places.max(axis=0) + places.min(axis=0))
    return np.asarray(np.array([limits.north, limits.east]) / 2.0 - middle + tracks[0, 0, :2])


def shortest_trial() -> float:
    """Seconds of a trial that a diagnosis takes as a run."""
    return options().shortest_run + options().trial_beyond

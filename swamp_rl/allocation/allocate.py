"""From a wanted force and moment to azimuths and throttles, with limits on thrust, azimuth and its rate."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation.jets import Jets
from swamp_rl.allocation.problem import Solution, Wish, solve_in
from swamp_rl.allocation.sectors import Sector, sectors_of
from swamp_rl.angles import wrapped_below
from swamp_rl.errors import UserError

Array = NDArray[np.float64]

MOST_CHOICES = 1024  # combinations of sectors tried at most
MET = 1e-5  # N, and N m over the farthest jet's distance, within which a force counts as achieved
IDLE = 1e-6  # share of a jet's greatest thrust below which it rests
AT_THE_END = 1e-5  # rad beyond the azimuth's last end that are the solver's rounding
PAST_THE_END = 0.5  # rad beyond the azimuth's last end that are not worth turning all the way round
WISH = Wish()


@dataclass(frozen=True)
class Allocation:
    """What to command, and what comes of it once the jets point there.

    azimuth: (K,) [rad]; throttle: (K,) [1]; forces: (K, 2) [N]; wanted, achieved: (3,) surge, sway force [N],
    yaw moment [N m]; attainable: whether the wanted force can be had at once, within the azimuths' reach.
    """

    azimuth: Array
    throttle: Array
    forces: Array
    wanted: Array
    achieved: Array
    attainable: bool

    @property
    def commands(self) -> Array:
        """(2K,) azimuths then throttles, as the simulator takes them."""
        return np.concatenate([self.azimuth, self.throttle])


def allocate(
    jets: Jets,
    wanted: Array,
    azimuth: Array | None = None,
    step: float = math.inf,
    wish: Wish = WISH,
    before: Array | None = None,
) -> Allocation:
    """The cheapest commands that give `wanted` (3,): surge, sway force [N] and yaw moment [N m].

    azimuth: (K,) where the jets point now [rad], straight ahead if not given; step: time [s] they have to
    turn (5.42); before: (K, 2) forces [N] that a penalty on change counts from. Where the wanted force is out
    of reach, the nearest that can be had. A jet that cannot yet push where it should turns there without
    thrust; it turns through forbidden sectors in the same way.
    """
    wanted = np.asarray(wanted, dtype=float)
    now = np.zeros(len(jets.names)) if azimuth is None else np.asarray(azimuth, dtype=float)
    before = np.zeros((len(now), 2)) if before is None else before
    free = best(jets, [sectors_of(jets, k, now[k], math.inf) for k in range(len(now))], wanted, wish, before)
    reach = jets.azimuth_rate * step
    goal = goals(jets, free.forces, now, PAST_THE_END if math.isfinite(step) else AT_THE_END)
    found = free
    # by the turn to be made in truth: a goal that stops at the end of the range is nearer than that
    if np.any(np.abs(goals(jets, free.forces, now) - now) > reach):
        limited = [
            [] if abs(goal[k] - now[k]) > math.pi + PAST_THE_END else sectors_of(jets, k, now[k], reach[k])
            for k in range(len(now))
        ]
        found = best(jets, limited, wanted, wish, before)
    return settled(jets, found, goal, now, reach, wanted)


def best(jets: Jets, sectors: list[list[Sector]], wanted: Array, wish: Wish, before: Array) -> Solution:
    """Over every choice of one sector for each jet: the cheapest that achieves `wanted`, else the nearest."""
    usable = [own for own in sectors if own]
    choices = math.prod(len(own) for own in usable)
    if choices > MOST_CHOICES:
        raise UserError(
            f"thrust allocation: {choices} combinations of azimuth sectors; forbid fewer sectors, or ask for "
            "no least thrust"
        )
    if not usable:
        return Solution(np.zeros((len(jets.names), 2)), 0.0, wanted)
    combined = list(itertools.product(*usable))
    exact = [solve_in(jets, chosen, wanted, wish, before, nearest=False) for chosen in combined]
    good = [found for found in exact if found is not None and distance(jets, found.shortfall) <= MET]
    if good:
        return min(good, key=lambda found: found.cost)
    near = [solve_in(jets, chosen, wanted, wish, before, nearest=True) for chosen in combined]
    answers = [found for found in near if found is not None]
    return min(
        answers, key=lambda found: (round(distance(jets, found.shortfall, wish.moment), 6), found.cost)
    )


def distance(jets: Jets, shortfall: Array, moment: float = 1.0) -> float:
    """Size [N] of a force and moment (3,), the latter counted `moment` times over the farthest jet's arm."""
    return float(np.linalg.norm(shortfall / np.array([1.0, 1.0, jets.lever / moment])))


def goals(jets: Jets, forces: Array, now: Array, past_the_end: float = AT_THE_END) -> Array:
    """(K,) azimuths [rad] within each jet's range that give forces (K, 2) their directions.

    The one nearest to `now`, jets that rest and those that failed staying where they are. A jet that
    reverses pushes astern where that needs less turning. A direction up to `past_the_end` [rad] beyond the
    end of the range is answered by that end.
    """
    found = now.copy()
    for k in range(len(now)):
        thrust = math.hypot(*forces[k])
        if not jets.works[k] or thrust <= IDLE * jets.thrust_max[k]:
            continue
        ahead = math.atan2(forces[k, 1], forces[k, 0]) - jets.offset[k]
        ways = [ahead]
        if thrust <= jets.astern_max[k]:
            ways.append(ahead + math.pi)
        reached = (_within(jets, k, way, now[k], past_the_end) for way in ways)
        found[k] = min(reached, key=lambda goal: abs(goal - now[k]))
    return found


def _within(jets: Jets, k: int, azimuth: float, now: float, past_the_end: float) -> float:
    """The nearest azimuth to `now` equal to `azimuth` up to whole turns, inside the range of jet k."""
    low, high = float(jets.azimuth_min[k]), float(jets.azimuth_max[k])
    nearest = now + wrapped_below(azimuth - now)
    clipped = min(max(nearest, low), high)
    if abs(clipped - nearest) <= past_the_end:
        return clipped
    turns = [nearest + turn * math.tau for turn in (-2, -1, 1, 2) if low <= nearest + turn * math.tau <= high]
    return min(turns, key=lambda way: abs(way - now)) if turns else clipped


def settled(jets: Jets, found: Solution, goal: Array, now: Array, reach: Array, wanted: Array) -> Allocation:
    """Commands for the forces found: a resting jet turns towards its goal, the others push."""
    towards = goals(jets, found.forces, now)
    thrust = np.hypot(found.forces[:, 0], found.forces[:, 1])
    rests = thrust <= IDLE * jets.thrust_max
    azimuth = np.where(rests, now + np.clip(goal - now, -reach, reach), towards)
    forces = np.where(rests[:, None], 0.0, found.forces)
    direction = azimuth + jets.offset
    along = forces[:, 0] * np.cos(direction) + forces[:, 1] * np.sin(direction)
    achieved = jets.geometry @ forces.ravel()
    met = distance(jets, wanted - achieved) <= MET
    return Allocation(azimuth, jets.throttles(along), forces, wanted, achieved, met)

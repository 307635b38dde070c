"""Thrust allocation as a convex program over the extended thrust vector (thesis 5.38 to 5.48), by Clarabel.

Each jet is held to one convex sector: a cone of the second order for its greatest thrust, straight limits for
the sector's edges and, inside it, for its least thrust. All angles have gone into the forces (5.37).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation.jets import Jets
from swamp_rl.allocation.sectors import Sector

Array = NDArray[np.float64]
Cost = Literal["effort", "thrust", "power"]

GUIDE = 1e-4  # weight of the squares beside a cost that is not strictly convex: a single answer, no jumps
FARTHEST = 100.0  # times the thrust of all jets, from where the nearest point has turned to its limit
SLIGHT = 1e-5  # weight of the cost where the wanted force is out of reach and only nearness counts


@dataclass(frozen=True)
class Wish:
    """What to minimise: `effort` (5.48, squares), `thrust` (sum) or `power` (of jets: thrust to the 3/2).

    change: weight [1] on the square of each force's change, relative to the jet's greatest thrust.
    moment: where not all can be had, how many times a missing moment, over the farthest jet's distance,
    counts against a missing force.
    """

    cost: Cost = "effort"
    change: float = 0.0
    moment: float = 1.0


@dataclass(frozen=True)
class Solution:
    """forces: (K, 2) [N] along body x and y; cost: as minimised; shortfall: (3,) wanted less achieved."""

    forces: Array
    cost: float
    shortfall: Array


@lru_cache(maxsize=2)
def solver_settings(scaled: bool) -> Any:
    """Clarabel's settings: silent, and exact enough for a force to be met to a micronewton.

    scaled: whether it scales rows and columns first.
    """
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-9
    settings.max_threads = 1
    settings.equilibrate_enable = scaled
    return settings


def solve_in(
    jets: Jets, chosen: Sequence[Sector], wanted: Array, wish: Wish, before: Array, nearest: bool
) -> Solution | None:
    """The cheapest forces of the jets in their chosen sectors that give `wanted` (3,), or None if none do.

    before: (K, 2) forces [N] that a change is counted from. nearest: come as near to `wanted` as the jets
    can, which always has an answer for a finite `wanted`.
    """
    program = Program(jets, chosen)
    if nearest:
        program.come_near(within_sight(jets, wanted), wish.moment)
    else:
        program.achieve(wanted)
    program.minimise(wish, before, SLIGHT if nearest else 1.0)
    x = program.solved()
    if x is None and nearest:  # the squares of many newtons pass for a limit that cannot be kept
        x = program.solved(1.0 / float(jets.thrust_max.sum()) ** 2)
    if x is None:
        return None
    forces = np.zeros((len(jets.names), 2))
    for i, sector in enumerate(chosen):
        forces[sector.k] = x[2 * i : 2 * i + 2]
    return Solution(forces, program.cost_of(x), wanted - jets.geometry @ forces.ravel())


def within_sight(jets: Jets, wanted: Array) -> Array:
    """`wanted` (3,), shortened to FARTHEST times the thrust of all jets, which the solver can measure from.

    Beyond that distance the nearest attainable point hardly moves along a ray, and the solver's squares
    outgrow its precision.
    """
    size = float(np.linalg.norm(wanted / np.array([1.0, 1.0, jets.lever])))
    farthest = FARTHEST * float(jets.thrust_max.sum())
    return wanted * (farthest / size) if size > farthest else wanted


def compressed(entries: Mapping[tuple[int, int], float], rows: int, columns: int) -> Any:
    """The sparse matrix (rows, columns) of `entries` by (column, row), in compressed columns.

    Made as it is stored: by way of coordinates, scipy's checks took as long as the solver.
    """
    from scipy.sparse import csc_matrix

    places = sorted(entries)
    values = np.array([entries[place] for place in places], dtype=np.float64)
    inside = np.array([row for _, row in places], dtype=np.int32)
    starts = np.zeros(columns + 1, dtype=np.int32)
    filled = np.array([column for column, _ in places], dtype=np.intp)  # there may be none
    np.cumsum(np.bincount(filled, minlength=columns), out=starts[1:])
    return csc_matrix((values, inside, starts), shape=(rows, columns))


class Program:
    """One conic program: the forces of the chosen jets, then for each its thrust, and what costs add.

    Rows are collected as (coefficients by column, right side), b - A x in a cone, one cone after another.
    """

    def __init__(self, jets: Jets, chosen: Sequence[Sector]) -> None:
        self.jets = jets
        self.chosen = chosen
        self.columns = 2 * len(chosen)
        self.rows: list[tuple[dict[int, float], float]] = []
        self.cones: list[Any] = []
        self.squares: dict[int, float] = {}
        self.linear: dict[int, float] = {}
        for i, sector in enumerate(chosen):
            self._hold(i, sector)

    def _add(self, cone: Any, *rows: tuple[dict[int, float], float]) -> None:
        self.rows += rows
        self.cones.append(cone)

    def _hold(self, i: int, sector: Sector) -> None:
        """Limits of jet i: |F| <= most, within the sector's edges, and the least thrust along its middle."""
        import clarabel

        x, y = 2 * i, 2 * i + 1
        self._add(clarabel.SecondOrderConeT(3), ({}, sector.most), ({x: -1.0}, 0.0), ({y: -1.0}, 0.0))
        if sector.whole:
            return
        offset = float(self.jets.offset[sector.k])
        a, b = sector.direction(sector.low, offset), sector.direction(sector.high, offset)
        middle = 0.5 * (a + b)
        # The least thrust, met at the sector's middle line, is met everywhere in it.
        self._add(
            clarabel.NonnegativeConeT(3),
            ({x: math.sin(a), y: -math.cos(a)}, 0.0),
            ({x: -math.sin(b), y: math.cos(b)}, 0.0),
            ({x: -math.cos(middle), y: -math.sin(middle)}, -sector.least),
        )

    def _geometry_row(self, axis: int) -> dict[int, float]:
        B = self.jets.geometry
        return {
            2 * i + j: B[axis, 2 * sector.k + j] for i, sector in enumerate(self.chosen) for j in range(2)
        }

    def achieve(self, wanted: Array) -> None:
        """B chi = wanted (5.39)."""
        import clarabel

        self._add(
            clarabel.ZeroConeT(3), *((self._geometry_row(axis), float(wanted[axis])) for axis in range(3))
        )

    def come_near(self, wanted: Array, moment: float) -> None:
        """Minimise the squared distance from B chi to wanted, by the slack as three more columns."""
        import clarabel

        slack = self.columns
        self.columns += 3
        rows = []
        for axis in range(3):
            scale = self.jets.lever / moment if axis == 2 else 1.0
            rows.append((self._geometry_row(axis) | {slack + axis: scale}, float(wanted[axis])))
            self.squares[slack + axis] = 2.0
        self._add(clarabel.ZeroConeT(3), *rows)

    def scale_up(self, direction: Array, most: float) -> None:
        """Maximise s up to `most` in B chi = s direction; s [1] is the last column."""
        import clarabel

        scale = self.columns
        self.columns += 1
        rows = [(self._geometry_row(axis) | {scale: -float(direction[axis])}, 0.0) for axis in range(3)]
        self._add(clarabel.ZeroConeT(3), *rows)
        self._add(clarabel.NonnegativeConeT(2), ({scale: -1.0}, 0.0), ({scale: 1.0}, most))
        self.linear[scale] = -1.0

    def minimise(self, wish: Wish, before: Array, weight: float) -> None:
        """Add the cost and the penalty on change, with `weight`."""
        import clarabel

        for i, sector in enumerate(self.chosen):
            most = float(self.jets.thrust_max[sector.k])
            squares = (1.0 if wish.cost == "effort" else GUIDE) + wish.change
            for j in range(2):
                column = 2 * i + j
                self.squares[column] = weight * 2.0 * squares / most**2
                pull = wish.change * before[sector.k, j]
                self.linear[column] = -weight * 2.0 * pull / most**2
            if wish.cost == "effort":
                continue
            thrust = self.columns
            self.columns += 1
            self._add(
                clarabel.SecondOrderConeT(3),
                ({thrust: -1.0}, 0.0),
                ({2 * i: -1.0}, 0.0),
                ({2 * i + 1: -1.0}, 0.0),
            )
            if wish.cost == "thrust":
                self.linear[thrust] = weight / most
                continue
            power = self.columns
            self.columns += 1
            # power^(2/3) >= thrust, both relative to full thrust's
            self._add(
                clarabel.PowerConeT(2.0 / 3.0), ({power: -1.0}, 0.0), ({}, 1.0), ({thrust: -1.0 / most}, 0.0)
            )
            self.linear[power] = weight

    def solved(self, unit: float = 1.0) -> Array | None:
        """The best x, or None where nothing satisfies the limits; what is minimised counts in this unit."""
        import clarabel

        n = self.columns
        q = np.zeros(n)
        q[list(self.linear)] = list(self.linear.values())
        P = compressed({(place, place): value for place, value in self.squares.items()}, n, n)
        A = compressed(
            {(column, r): value for r, (row, _) in enumerate(self.rows) for column, value in row.items()},
            len(self.rows),
            n,
        )
        b = np.array([right for _, right in self.rows])
        good = (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)
        stuck = (clarabel.SolverStatus.InsufficientProgress, clarabel.SolverStatus.NumericalError)
        for scaled in (True, False):  # the scaling itself stops a few problems short of their answer
            answer = clarabel.DefaultSolver(
                unit * P, unit * q, A, b, self.cones, solver_settings(scaled)
            ).solve()
            if answer.status not in stuck:
                break
        return np.array(answer.x) if answer.status in good else None

    def cost_of(self, x: Array) -> float:
        """What was minimised, less a constant."""
        squares = sum(0.5 * value * x[column] ** 2 for column, value in self.squares.items())
        return float(squares + sum(value * x[column] for column, value in self.linear.items()))

"""What a demonstration shows: runs by who drove them, on one clock, and the course around them."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from swamp_rl.constants import SWAMP_LENGTH
from swamp_rl.course import Course, buoy_table
from swamp_rl.demo.colours import PALETTE, PEOPLE, Colour, driver_colours
from swamp_rl.demo.conditions import Conditions, conditions
from swamp_rl.errors import UserError
from swamp_rl.runs import Run

Align = Literal["gate", "start"]
GATE_COLOURS: dict[str, Colour] = {"green": (44, 160, 44), "red": (214, 39, 40)}
OTHER_GATE: Colour = (255, 187, 60)
FEW = 8
"""Up to so many runs each boat bears its name, and its wind and current."""


@dataclass(frozen=True)
class Shown:
    """One run: `group` is who drove it, `start` the time [s] of its first row on the common clock."""

    name: str
    group: str
    run: Run
    start: float = 0.0

    @property
    def end(self) -> float:
        """Time of its last row on the common clock, s."""
        return self.start + self.run.duration


@dataclass(frozen=True)
class Fleet:
    """Runs drawn in one colour; `path` is their place in a tree of who drives."""

    path: tuple[str, ...]
    colour: Colour
    shown: tuple[Shown, ...]


@dataclass(frozen=True)
class DemoScene:
    """`length`, `breadth`: of the boat drawn [m]; one_boat: whether all drove it.

    Where runs are of no course, there is none.
    """

    title: str
    shown: tuple[Shown, ...]
    course: Course | None
    length: float
    breadth: float
    aligned: str = "all runs start together"
    one_boat: bool = True

    @property
    def groups(self) -> list[str]:
        """Who drives, each once, people first."""
        found = dict.fromkeys(item.group for item in self.shown)
        return sorted(found, key=lambda group: group.split(" ")[0] not in PEOPLE)

    @property
    def conditions(self) -> Conditions:
        """Whether all met one weather from one start."""
        return conditions([item.run for item in self.shown], self.one_boat)

    @property
    def about(self) -> str:
        """Who is shown, in what weather, and what they do at one time: a line."""
        who = ", ".join(f"{sum(one.group == group for one in self.shown)} {group}" for group in self.groups)
        return "; ".join(filter(None, [who, self.conditions.sentence, self.aligned]))

    @property
    def few(self) -> bool:
        """Whether each boat can bear its name."""
        return len(self.shown) <= FEW

    @property
    def end(self) -> float:
        """When the last run ends, s."""
        return max(item.end for item in self.shown)

    @property
    def fleets(self) -> list[Fleet]:
        """By who drives; by run, where one drives all of a few."""
        groups = self.groups
        if len(groups) == 1 and len(self.shown) <= len(PALETTE):
            return [
                Fleet((item.group, item.name), colour, (item,))
                for item, colour in zip(self.shown, PALETTE, strict=False)
            ]
        return [
            Fleet((group,), colour, tuple(item for item in self.shown if item.group == group))
            for group, colour in driver_colours(groups).items()
        ]

    @property
    def scale(self) -> float:
        """Length of the boat over SWAMP's, which the symbols that are drawn in metres are sized for."""
        return self.length / SWAMP_LENGTH

    @property
    def buoys(self) -> NDArray[np.float64]:
        """(2 G, 2) north and east [m]."""
        return np.empty((0, 2)) if self.course is None else buoy_table(self.course)

    def edges(self) -> tuple[float, float, float, float]:
        """South, north, west and east [m] of what is to be seen: every track and buoy, with some room."""
        seen = np.vstack([*(item.run.pose[:, :2] for item in self.shown), self.buoys])
        (south, west), (north, east) = seen.min(axis=0), seen.max(axis=0)
        room = max(1.5 * self.length, 0.05 * max(north - south, east - west))
        return float(south - room), float(north + room), float(west - room), float(east + room)

    def called(self, item: Shown) -> str:
        """A boat's name: who drives it, where that is the only one of theirs; a nickname if given."""
        nickname = (item.run.meta.model_extra or {}).get("nickname")
        alone = sum(other.group == item.group for other in self.shown) == 1
        if alone:
            return f"{item.group} {nickname}" if nickname else item.group
        name = f"{nickname} {item.name}" if nickname else item.name
        return name if len(self.groups) == 1 else f"{item.group} {name}"


def gate_colour(name: str) -> Colour:
    """Of a gate, by its name."""
    return GATE_COLOURS.get(name, OTHER_GATE)


def demo_scene(
    title: str,
    runs: Mapping[str, Iterable[Run]],
    course: Course | None,
    size: tuple[float, float],
    align: Align | None = "start",
    one_boat: bool = True,
) -> DemoScene:
    """`runs` by who drove them, their names unique in each group; `size`: length and breadth [m].

    With align `start` all begin together, which with None those do that met one weather from one start; the
    others, and all with `gate`, pass the course's first gate at the same time on the clock; a run that
    never does is where it was nearest to the gate. The clock starts at 0, with the first run. UserError for a
    run of one row.
    """
    shown = [Shown(run.name, group, run) for group, found in runs.items() for run in found]
    for item in shown:
        if len(item.run.time) < 2:
            raise UserError(f"run {item.name}: has {len(item.run.time)} row(s); two or more can be shown")
    together = DemoScene(title, tuple(shown), course, *size, one_boat=one_boat)
    if align == "start" or course is None or (align is None and together.conditions.same):
        return together
    at_gate = [first_gate_time(item.run, course) for item in shown]
    latest = max(at_gate, default=0.0)
    shown = [replace(item, start=latest - passed) for item, passed in zip(shown, at_gate, strict=True)]
    sentence = f"all are at the gate {course.gates[0].name} at {latest:.1f} s"
    return replace(together, shown=tuple(shown), aligned=sentence)


def first_gate_time(run: Run, course: Course) -> float:
    """Time [s] from a run's first row to its way through the first gate, or to where it came nearest."""
    gate = course.gates[0]
    cos, sin = math.cos(gate.heading), math.sin(gate.heading)
    north, east = run.columns["north"] - gate.centre.north, run.columns["east"] - gate.centre.east
    along, across = north * cos + east * sin, east * cos - north * sin
    share = np.divide(-along[:-1], np.diff(along), out=np.zeros(len(along) - 1), where=np.diff(along) > 0.0)
    inside = np.abs(across[:-1] + share * np.diff(across)) < 0.5 * gate.width
    passes = np.flatnonzero((along[:-1] < 0.0) & (along[1:] >= 0.0) & inside)
    time = run.time - run.time[0]
    if len(passes) == 0:
        return float(time[np.argmin(np.hypot(north, east))])
    i = int(passes[0])
    return float(time[i] + share[i] * (time[i + 1] - time[i]))

"""The end card: what came of each driver's run, in one table that page, film and recording show alike."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from swamp_rl.course.clearance import closest_buoy
from swamp_rl.demo.colours import Colour
from swamp_rl.demo.scene import DemoScene, Fleet, Shown
from swamp_rl.evaluation.metrics import command_change, path_length
from swamp_rl.runs import Run

HEAD = (
    ("driver", ""),
    ("outcome", ""),
    ("time", "s"),
    ("path", "m"),
    ("lever change", "per step"),
    ("closest buoy", "m"),
)
"""Of each column: its name, and its unit."""
CARD = 5.0
"""How long film and recording show it after the last run has ended, s."""
DIGITS = (1, 1, 3, 2)
NONE = "–"
LEVERS = {"joy_thrust", "joy_angle"}


@dataclass(frozen=True)
class Line:
    """One driver: `cells` as `HEAD` has them."""

    colour: Colour
    cells: tuple[str, ...]


def card(scene: DemoScene) -> list[Line]:
    """A line for each run; of more than a few, one for each driver, with the medians of the runs.

    Time from the first row to the last; path, and mean change of the levers in a step of the run
    (`evaluation.metrics`), which is left out where the runs' steps differ; least clearance to a buoy.
    """
    steps = {round(_step(item.run), 6) for item in scene.shown}
    lines = []
    for fleet in scene.fleets:
        figures = [_figures(item, scene, len(steps) == 1) for item in fleet.shown]
        if scene.few:
            lines += [
                Line(fleet.colour, (scene.called(item), _outcome(item.run), *_texts(one)))
                for item, one in zip(fleet.shown, figures, strict=True)
            ]
        else:
            medians = [_median(column) for column in zip(*figures, strict=True)]
            lines.append(Line(fleet.colour, (fleet.path[-1], _outcomes(fleet), *_texts(medians))))
    return lines


def _figures(item: Shown, scene: DemoScene, one_step: bool) -> tuple[float | None, ...]:
    run, course = item.run, scene.course
    # The last row's levers are never acted on.
    changed = float(command_change(run.joypad[:-1])) if one_step and set(run.columns) >= LEVERS else None
    clear = closest_buoy(run.pose, course, scene.breadth) if course is not None else None
    return run.duration, float(path_length(run.pose)), changed, clear


def _step(run: Run) -> float:
    return float(np.median(np.diff(run.time)))


def _outcome(run: Run) -> str:
    return (run.meta.outcome or NONE).replace("_", " ")


def _outcomes(fleet: Fleet) -> str:
    good = sum(item.run.meta.outcome == "success" for item in fleet.shown)
    return f"{good} of {len(fleet.shown)} success"


def _median(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.median(known)) if known else None


def _texts(values: Sequence[float | None]) -> tuple[str, ...]:
    return tuple(
        NONE if value is None else f"{value:.{digits}f}" for value, digits in zip(values, DIGITS, strict=True)
    )

"""Depth of the water in an episode: drawn from the course's, or as an effect of boat or level has it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat.resistance import TankResistance
from swamp_rl.course import Course
from swamp_rl.effects import Level
from swamp_rl.errors import UserError
from swamp_rl.simulator.ground import deep, in_tested_draughts

EFFECT = "shallow_water"


def depth_draws(course: Course) -> int:
    """How many uniforms in [0, 1) the depth of an episode takes."""
    return course.depth.draws if course.depth else 0


def refuse_depth(boat: Boat, course: Course, level: Level) -> None:
    """UserError where the course's depth does not fit the boat or the level."""
    if course.depth is None:
        return
    least, where = course.depth.least, f"course {course.name}: depth"
    if least <= boat.draught:
        raise UserError(
            f"{where}: {least:g} m is no more than the draught of {boat.draught:.3g} m of boat "
            f"{boat.name}: it lies aground; give more depth"
        )
    if not isinstance(boat.resistance, TankResistance) and least < deep() * boat.draught:
        raise UserError(
            f"{where}: {least:g} m is {least / boat.draught:.3g} draughts, and boat {boat.name}, which no "
            f"tank towed, is known from {deep():g}; give more depth"
        )
    if any(entry.effect.name == EFFECT for entry in level.entries):
        raise UserError(f"{where}: disturbances {level.name} have {EFFECT} too; give one of the two")


def give_depth(
    boats: NDArray[Any], params: NDArray[Any], boat: Boat, course: Course, uniforms: NDArray[np.float64]
) -> None:
    """Write the depth [m] into the records of m boats, and into their params what it does to the resistance.

    uniforms: (m, `depth_draws`). Without a depth of the course it is that of the effect `shallow_water`.
    """
    if course.depth is None:
        draughts = params["depth_over_draught"]
        boats["depth"] = np.where(draughts < deep(), draughts * params["draught"], np.inf)
        return
    least, most = course.depth.uniform
    boats["depth"] = least + (most - least) * (uniforms[:, 0] if course.depth.draws else 0.0)
    params["depth_over_draught"] = in_tested_draughts(boat, boats["depth"])


def as_effects(boat: Boat, depth: float | None) -> list[dict[str, Any]]:
    """What a depth [m] of the course does to a boat's motion, as a list of effects."""
    if depth is None:
        return []
    return [{"effect": EFFECT, "depth_over_draught": float(in_tested_draughts(boat, depth))}]


def without_depth(effects: Any) -> Any:
    """A list of effects without what `as_effects` says; anything else as it is."""
    if not isinstance(effects, Sequence) or isinstance(effects, str):
        return effects
    return [entry for entry in effects if entry.get("effect") != EFFECT]

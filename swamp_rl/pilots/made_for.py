"""The boat and the step that a pilot was made for, against those that it is to drive."""

from pathlib import Path

from swamp_rl import __version__
from swamp_rl.boat import Boat
from swamp_rl.boat.digest import boat_digest
from swamp_rl.boat.likeness import build_of
from swamp_rl.errors import UserError
from swamp_rl.pilots.description import Made

STEP_TOLERANCE = 1e-6
"Relative, of times between decisions."


def made_for(boat: Boat, course: str, step: float) -> Made:
    """What a pilot is stored with that was made for a boat, the course of that name and a step [s]."""
    length, thrusters = build_of(boat)
    return Made(
        package=f"swamp_rl {__version__}",
        boat=boat.name,
        boat_sha256=boat_digest(boat),
        length=length,
        thrusters=dict(thrusters),
        course=course,
        step=step,
    )


def check_made_for(
    where: Path | str, made: Made | None, boat: Boat, step: float, named_by: str = "boat"
) -> str | None:
    """One line where a pilot is to drive another boat of the same thrusters and size; else None.

    where: the pilot's folder or name. made: None where the pilot does not tell; one of an earlier version
    does not tell thrusters and length. named_by: what the user names to have another boat driven. UserError
    for a boat of other thrusters or size, or another step [s].
    """
    if made is None:
        return None
    ours = build_of(boat)
    if made.build is not None and not made.build.serves(ours):
        raise UserError(
            f"{where}: was made for boat {made.boat} ({made.build}), it cannot drive {boat.name} ({ours}); "
            f"name a pilot of {boat.name}, or {named_by} {made.boat}"
        )
    if abs(made.step / step - 1.0) > STEP_TOLERANCE:
        raise UserError(
            f"{where}: decides every {made.step:g} s, it cannot drive at a step of {step:g} s; name a pilot "
            "of that step"
        )
    other = other_boat(made, boat)
    return None if other is None else f"{where}: was made for {other}, it drives {boat.name}"


def other_boat(made: Made | None, boat: Boat) -> str | None:
    """The boat that a pilot was made for, where it is not `boat` as it is now; else None."""
    if made is None or made.boat_sha256 == boat_digest(boat):
        return None
    return f"boat {made.boat}" if made.boat != boat.name else f"another version of boat {made.boat}"

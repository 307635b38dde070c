"""Learning curves as trainings log them: one JSON line for each point."""

import json
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.files import write_text
from swamp_rl.json_text import parsed_json
from swamp_rl.ordinary import MOST_JSON, contents

Array = NDArray[np.float64]
Curve = tuple[Array, Array]
"""Steps (T,), rising, and a quantity (T,): success in [0, 1], or a loss of at least 0."""
QUANTITIES = ("success", "loss")
"What learners tell of themselves: by trying or in trials how they succeed, by regression their error."

CURVE = "curve.jsonl"
"What it is called beside the pilot."


def write_curve(path: Path, points: Iterable[Mapping[str, float]]) -> None:
    """Points with `step`, one of QUANTITIES and what else was logged, one a line; UserError if it cannot."""
    write_text(path, "".join(f"{json.dumps(dict(point))}\n" for point in points))


def quantity_of(points: Iterable[Mapping[str, float]]) -> str | None:
    """Which of QUANTITIES every point has, the first of them; None where there is none, or no point."""
    keys = [set(point) for point in points]
    return next((one for one in QUANTITIES if keys and all(one in held for held in keys)), None)


def read_curve(path: Path | str, quantity: str = "success") -> Curve:
    """The curve of a file of JSON lines with the keys `step` and `quantity`; other keys are let be.

    UserError with file and line for the first that is malformed, or does not lie behind the one before it.
    """
    points: list[tuple[float, float]] = []
    try:
        lines = contents(path, MOST_JSON).decode("utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"{path}: cannot be read as text ({error}); name a curve's .jsonl file") from error
    for number, line in enumerate(lines, 1):
        try:
            point = parsed_json(line)
            step, value = float(point["step"]), float(point[quantity])
        except (ValueError, KeyError, TypeError) as error:
            raise UserError(f"{path}: line {number}: must hold the numbers step and {quantity}") from error
        most = 1.0 if quantity == "success" else sys.float_info.max
        if not 0.0 <= value <= most:
            within = "within 0 and 1" if quantity == "success" else "finite and at least 0"
            raise UserError(f"{path}: line {number}: {quantity} is {value:g}; it must be {within}")
        if points and not step > points[-1][0]:
            raise UserError(f"{path}: line {number}: step {step:g} does not follow {points[-1][0]:g}")
        points.append((step, value))
    if not points:
        raise UserError(f"{path}: holds no point; log at least one")
    steps, values = np.array(points).T
    return steps, values

"""What the single and the batched environment share at their edges: the joypad, and checks of what they are
given."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError


def joypad_space() -> spaces.Box:
    """Throttle in [0, 1] and angle in [-1, 1], float32."""
    return spaces.Box(np.array([0.0, -1.0], np.float32), np.array([1.0, 1.0], np.float32))


def known_levers(actions: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """`actions` as a new array of `shape`; UserError where they are of another or hold no numbers."""
    try:
        levers = np.array(actions, order="C")  # of one order, so that nothing is compiled twice
    except ValueError:
        levers = np.array(None)
    if levers.shape != shape:
        raise UserError(f"step: the action must have the shape {shape}, not {levers.shape}")
    if levers.dtype.kind not in "fiu":
        raise UserError(f"step: the action must be of numbers, not of {levers.dtype}")
    return levers.astype(np.float64, copy=False)


def known_render_mode(mode: str | None) -> str | None:
    """`mode` if it is one that is there; UserError otherwise."""
    if mode not in (None, "rgb_array"):
        raise UserError(f"render_mode: must be None or 'rgb_array', not {mode!r}")
    return mode


def known_options(options: dict[str, Any] | None, known: Sequence[str]) -> dict[str, Any]:
    """The options of a reset, if all are known; UserError otherwise."""
    if options is None:
        return {}
    if not isinstance(options, dict):
        raise UserError(f"reset: options must be None or a dict, not {clipped(repr(options))}")
    for name in options:
        if name not in known:
            message = f"unknown option {clipped(repr(name))}; known here: {', '.join(known) or 'none'}"
            raise UserError(f"reset: {message}")
    return options

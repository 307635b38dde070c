"""Whether runs shown together began in one place and met one weather, as far as they tell."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from swamp_rl.runs import Run

STATE = ("north", "east", "heading", "surge", "sway", "yaw_rate")
DIGITS = 9
"""To which starts are compared, in SI units."""


@dataclass(frozen=True)
class Conditions:
    """`same`: one start and one weather for all; `sentence`: that in words, empty where unknown."""

    same: bool
    sentence: str


def conditions(runs: Sequence[Run], one_boat: bool = True) -> Conditions:
    """Of runs on one course; one_boat: whether all were of the same boat."""
    if len(runs) == 1:
        return Conditions(True, _label(runs[0], seed=True) if _weather(runs[0]) else "")
    if not one_boat:
        return Conditions(False, "different boats")
    for run in runs:
        if _weather(run) is None or _start(run) is None:
            return Conditions(False, f"different weather: {run.name} does not record its own")
        if (run.meta.model_extra or {}).get("kicked_steps"):
            return Conditions(False, f"different weather: in {run.name} someone moved the stern thrusters")
    if len({_weather(run) for run in runs}) > 1:
        return Conditions(False, "different weather")
    if len({_start(run) for run in runs}) > 1:
        return Conditions(False, f"different starts, same weather: {_label(runs[0], seed=False)}")
    return Conditions(True, f"same start, same weather: {_label(runs[0], seed=True)}")


def _weather(run: Run) -> tuple[str, int] | None:
    """The effects with their numbers and the seed of the gusts; of no effect, the seed does not matter."""
    drawn, gust_seed = run.meta.disturbances, (run.meta.model_extra or {}).get("gust_seed")
    if not isinstance(drawn, list) or not isinstance(gust_seed, int):
        return None
    return json.dumps(drawn, sort_keys=True), gust_seed if drawn else 0


def _start(run: Run) -> tuple[float, ...] | None:
    state: dict[str, Any] = run.meta.initial_state or {}
    return tuple(round(state[name], DIGITS) for name in STATE) if set(STATE) <= set(state) else None


def _label(run: Run, seed: bool) -> str:
    level = (run.meta.model_extra or {}).get("level")
    named = level if isinstance(level, str) and level != "none" else "" if run.meta.disturbances else "calm"
    of_seed = f"seed {run.meta.seed}" if seed and run.meta.seed is not None else ""
    return ", ".join(filter(None, [named, of_seed])) or "as recorded"

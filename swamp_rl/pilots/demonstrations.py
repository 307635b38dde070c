"""Logged runs as demonstrations: observations and the levers that followed."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from swamp_rl.counted import counted
from swamp_rl.errors import UserError
from swamp_rl.pilots.arrays import Array
from swamp_rl.runs import Run

POSE = ("north", "east", "cos_heading", "sin_heading")
MOTION = ("surge", "sway", "yaw_rate")
GATE = ("gate_ahead", "gate_starboard", "gate_cos", "gate_sin")
NEXT_GATE = (*GATE, "gates_passed")
LAST = {"last_throttle": "joy_thrust", "last_angle": "joy_angle"}
"The action of the row before, by the column that holds those of all rows."
LOGGED = (*POSE, *MOTION, *NEXT_GATE, *LAST)
"Observations that every log on a course provides."
PERSON = 0.0
"Value of the column `driver` where a person has the helm, in runs with a pilot on board."


def choose_runs(
    runs: Sequence[Run],
    count: int | None = None,
    outcomes: Sequence[str] = ("success",),
    skill: str | None = None,
) -> list[Run]:
    """Return the first `count` runs (None: all) with one of `outcomes`, of a driver of that skill if given.

    UserError where there are none or fewer than `count`.
    """
    if skill is not None:
        runs = [run for run in runs if (run.meta.model_extra or {}).get("skill") == skill]
    chosen = [run for run in runs if run.meta.outcome in outcomes]
    wanted = " or ".join(outcomes) + ("" if skill is None else f" and the skill {skill}")
    if not chosen:
        raise UserError(
            f"none of {counted(len(runs), 'run')} has the outcome {wanted}; record some, or allow another "
            "outcome"
        )
    if count is not None and len(chosen) < count:
        raise UserError(
            f"{count} runs with the outcome {wanted} are asked for, {len(chosen)} are there; record more, or "
            "ask for fewer"
        )
    return chosen[:count]


def observed(run: Run, senses: Sequence[str]) -> Array:
    """Return the named observations (T, d) of a run; UserError for one that its columns do not provide."""
    derived: dict[str, Callable[[], Array]] = {
        "cos_heading": lambda: np.cos(run.columns["heading"]),
        "sin_heading": lambda: np.sin(run.columns["heading"]),
        **{name: partial(last_action, run, name) for name in LAST},
    }
    logged = [name in run.columns or name not in derived for name in senses]
    columns = [
        run.stacked((n,))[:, 0] if own else derived[n]() for n, own in zip(senses, logged, strict=True)
    ]
    return np.column_stack(columns)


def last_action(run: Run, name: str) -> Array:
    """Return one of LAST (T,): the lever of the row before, 0 at the first."""
    return np.concatenate([[0.0], run.columns[LAST[name]][:-1]])


def refuse_unlogged(senses: Sequence[str], columns: Sequence[str] = ()) -> None:
    """Raise UserError for the first of `senses` that is neither logged nor one of `columns`."""
    for name in senses:
        if name not in LOGGED and name not in columns:
            raise UserError(
                f"the runs have no {name}, which the pilot observes; leave it out, or use runs with a column "
                f"of that name (all have {', '.join(LOGGED)})"
            )


def examples(
    runs: Sequence[Run], senses: Sequence[str], reaction: float = 0.0
) -> tuple[list[Array], list[Array], list[Array]]:
    """Return for each run the observations (T, d), the levers (T, 2) `reaction` [s] later and whether these
    are demonstrations (T,).

    UserError where a run lacks a column or is shorter than the reaction, or no row is a demonstration.
    """
    observations, levers, demonstrated = [], [], []
    for run in runs:
        late = round(reaction * (len(run.time) - 1) / run.duration) if reaction > 0.0 else 0
        rows = len(run.time) - late
        if rows < 1:
            raise UserError(f"{run.name}: lasts {run.duration:g} s, less than the reaction of {reaction:g} s")
        observations.append(observed(run, senses)[:rows])
        levers.append(run.joypad[late:])
        demonstrated.append(is_demonstration(run)[late:])
    if not any(rows.any() for rows in demonstrated):
        raise UserError(
            f"none of {counted(len(runs), 'run')} has a row that a person drove; record some by hand"
        )
    return observations, levers, demonstrated


def is_demonstration(run: Run) -> Array:
    """Return whether each row's levers are a demonstration (T,).

    With a pilot on board only the rows in which a person corrected it are.
    """
    if "driver" not in run.columns:
        return np.ones(len(run.time), dtype=bool)
    return run.columns["driver"] == PERSON

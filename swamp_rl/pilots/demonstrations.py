"""Logged runs as demonstrations: observations and the levers that followed."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from swamp_rl.counted import counted
from swamp_rl.errors import SettingsError, UserError
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
            f"none of {counted(len(runs), 'run')} has the outcome {wanted}; record some, or name others "
            "(outcomes: [success, OTHER] of the pilot)"
        )
    if count is not None and len(chosen) < count:
        raise UserError(
            f"{counted(count, 'run')} with the outcome {wanted} asked for, {len(chosen)} found; record more, "
            "or ask for fewer"
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
    runs: Sequence[Run], senses: Sequence[str], reaction: float = 0.0, washout: int = 0
) -> tuple[list[Array], list[Array], list[Array]]:
    """Return for each run the observations (T, d), the levers (T, 2) `reaction` [s] later and which rows of
    these are learned from (T,).

    UserError where a run lacks a column, and as for `rows_to_learn`.
    """
    learned = rows_to_learn(runs, reaction, washout)
    observations = [observed(run, senses)[: len(rows)] for run, rows in zip(runs, learned, strict=True)]
    levers = [run.joypad[-len(rows) :] for run, rows in zip(runs, learned, strict=True)]
    return observations, levers, learned


def rows_to_learn(runs: Sequence[Run], reaction: float = 0.0, washout: int = 0) -> list[Array]:
    """Return for each run which of its first T rows are learned from (T,): those after the first `washout`
    that have a demonstration `reaction` [s] later, as all T have a row then.

    SettingsError where there is no run, one is shorter than the reaction, or no row is left.
    """
    if not runs:
        raise SettingsError("no runs were given to learn from; give one or more")
    learned = []
    for run in runs:
        late = round(reaction * (len(run.time) - 1) / run.duration) if reaction > 0.0 else 0
        if late >= len(run.time):
            raise SettingsError(
                f"{run.name}: lasts {run.duration:g} s, less than the reaction of {reaction:g} s; lower "
                "reaction, or learn from longer runs"
            )
        learned.append(is_demonstration(run)[late:])
    if not any(rows.any() for rows in learned):
        raise SettingsError(
            f"none of {counted(len(runs), 'run')} has a row that a person drove; record some by hand"
        )
    longest = max(len(rows) for rows in learned)
    learned = [rows & (np.arange(len(rows)) >= washout) for rows in learned]
    if not any(rows.any() for rows in learned):
        raise SettingsError(
            f"washout: {washout} leaves no row to learn from, the longest of {counted(len(runs), 'run')} has "
            f"{longest}; lower washout"
        )
    return learned


def is_demonstration(run: Run) -> Array:
    """Return whether each row's levers are a demonstration (T,).

    With a pilot on board only the rows in which a person corrected it are.
    """
    if "driver" not in run.columns:
        return np.ones(len(run.time), dtype=bool)
    return run.columns["driver"] == PERSON

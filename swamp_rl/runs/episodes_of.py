"""A dataset as learners of other libraries see it: episodes of states and actions with the same columns."""

from collections.abc import Sequence
from dataclasses import dataclass

from swamp_rl.errors import UserError
from swamp_rl.runs.dataset import Dataset

STATES = ("north", "east", "heading", "surge", "sway", "yaw_rate")
LEVERS = ("joy_thrust", "joy_angle")
COMMANDS = ("azimuth_", "throttle_", "rudder_", "propeller_")


@dataclass(frozen=True)
class Split:
    """Names of the columns, the same in all runs: the state, the action (levers, else commands), the rest."""

    state: tuple[str, ...]
    action: tuple[str, ...]
    others: tuple[str, ...]


def split_columns(dataset: Dataset) -> Split:
    """UserError where runs differ in columns, none commands, or one has a name that others cannot have."""
    names = list(dataset.runs[0].columns)
    for run in dataset.runs:
        odd = set(names) ^ set(run.columns)
        if odd:
            raise UserError(
                f"{dataset.folder}: column {min(odd)} is not in both {dataset.runs[0].name} and {run.name}; "
                "this format needs the same columns in all runs, so export them as datasets of their own"
            )
    unfit = [name for name in names if "/" in name or not name.isprintable() or name.startswith(".")]
    if unfit:
        raise UserError(f"{dataset.folder}: column {unfit[0]!r} cannot be named so in this format; rename it")
    state = tuple(name for name in STATES if name in names)
    action = LEVERS if set(LEVERS) <= set(names) else tuple(filter(_commands, names))
    if not action:
        raise UserError(f"{dataset.folder}: no column has the commands; this format needs actions")
    return Split(state, action, _rest(names, state, action))


def _commands(name: str) -> bool:
    return name.startswith(COMMANDS)


def _rest(names: Sequence[str], *taken: Sequence[str]) -> tuple[str, ...]:
    return tuple(name for name in names if not any(name in group for group in taken))

"""Runs whose commands were stamped by a clock that is ahead of the sensors'."""

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.runs.resample import at_times, is_held
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import RunMeta, of_part

ROUNDING = 1e-9
"""s, of a row's time and a shift."""


def with_earlier_commands(run: Run, seconds: float) -> Run:
    """The run with commands and joypad taken `seconds` [s] earlier, later if negative, held between rows.

    Rows for which no command was recorded are left out, and of the run's entries those that are not true of
    the others (`of_part`); the entry `commands_shifted` records it.
    UserError for a run without commands or shorter than the shift.
    """
    held = [name for name in run.columns if is_held(name)]
    if not held:
        raise UserError(f"run {run.name}: it has no commands to take earlier; leave --commands-earlier out")
    then = run.time + seconds
    kept = (then >= run.time[0] - ROUNDING) & (then <= run.time[-1] + ROUNDING)
    if np.count_nonzero(kept) < 2:
        raise UserError(
            f"run {run.name}: lasts {run.duration:.3g} s, and --commands-earlier {seconds:g} leaves no rows; "
            "give fewer seconds"
        )
    columns = {
        name: at_times(name, run.time, values, then[kept]) if name in held else values[kept]
        for name, values in run.columns.items()
    }
    earlier = (
        f"{abs(seconds):g} s {'earlier' if seconds > 0.0 else 'later'}; {np.count_nonzero(~kept)} rows "
        f"{'after the last' if seconds > 0.0 else 'before the first'} command left out"
    )
    own = of_part(run.meta.model_dump(), first=bool(kept[0]), last=bool(kept[-1]))
    return Run(run.name, columns, RunMeta.model_validate(own | {"commands_shifted": earlier}))

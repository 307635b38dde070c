"""Sensitivity of the prediction to the commands."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.windows import Windows
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit

Array = NDArray[np.float64]


def command_sensitivity(problem: Shooting, at: Fit, window: int, changes: Array) -> Array:
    """(n, M) changes of a window's standardised prediction by changes (n, T, C) of its run's commands."""
    run_set, win = problem.run_set, problem.windows
    run, count = int(win.run[window]), len(changes)
    unchanged = np.zeros((1, *changes.shape[1:]))

    def each(values: NDArray[np.generic]) -> NDArray[np.generic]:
        """The window's own, once for every change."""
        return np.repeat(values[window][None], count + 1, axis=0)

    windows = Windows(
        np.arange(count + 1),
        each(win.first),  # type: ignore[arg-type]
        each(win.steps),  # type: ignore[arg-type]
        each(win.measured),  # type: ignore[arg-type]
        each(win.weight),  # type: ignore[arg-type]
        win.pad,
        win.rows,
    )
    commands = run_set.commands[run] + np.concatenate([changes, unchanged])
    several = run_set.copies([run] * (count + 1), commands)
    weight = np.repeat(problem.weight[run][None], count + 1, axis=0)
    many = Shooting(several, weight, problem.seconds, windows)
    states = np.repeat(at.states[window][None], count + 1, axis=0)
    track = many.predict(at.hypothesis, at.x[None], states[None])[0]
    return many.part(np.arange(count + 1) < count).standardised(track[:-1] - track[-1]).reshape(count, -1)

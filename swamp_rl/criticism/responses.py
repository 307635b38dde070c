"""What a window's prediction would be had the boat obeyed other commands."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.fit import Fit
from swamp_rl.criticism.shooting import Shooting
from swamp_rl.criticism.windows import Windows

Array = NDArray[np.float64]


def command_responses(problem: Shooting, at: Fit, window: int, changes: Array) -> Array:
    """(n, M) changes of a window's weighted prediction by changes (n, T, C) of its run's commands."""
    trials, win = problem.trials, problem.windows
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
    several = replace(
        trials,
        names=(trials.names[run],) * (count + 1),
        commands=trials.commands[run] + np.concatenate([changes, unchanged]),
        measured=np.repeat(trials.measured[run][None], count + 1, axis=0),
        lengths=np.repeat(trials.lengths[run], count + 1),
        gaps=(),
    )
    weight = np.repeat(problem.weight[run][None], count + 1, axis=0)
    many = Shooting(several, weight, problem.seconds, windows)
    states = np.repeat(at.states[window][None], count + 1, axis=0)
    track = many.predict(at.hypothesis, at.x[None], states[None])[0]
    return many.part(np.arange(count + 1) < count).weighed(track[:-1] - track[-1]).reshape(count, -1)

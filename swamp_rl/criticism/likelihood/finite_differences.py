"""Jacobians of the standardised prediction of windows, by finite differences of simulations."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.likelihood.multiple_shooting import NO_ACCELERATION, Shooting
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.criticism.options import options
from swamp_rl.criticism.threads import divided

Array = NDArray[np.float64]


def moved_together(hypothesis: Hypothesis) -> list[tuple[NDArray[np.int64], EffectInstance]]:
    """Columns of x that one simulation moves, the same parameter of all groups, and their effect."""
    found: list[tuple[NDArray[np.int64], EffectInstance]] = []
    start = 0
    for own in hypothesis.instances:
        columns = np.arange(start, start + own.size).reshape(own.count, -1)
        found += [(column, own) for column in columns.T]
        start += own.size
    return found


def state_jacobian(
    problem: Shooting,
    hypothesis: Hypothesis,
    x: Array,
    states: Array,
    base: Array,
    acceleration: Array = NO_ACCELERATION,
    block: int = 1,
) -> Array:
    """(W, M, 6) derivative of the standardised prediction by the initial states; by positions
    analytically. acceleration: (W or 0, B, 3). Without one, those of the last numbers are kept: a fit
    asks again for windows whose initial state has not moved.
    """
    if len(acceleration):
        return _state_slopes(problem, hypothesis, x, states, base, acceleration, block)
    key = x.tobytes()
    if not (problem.last_slopes and problem.last_slopes[0] is hypothesis and problem.last_slopes[1] == key):
        problem.last_slopes[:] = [hypothesis, key, {}]
    known: dict[tuple[int, int, bytes], Array] = problem.last_slopes[2]
    win = problem.windows
    starts = [row.tobytes() for row in np.ascontiguousarray(states)]
    keys = list(zip(win.run.tolist(), win.first.tolist(), starts, strict=True))
    new = np.array([one not in known for one in keys], dtype=bool)
    if new.any():
        part = problem if new.all() else problem.part(new)
        made = _state_slopes(part, hypothesis, x, states[new], base[new], acceleration, block)
        known.update(zip((keys[w] for w in np.flatnonzero(new)), made, strict=True))
        if new.all():
            return made
    return np.stack([known[one] for one in keys])


def _state_slopes(
    problem: Shooting,
    hypothesis: Hypothesis,
    x: Array,
    states: Array,
    base: Array,
    acceleration: Array,
    block: int,
) -> Array:
    moved, step = np.repeat(states[None], 4, axis=0), np.array(options().state_step) * problem.scale
    for i, column in enumerate((2, 3, 4, 5)):
        moved[i, :, column] += step[column]
    four = np.repeat(x[None], 4, axis=0)
    prediction, base = _moved_from(problem, hypothesis, x, states, base, four, moved, acceleration, block)
    change = np.zeros((6, *base.shape))
    change[0, ..., 0] = 1.0
    change[1, ..., 1] = 1.0
    for i, column in enumerate((2, 3, 4, 5)):
        change[column] = (prediction[i] - base) / step[column]
    return np.ascontiguousarray(np.moveaxis(problem.standardised(change), 0, -1))


def parameter_jacobian(
    problem: Shooting,
    hypothesis: Hypothesis,
    x: Array,
    states: Array,
    base: Array,
    chosen: NDArray[np.bool_] | None = None,
    acceleration: Array = NO_ACCELERATION,
    block: int = 1,
) -> Array:
    """(W, M, p) derivative of the standardised prediction by x, one-sided differences within the bounds;
    chosen: (p,) the columns that are wanted. A parameter that differs between groups of runs is moved in
    all groups at once, since each window is of one group. acceleration: (W or 0, B, 3).
    """
    size = hypothesis.size
    wanted = np.arange(size) if chosen is None else np.flatnonzero(chosen)
    slopes = np.zeros((problem.windows.count, base[0].size, len(wanted)))
    moves = [(columns, own) for columns, own in moved_together(hypothesis) if columns[0] in wanted]
    if not moves:
        return slopes
    step = np.array([s.difference for s in hypothesis.specs])
    step = np.where(x + step > hypothesis.bounds()[1], -step, step)
    moved = np.repeat(x[None], len(moves), axis=0)
    for row, (columns, _) in zip(moved, moves, strict=True):
        row[columns] += step[columns]
    same = np.repeat(states[None], len(moves), axis=0)
    prediction, base = _moved_from(problem, hypothesis, x, states, base, moved, same, acceleration, block)
    origins = problem.run_set.origins[problem.windows.run]

    def part(chosen: slice) -> None:
        for one, (columns, own) in zip(prediction[chosen], moves[chosen], strict=True):
            mine = columns[np.array(own.groups)[origins]] if own.groups else columns[0]
            slope = problem.standardised((one - base) / np.reshape(step[mine], (-1, 1, 1)))
            slopes[np.arange(len(slopes)), :, np.searchsorted(wanted, mine)] = slope

    divided(part, len(moves), slopes.size // options().slope_share)
    return slopes


def _moved_from(
    problem: Shooting,
    hypothesis: Hypothesis,
    x: Array,
    states: Array,
    base: Array,
    moved: Array,
    begun: Array,
    acceleration: Array,
    block: int,
) -> tuple[Array, Array]:
    """Predictions for moved x (V, p) and states (V, W, 6), and what these are compared with: `base` at x and
    states; both in the simulator's own steps where the problem's are finer, unless one diverges in those.
    """
    if problem.substeps > problem.jacobian_substeps:
        coarse = problem.integrated_in(problem.jacobian_substeps)
        numbers, starts = np.concatenate([x[None], moved]), np.concatenate([states[None], begun])
        forces = np.tile(acceleration, (len(numbers), 1, 1))
        every = coarse.predict(hypothesis, numbers, starts, forces, block)
        if np.isfinite(every).all():
            return every[1:], every[0]
    return problem.predict(hypothesis, moved, begun, np.tile(acceleration, (len(moved), 1, 1)), block), base

"""The mean over several trainings, all tried in the same episodes: how sure it is when both are drawn."""

import numpy as np
from numpy.typing import ArrayLike

from swamp_rl.evaluation.statistics import ENDS, RESAMPLES, Interval


def crossed_mean(values: ArrayLike, rng: np.random.Generator, resamples: int = RESAMPLES) -> Interval:
    """Mean of values (S, E), of S trainings in E shared episodes, with a percentile interval; NaN left out.

    Trainings and episodes are both drawn anew, each for itself (the pigeonhole bootstrap of Owen 2007, Ann.
    Appl. Stat. 1): what a training has in common over the episodes, and an episode over the trainings, is
    not taken for independent. It errs towards too wide. n is S. Without any value all is NaN. ValueError
    where the shape is not (S, E).
    """
    table = np.asarray(values, dtype=float)
    if table.ndim != 2:
        raise ValueError(f"values are (trainings, episodes); got the shape {table.shape}")
    known = np.isfinite(table)
    trainings, episodes = table.shape
    if not known.any():
        return Interval(float("nan"), float("nan"), float("nan"), trainings)
    filled = np.where(known, table, 0.0)
    rows = rng.multinomial(trainings, np.full(trainings, 1.0 / trainings), resamples).astype(float)
    columns = rng.multinomial(episodes, np.full(episodes, 1.0 / episodes), resamples).astype(float)
    total = ((rows @ filled) * columns).sum(axis=1)
    count = ((rows @ known) * columns).sum(axis=1)
    means = total[count > 0] / count[count > 0]
    low, high = np.quantile(means, ENDS)
    return Interval(float(table[known].mean()), float(low), float(high), trainings)

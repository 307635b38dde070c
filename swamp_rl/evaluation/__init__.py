"""How good a pilot is: the same seeded episodes for every pilot, with intervals."""

from swamp_rl.evaluation.episodes import (
    COSTS,
    ELECTRIC,
    Table,
    costs_of,
    differences,
    episode_table,
    read_episodes,
    summary,
    write_episodes,
)
from swamp_rl.evaluation.metrics import command_change, jet_power, path_length
from swamp_rl.evaluation.permutation import holm, sign_flip_test
from swamp_rl.evaluation.rollout import MakeBoats, Rollout, drive
from swamp_rl.evaluation.seeds import (
    common_steps,
    curve_band,
    interquartile_mean,
    mean_over_tasks,
    probability_of_improvement,
)
from swamp_rl.evaluation.statistics import (
    Interval,
    paired_difference,
    success_difference,
    success_difference_of_seeds,
    wilson,
    with_episodes,
)

__all__ = [
    "COSTS",
    "ELECTRIC",
    "Interval",
    "MakeBoats",
    "Rollout",
    "Table",
    "command_change",
    "common_steps",
    "costs_of",
    "curve_band",
    "differences",
    "drive",
    "episode_table",
    "holm",
    "interquartile_mean",
    "jet_power",
    "mean_over_tasks",
    "paired_difference",
    "path_length",
    "probability_of_improvement",
    "read_episodes",
    "sign_flip_test",
    "success_difference",
    "success_difference_of_seeds",
    "summary",
    "wilson",
    "with_episodes",
    "write_episodes",
]

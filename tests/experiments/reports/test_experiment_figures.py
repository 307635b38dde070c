"""The figure of the training runs has a panel for each outcome that there is."""

import numpy as np
from swamp_rl.experiments.reports.experiment_figures import training_panels

from swamp_rl.runs import Run, RunMeta


def run(name: str, outcome: str) -> Run:
    return Run(name, {"time": np.zeros(1)}, RunMeta(outcome=outcome))


def test_training_runs_without_a_failed_one_have_one_panel() -> None:
    runs = [run("a", "success"), run("b", "buoy"), run("c", "success")]
    assert [(title, len(shown)) for title, shown in training_panels(runs)] == [
        ("2 successful runs", 2),
        ("1 unsuccessful run", 1),
    ]
    assert [title for title, _ in training_panels(runs[:1])] == ["1 successful run"]

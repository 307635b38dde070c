"""The table of where the time goes adds up to all of it, each stage under its own kind of work."""

import pytest
from swamp_rl.experiments.config.load import load_experiment

from benchmarks.speed.stages import divided, times


def test_every_second_of_every_stage_is_counted_once() -> None:
    seconds = {
        "record runs": 10.0,
        "train scripted": 0.5,
        "train reservoir": 2.0,
        "train cloning": 8.0,
        "train ppo": 60.0,
        "evaluate ppo, calm": 1.0,
        "evaluate ppo, severe": 2.0,
        "evaluate reservoir-alone, calm": 4.0,
        "compare": 1.0,
        "draw figures": 2.0,
    }
    spent = divided(seconds, load_experiment("camogli"), 0.25)
    assert spent == {
        "record runs": 10.0,
        "train others": 0.5,
        "fit to runs": 10.0,
        "PPO: the boats": 15.0,
        "PPO: the network": 45.0,
        "evaluate ppo": 3.0,
        "evaluate reservoir-alone": 4.0,
        "compare, draw and write": 3.0,
    }
    assert sum(spent.values()) == pytest.approx(sum(seconds.values()))
    shares = [int(row.split("|")[-2]) for row in times(spent).splitlines()[2:]]
    assert sum(shares[:-1]) == pytest.approx(100, abs=4)
    assert times(spent).splitlines()[-1].split("|")[1:3] == [" all ", " 90 "]

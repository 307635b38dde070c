"""Runs that the report of an experiment could not use are refused before anything is trained."""

from pathlib import Path

import pytest
from swamp_rl.experiments.studies.run import run_experiment, train_experiment

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, RunMeta, append_run, create_dataset
from swamp_rl.runs.schema import meta_of
from tests.support.runs import circling
from tests.support.tiny_experiment import write_tiny


def test_runs_without_a_success_are_refused_in_one_line(tmp_path: Path) -> None:
    data = tmp_path / "runs"
    create_dataset(data, meta_of(load_boat("swamp"), "swamp", 10.0, "measured"))
    append_run(data, Run("one", circling()))
    with pytest.raises(UserError, match="no run is marked successful") as told:
        run_experiment(write_tiny(tmp_path, "scripted"), [f"data={{folder: {data}}}"], tmp_path / "out")
    assert "\n" not in str(told.value) and not (tmp_path / "out").exists()


def test_a_pilot_that_asks_for_more_runs_than_there_are_is_named_with_the_folder(tmp_path: Path) -> None:
    data = tmp_path / "runs"
    create_dataset(data, meta_of(load_boat("swamp"), "swamp", 10.0, "measured"))
    append_run(data, Run("one", circling(), RunMeta(outcome="success")))
    asked = [f"data={{folder: {data}}}", "pilots.net.runs=2"]
    with pytest.raises(UserError) as told:
        train_experiment(write_tiny(tmp_path, "scripted", "net"), asked, tmp_path / "out")
    assert str(told.value) == (
        f"{data}: pilots.net: 2 runs with the outcome success are asked for, 1 are there; "
        "record more, or ask for fewer"
    )
    assert not (tmp_path / "out").exists()

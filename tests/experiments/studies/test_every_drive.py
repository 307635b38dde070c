"""A small experiment on a boat of every kind of drive: `run EXPERIMENT --set boat=BOAT`."""

from pathlib import Path

import pytest
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.studies.run import run_experiment

from swamp_rl.boat.estimate import KINDS, Kind
from swamp_rl.runs import read_dataset
from tests.support.new_boats import file_of

EXPERIMENT = """
name: any
boat: swamp
course: camogli
data: {record: {good: 2, failed: 0, disturbances: standard}}
pilots:
  scripted: {kind: scripted}
  line-of-sight: {kind: line-of-sight}
  cloning: {kind: cloning}
  ppo: {kind: ppo, disturbances: standard}
evaluation: {levels: [calm, severe], episodes: 3, seed: 0, shown: 1}
smoke: true
"""


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
@pytest.mark.parametrize("kind", KINDS)
def test_an_experiment_trains_and_evaluates_all_pilots_on_any_boat(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: Kind
) -> None:
    monkeypatch.chdir(tmp_path)
    boat = file_of(tmp_path, kind, 5.0)
    Path("any.yaml").write_text(EXPERIMENT)
    out = run_experiment("any.yaml", [f"boat={boat}"], tmp_path / "results")
    text = (out / "results.json").read_text()
    assert all(pilot in text for pilot in ("scripted", "line-of-sight", "cloning", "ppo"))
    assert load_experiment(out).boat == str(boat)
    assert len(read_dataset(out / "data").successful) == 2

"""A small experiment on a boat of every kind of drive: `run EXPERIMENT --set boat=BOAT`."""

import json
from pathlib import Path

import pytest
from swamp_rl.experiments.studies.run import run_experiment

from swamp_rl.boat.estimate import KINDS, Kind
from tests.support.new_boats import file_of

EXPERIMENT = """
extends: camogli
name: any
data: {record: {good: 2, failed: 0}}
targets: {success: {}, smoother_than_data: []}
evaluation: {levels: [calm, severe], episodes: 3, shown: 1}
smoke: true
"""


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_an_experiment_trains_and_evaluates_all_pilots_on_any_boat(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: Kind
) -> None:
    monkeypatch.chdir(tmp_path)
    boat = file_of(tmp_path, kind, 5.0)
    Path("any.yaml").write_text(EXPERIMENT)
    out = run_experiment("any.yaml", [f"boat={boat}"], tmp_path / "results")
    found = json.loads((out / "results.json").read_text())
    assert {"scripted", "ppo", "cloning", "reservoir"} <= set(json.dumps(found).replace('"', " ").split())

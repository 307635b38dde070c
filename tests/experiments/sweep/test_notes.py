"""What limits the pilots of a sweep is printed once, not by each trial."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import yaml
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import read_scene
from swamp_rl.experiments.sweep.run import run_sweep
from swamp_rl.experiments.sweep.trial import carry_out

from swamp_rl.pilots.record import record_scripted
from tests.support.sweep_pools import PoolHere


@pytest.mark.slow
def test_calm_runs_are_reported_once_for_all_trials(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    @contextmanager
    def pool(*_: Any) -> Iterator[PoolHere]:
        yield PoolHere(carry_out, 1, 0)

    monkeypatch.setattr("swamp_rl.experiments.sweep.run.open_pool", pool)
    boats = read_scene(load_experiment("smoke")).boats_at(None)
    record_scripted(boats, tmp_path / "runs", boat="swamp", course="camogli", count=1, step=0.1)
    entries = {
        "name": "s",
        "experiment": "smoke",
        "set": {
            "data.folder": str(tmp_path / "runs"),
            "pilots.reservoir-alone.runs": 1,
            "evaluation.episodes": 1,
        },
        "parameters": {"pilots.reservoir-alone.options.units": {"grid": [10, 20]}},
        "objective": {"pilot": "reservoir-alone", "level": "standard"},
    }
    (tmp_path / "sweep.yaml").write_text(yaml.safe_dump(entries))
    run_sweep(tmp_path / "sweep.yaml", out=tmp_path / "out")
    message = capsys.readouterr().err
    assert message.count("recorded without disturbances") == message.count("swamp-rl:") == 1
    assert (
        "pilots.reservoir-alone: recorded without disturbances: 1 of 1 training run;" in message
        and "cloning" not in message
    )

"""The boat file that all datasets of a fleet are compared with."""

from pathlib import Path

import pytest
from swamp_rl.experiments.fleet.run import diagnose_fleet

from swamp_rl.files import read_yaml, write_yaml
from tests.support.fleets import datasets, pretend
from tests.support.sweep_pools import PoolHere


def test_it_is_read_once_for_all_datasets(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    entries = {"red": {"causes": []}, "blue": {"causes": []}}
    datasets(tmp_path / "in", entries)
    boat = tmp_path / "boat.yaml"
    write_yaml(boat, {"extends": "swamp"})
    read: list[Path] = []
    monkeypatch.setattr("swamp_rl.boat.load.read_yaml", lambda file: (read.append(file), read_yaml(file))[1])
    given = [tmp_path / "in" / name for name in entries]
    found = diagnose_fleet(given, tmp_path / "out", str(boat), pool=PoolHere(pretend, 1, 0))
    assert [one.error for one in found.members] == [None, None] and read.count(boat) == 1

"""Which files of a dataset decide whether its diagnosis is kept."""

from pathlib import Path

import pytest
from swamp_rl.experiments.fleet.run import diagnose_fleet

from tests.support.fleets import datasets, pretend
from tests.support.sweep_pools import PoolHere


@pytest.fixture
def dataset(tmp_path: Path) -> Path:
    return datasets(tmp_path / "in", {"red": {"causes": []}})[0]


def diagnosed(dataset: Path) -> list[str]:
    """The datasets that a fleet of this one diagnoses."""
    heard: list[str] = []
    out = dataset.parent.parent / "out"
    diagnose_fleet([dataset], out, pool=PoolHere(pretend, 1, 0), tell=lambda name, result: heard.append(name))
    return heard


@pytest.mark.parametrize(
    "name", ["run.csv", "run.CSV", "run.PARQUET", "boat.yml", "dataset.yaml", "run\udcff.csv"]
)
def test_a_file_that_a_reader_of_the_dataset_takes_makes_it_be_diagnosed_again(
    dataset: Path, name: str
) -> None:
    (dataset / name).write_text("before")
    assert diagnosed(dataset) == ["red"] and diagnosed(dataset) == []
    (dataset / name).write_text("after")
    assert diagnosed(dataset) == ["red"]


@pytest.mark.parametrize("name", ["analysis/tracks.csv", "red/run.csv", ".run.csv", "notes.txt"])
def test_a_file_that_none_takes_is_not_even_read(dataset: Path, name: str) -> None:
    (dataset / name).parent.mkdir(exist_ok=True)
    (dataset / name).write_text("before")
    assert diagnosed(dataset) == ["red"]
    (dataset / name).write_text("after")
    assert diagnosed(dataset) == []

"""Which files of a dataset decide whether its diagnosis is kept."""

from pathlib import Path
from typing import Any

import pytest
from swamp_rl.experiments.fleet.run import diagnose_fleet
from swamp_rl.experiments.fleet.work import RESULT

from swamp_rl.files import write_yaml
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


def kept_and_made_again(given: list[Path], boat: Path | str, pool: Any = None) -> tuple[int, int]:
    """How many diagnoses of a fleet beside `in` are kept, and how many of an earlier one are made again."""
    heard: list[tuple[int, int]] = []
    diagnose_fleet(
        given,
        given[0].parents[1] / "out",
        str(boat),
        pool=pool or PoolHere(pretend, 1, 0),
        tell_kept=lambda kept, again: heard.append((kept, again)),
    )
    return heard[0]


def test_another_path_of_the_same_boat_file_keeps_the_diagnoses_and_another_number_does_not(
    dataset: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(dataset.parent)
    boat = dataset.parents[1] / "boat.yaml"
    write_yaml(boat, {"extends": "swamp"})
    assert kept_and_made_again([dataset], boat) == (0, 0)
    assert kept_and_made_again([dataset], "../boat.yaml") == (1, 0)
    assert kept_and_made_again([dataset], "swamp") == (1, 0)
    write_yaml(boat, {"extends": "swamp", "mass": 40.0})
    assert kept_and_made_again([dataset], boat) == (0, 1)
    numbers = {"numbers": ["mass"], "standard_errors": [2.0], "correlation": [[]], "source": "trials"}
    write_yaml(boat, {"extends": "swamp", "mass": 40.0, "covariance": numbers})
    assert kept_and_made_again([dataset], boat) == (0, 1)


class Killed(PoolHere):
    """Ends the command after the first diagnosis."""

    def wait(self) -> tuple[int, str | None, str]:
        if self.ended:
            raise KeyboardInterrupt
        self.ended = True
        return super().wait()

    ended = False


def test_a_fleet_that_is_killed_while_it_makes_diagnoses_again_leaves_every_other_one(tmp_path: Path) -> None:
    given = datasets(tmp_path / "in", {name: {"causes": []} for name in ("blue", "green", "red")})
    assert kept_and_made_again(given, "swamp") == (0, 0)
    results = [tmp_path / "out" / one.name / RESULT for one in given]
    before = [path.read_text() for path in results]
    with pytest.raises(KeyboardInterrupt):
        kept_and_made_again(given, "swamp-light", Killed(pretend, 1, 0))
    after = [path.read_text() for path in results]
    assert sum(old != new for old, new in zip(before, after, strict=True)) == 1
    assert kept_and_made_again(given, "swamp-light") == (1, 2)

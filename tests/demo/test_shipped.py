"""What comes with the package to be shown: pilots that can drive, and a run that says who drove.

`python -m benchmarks.learners.shipped_pilots` makes them anew.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.experiments.artifacts.demo_runs import read_shown

import swamp_rl
from swamp_rl.boat import load_boat
from swamp_rl.boat.digest import boat_digest
from swamp_rl.course import fitted, load_course
from swamp_rl.errors import UserError
from swamp_rl.evaluation import drive
from swamp_rl.files import shipped_folders
from swamp_rl.pilots.arguments import asked_pilot, opened
from swamp_rl.pilots.store import BUILT_IN, describe_pilot, load_pilot
from swamp_rl.runs import check_dataset, read_dataset

PILOTS, RUNS = shipped_folders("pilots"), shipped_folders("runs")
EPISODES = np.arange(60) + 9_000_000  # of no experiment


def boats(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
    return GatesVectorEnv(n, observation=senses)


def test_they_are_small() -> None:
    files = [file for folder in (*PILOTS.values(), *RUNS.values()) for file in folder.rglob("*")]
    assert {"reservoir", "cloning"} <= set(PILOTS) and len(RUNS) == 1
    assert sum(file.stat().st_size for file in files) < 500_000


@pytest.mark.parametrize("name", PILOTS)
def test_a_pilot_says_which_package_made_it_for_the_boat_as_it_is_now(name: str) -> None:
    result = describe_pilot(PILOTS[name])
    assert result.made is not None and result.fitted_on is not None
    assert result.made.package.split()[0] == swamp_rl.__name__ and result.made.package.split()[1][0].isdigit()
    assert result.made.boat_sha256 == boat_digest(load_boat("swamp")), "make them anew, see above"
    assert result.made.boat_sha256 != boat_digest(load_boat("swamp-light"))
    assert result.fitted_on.source == "scripted"


@pytest.mark.parametrize("name", PILOTS)
@pytest.mark.parametrize("file", ["pilot.json", "weights.safetensors"])
def test_a_changed_byte_of_a_pilot_is_refused(tmp_path: Path, name: str, file: str) -> None:
    copy = Path(shutil.copytree(PILOTS[name], tmp_path / name))
    data = bytearray((copy / file).read_bytes())
    data[-20] ^= 1
    (copy / file).write_bytes(data)
    with pytest.raises(UserError):
        load_pilot(copy)


@pytest.mark.parametrize("name", [*PILOTS, *BUILT_IN])
def test_a_pilot_succeeds_in_calm_water(name: str) -> None:
    rollout = drive(opened(asked_pilot(name)), boats, EPISODES)
    assert (rollout.outcome == "success").mean() >= 0.9


def test_the_run_stands_alone_and_says_that_a_programme_drove() -> None:
    (folder,) = RUNS.values()
    dataset = read_dataset(folder)
    (run,) = dataset.runs
    assert check_dataset(folder) == []
    assert dataset.meta.source == "scripted" and "no person" in str(dataset.meta.notes)
    assert set(dataset.meta.copies) == {"swamp.yaml", "camogli.course.yaml"}
    assert boat_digest(dataset.boat) == boat_digest(load_boat("swamp")), "make it anew, see above"
    assert dataset.course == fitted(load_course("camogli"), dataset.boat.length)
    assert run.meta.outcome == "success"


def test_without_a_source_all_of_them_are_shown_in_one_weather() -> None:
    scene = read_shown([], [], None)
    assert scene.groups == ["scripted", *PILOTS, *BUILT_IN]
    assert scene.conditions.same and scene.conditions.sentence.startswith(
        "same start, same weather: standard, seed "
    )
    assert "human" not in scene.about
    first = np.array([item.run.pose[0] for item in scene.shown])
    assert first == pytest.approx(np.broadcast_to(first[:1], first.shape), abs=1e-9)

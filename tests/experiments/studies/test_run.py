"""The main job in small, from its YAML to a folder of results; and what is left when it cannot be done."""

import json
import math
import re
import shutil
import subprocess
import sys
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.experiments.artifacts.demo_runs import read_shown
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.studies import main as main_job
from swamp_rl.experiments.studies.run import run_experiment
from swamp_rl.experiments.training import train as learn

from swamp_rl.demo.conditions import conditions
from swamp_rl.errors import UserError
from swamp_rl.evaluation import drive
from swamp_rl.pilots.store import load_pilot
from swamp_rl.runs import check_dataset, read_dataset
from tests.support.tiny_experiment import write_tiny

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("run")]  # what they share is made once

PILOTS = ["scripted", "line-of-sight", "reservoir", "reservoir-alone", "cloning", "ppo"]
LEVELS = ["calm", "standard", "severe"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("results") / "smoke"
    assert run_experiment("smoke", out=out) == out
    return out


@pytest.fixture(scope="module")
def results(folder: Path) -> dict[str, Any]:
    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    return json.loads((folder / "results.json").read_text(), parse_constant=refuse)


@pytest.fixture(scope="module")
def episodes(folder: Path) -> dict[str, np.ndarray]:
    table = pq.read_table(folder / "episodes.parquet").to_pydict()
    return {name: np.array(values) for name, values in table.items()}


def test_every_pilot_drives_the_same_episodes_at_every_level(episodes: dict[str, np.ndarray]) -> None:
    seeds = load_experiment("smoke").evaluation.seed + np.arange(12)
    assert len(episodes["seed"]) == len(PILOTS) * len(LEVELS) * len(seeds)
    for pilot in PILOTS:
        for level in LEVELS:
            rows = (episodes["pilot"] == pilot) & (episodes["level"] == level)
            assert np.array_equal(episodes["seed"][rows], seeds)


def test_results_say_what_the_episodes_say(results: dict[str, Any], episodes: dict[str, np.ndarray]) -> None:
    assert list(results["pilots"]) == PILOTS
    for pilot in PILOTS:
        for level in LEVELS:
            found = results["pilots"][pilot]["levels"][level]
            rows = (episodes["pilot"] == pilot) & (episodes["level"] == level)
            won = rows & episodes["success"]
            assert found["successes"] == won.sum() == (episodes["outcome"][rows] == "success").sum()
            assert sum(found["outcomes"].values()) == found["episodes"] == 12
            mean = found["mean_of_successes"]["time"]
            assert mean is None if not won.any() else mean == pytest.approx(episodes["time"][won].mean())


def test_intervals_in_the_results_are_wilsons(results: dict[str, Any]) -> None:
    found = results["pilots"]["scripted"]["levels"]["severe"]
    n, p, z = 12, found["success_rate"], 1.959963984540054
    half = z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    ends = [(p + z * z / (2 * n) + sign * half) / (1 + z * z / n) for sign in (-1, 1)]
    assert found["wilson_95"] == pytest.approx(ends)


def test_every_target_is_judged_by_what_was_measured(results: dict[str, Any]) -> None:
    assert len(results["targets"]) == 12
    for target in results["targets"]:
        level = results["pilots"][target["pilot"]]["levels"][target["level"]]
        if target["what"] == "success":
            assert target["measured"] == level["success_rate"]
            assert target["reached"] == (level["success_rate"] >= target["needed"])
        else:
            assert target["needed"] == results["data"]["command_change"]
            assert target["measured"] == level["mean_of_successes"]["command_change"]
            assert target["reached"] == (
                target["measured"] is not None and target["measured"] < target["needed"]
            )


def test_pilots_are_compared_in_pairs_at_every_level(results: dict[str, Any]) -> None:
    assert len(results["differences"]) == len(list(combinations(PILOTS, 2))) * len(LEVELS)
    for found in results["differences"]:
        a, b = (results["pilots"][found[end]]["levels"][found["level"]]["success_rate"] for end in ("a", "b"))
        assert found["success"]["value"] == pytest.approx(a - b)
        assert found["success"]["low"] <= found["success"]["value"] <= found["success"]["high"]


def test_the_recorded_runs_are_sound_and_marked_scripted(folder: Path, results: dict[str, Any]) -> None:
    assert check_dataset(folder / "data") == []
    dataset = read_dataset(folder / "data")
    assert dataset.meta.source == results["data"]["source"] == "scripted"
    assert len(dataset.successful) == results["data"]["successful"] == 4


def test_a_saved_pilot_drives_again_as_it_was_evaluated(
    folder: Path, episodes: dict[str, np.ndarray]
) -> None:
    for name in ("reservoir-alone", "cloning"):
        again = drive(
            load_pilot(folder / "pilots" / name),
            lambda n, senses: GatesVectorEnv(n, disturbances="standard", observation=senses),
            load_experiment("smoke").evaluation.seed + np.arange(4),
        )
        rows = (episodes["pilot"] == name) & (episodes["level"] == "standard")
        assert again.outcome.tolist() == episodes["outcome"][rows][:4].tolist()
        assert again.steps * 0.1 == pytest.approx(episodes["time"][rows][:4])


def test_the_recording_for_rerun_can_be_read(folder: Path) -> None:
    asked = [sys.executable, "-m", "rerun", "rrd", "stats", str(folder / "demo.rrd")]
    listed = subprocess.run(asked, capture_output=True, text=True, check=True).stdout
    for who in ["scripted", *PILOTS[1:]]:
        assert f"/chart/runs/{who}/track:" in listed
        assert rf"/series/angle\ lever\ \[1\]/{who}:" in listed


def test_the_report_names_every_pilot_and_shows_pictures_that_are_there(folder: Path) -> None:
    text = (folder / "report.md").read_text()
    assert all(f"| {pilot} |" in text for pilot in PILOTS)
    pictures = re.findall(r"!\[[^]]+\]\(([^)]+)\)", text)
    assert len(pictures) == 4
    assert all((folder / picture).read_bytes().startswith(b"\x89PNG") for picture in pictures)


def test_the_kept_configuration_is_the_experiment_that_was_run(folder: Path) -> None:
    assert load_experiment(folder / "config" / "experiment.yaml") == load_experiment("smoke")
    copies = {path.relative_to(folder / "config").as_posix() for path in (folder / "config").rglob("*.yaml")}
    levels = {f"disturbances/{level}.yaml" for level in LEVELS}
    assert copies == {"experiment.yaml", "boats/swamp.yaml", "courses/camogli.yaml"} | levels
    assert json.loads((folder / "versions.json").read_text())["torch"]


@pytest.mark.usefixtures("no_figures")
def test_the_same_job_twice_gives_the_same_numbers(
    tmp_path: Path, results: dict[str, Any], episodes: dict[str, np.ndarray]
) -> None:
    run_experiment("smoke", out=tmp_path / "again")
    again = json.loads((tmp_path / "again" / "results.json").read_text())
    assert {**again, "measured": None} == {**results, "measured": None}
    table = pq.read_table(tmp_path / "again" / "episodes.parquet").to_pydict()
    assert all(np.array_equal(table[name], values) for name, values in episodes.items())


def stopped(*_: Any) -> None:
    raise KeyboardInterrupt


def test_an_interrupted_job_leaves_the_earlier_result_and_goes_on_when_asked_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "smoke").mkdir()
    (tmp_path / "smoke" / "results.json").write_text("earlier")
    monkeypatch.setattr(main_job, "train_pilots", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_experiment("smoke", out=tmp_path / "smoke")
    assert [path.name for path in (tmp_path / "smoke").iterdir()] == ["results.json"]
    assert (tmp_path / "smoke" / "results.json").read_text() == "earlier"
    monkeypatch.setattr(learn, "record", stopped)  # the runs are there already
    with pytest.raises(KeyboardInterrupt):
        run_experiment("smoke", out=tmp_path / "smoke")
    assert len(read_dataset(tmp_path / ".part-smoke" / "data").successful) == 4


def test_a_folder_that_holds_something_else_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("years of work")
    with pytest.raises(UserError, match="not an earlier result"):
        run_experiment("smoke", out=tmp_path)
    assert (tmp_path / "thesis.txt").read_text() == "years of work"


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("boat=swmp", "swamp"),
        ("course=camoggli", "camogli"),
        ("evaluation.levels=[clam]", "calm"),
        ("pilots.ppo.disturbances=sever", "severe"),
        ("data.folder=nowhere", "nowhere"),
        ("pilots.reservoir.runs=5", "5 runs"),
        ("pilots.cloning.options.senses=[north, depth_of_thought]", "depth_of_thought"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_leaves_nothing(
    tmp_path: Path, override: str, message: str
) -> None:
    with pytest.raises(UserError, match=message) as complaint:
        run_experiment("smoke", [override], tmp_path / "smoke")
    assert "\n" not in str(complaint.value)
    assert list(tmp_path.iterdir()) == []


def test_runs_at_another_rate_are_refused_with_the_step_they_need(tmp_path: Path, folder: Path) -> None:
    with pytest.raises(UserError, match=r"set step to 0\.1"):
        run_experiment("smoke", [f"data.folder={folder / 'data'}", "step=0.2"], tmp_path / "smoke")


def test_a_run_with_a_hole_in_it_is_named_by_file_row_and_column(tmp_path: Path, folder: Path) -> None:
    data = tmp_path / "data"
    data.mkdir()
    header, rows = "time,north,east,heading,joy_thrust,joy_angle", ["0,0,0,0,1,0", "0.1,0,nan,0,1,0"]
    (data / "run-001.csv").write_text("\n".join([header, *rows]) + "\n")
    meta = (folder / "data" / "dataset.yaml").read_text().split("copies:")[0]
    (data / "dataset.yaml").write_text(meta + "runs:\n- {file: run-001.csv, outcome: success}\n")
    with pytest.raises(UserError, match=r"run-001\.csv.*row 2.*east"):
        run_experiment("smoke", [f"data.folder={data}"], tmp_path / "smoke")
    assert not (tmp_path / "smoke").exists()


def test_the_pilots_own_runs_are_kept_with_what_disturbed_them(folder: Path) -> None:
    assert sorted(path.name for path in (folder / "driven").iterdir()) == sorted(PILOTS)
    driven = read_dataset(folder / "driven" / "ppo")
    assert driven.meta.source == "learned"
    assert [run.name for run in driven.runs][:2] == ["ppo-calm-0", "ppo-calm-1"]
    severe = next(run for run in driven.runs if run.name == "ppo-severe-0").meta
    assert {"current", "wind"} <= {entry["effect"] for entry in severe.disturbances}
    same_episode = read_dataset(folder / "driven" / "cloning").runs
    other = next(run for run in same_episode if run.name == "cloning-severe-0").meta
    assert (other.seed, other.disturbances) == (severe.seed, severe.disturbances)


def test_the_race_puts_every_learned_pilot_in_the_start_and_weather_of_the_run_shown(folder: Path) -> None:
    runs = json.loads((folder / "results.json").read_text())["race"]["runs"]
    source = read_dataset(folder / "data")
    shown = {run.name: run for run in source.runs}[runs.pop(source.meta.source)]
    assert set(runs) == set(PILOTS) - {"scripted"}
    for pilot, name in runs.items():
        flown = {run.name: run for run in read_dataset(folder / "driven" / pilot).runs}[name]
        assert conditions([shown, flown]).same


def test_results_of_runs_from_elsewhere_keep_the_one_that_races(folder: Path, tmp_path: Path) -> None:
    elsewhere = Path(shutil.copytree(folder / "data", tmp_path / "elsewhere"))
    out = run_experiment(write_tiny(tmp_path, "reservoir"), [f"data.folder={elsewhere}"], tmp_path / "out")
    shutil.rmtree(elsewhere)
    assert sorted(read_shown([out], [], None).groups) == ["reservoir", "scripted"]

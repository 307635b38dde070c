"""The closed loop in small: logs that hold no truth, pilots from both simulators, the same true episodes."""

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from swamp_rl.experiments.artifacts.demo_runs import read_shown
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import read_scene
from swamp_rl.experiments.config.schema import Logs
from swamp_rl.experiments.evaluation.comparison import compare
from swamp_rl.experiments.studies import closed_loop
from swamp_rl.experiments.studies.closed_loop import noisy, true_scene
from swamp_rl.experiments.studies.run import run_experiment
from swamp_rl.experiments.studies.stored import evaluate_folders
from swamp_rl.experiments.training import train as learn

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, check_dataset, read_dataset
from tests.support.runs import circling
from tests.support.tiny_experiment import empty_figures

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("closed_loop")]  # what they share is made once

SMALL = {
    "extends": "closed_loop",
    "name": "small",
    "hidden": {"logs": {"runs": 3}},
    "data": {"record": {"good": 3}},
    "evaluation": {"episodes": 8, "levels": ["calm"]},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of a loop with a reservoir alone."""
    place = tmp_path_factory.mktemp("loop")
    whole = yaml.safe_load((Path(__file__).parents[3] / "configs/experiments/closed_loop.yaml").read_text())
    pilots = {"reservoir": whole["pilots"]["reservoir"] | {"runs": 3}}
    base = {key: value for key, value in whole.items() if key != "pilots"} | {"pilots": pilots}
    (place / "base.yaml").write_text(yaml.safe_dump(base))
    (place / "small.yaml").write_text(yaml.safe_dump(SMALL | {"extends": "base.yaml"}))
    with empty_figures():
        return run_experiment(place / "small.yaml", out=place / "results")


def test_the_extended_boat_is_flown_beside_the_nominal_one_on_the_same_episodes(folder: Path) -> None:
    table = pq.read_table(folder / "episodes.parquet").to_pydict()
    seeds = load_experiment("closed_loop").evaluation.seed + np.arange(8)
    for pilot in ("reservoir, nominal", "reservoir, extended", "scripted"):
        rows = np.array(table["pilot"]) == pilot
        assert np.array_equal(np.array(table["seed"])[rows], seeds), pilot
    results: dict[str, Any] = json.loads((folder / "results.json").read_text())
    (difference,) = results["differences"]
    won = {
        s: results["pilots"][f"reservoir, {s}"]["levels"]["calm"]["success_rate"]
        for s in ("nominal", "extended")
    }
    assert difference["extended_less_nominal"]["value"] == pytest.approx(won["extended"] - won["nominal"])
    assert difference["extended_less_nominal"]["n"] == 8


def test_the_pilots_of_both_simulators_are_evaluated_under_names_that_tell_them_apart(
    folder: Path, tmp_path: Path
) -> None:
    pilots = [folder / side / "pilots" / "reservoir" for side in ("nominal", "extended")]
    with empty_figures():
        found = evaluate_folders(pilots, {"episodes": 2}, out=tmp_path / "out", experiment=str(folder))
    names = set(pq.read_table(found / "episodes.parquet").to_pydict()["pilot"])
    assert names == {"nominal-reservoir", "extended-reservoir"}


def test_a_pilot_is_compared_between_both_simulators_by_its_name_alone(folder: Path) -> None:
    found = compare([folder], only=["reservoir"])
    assert {(row["a"], row["b"]) for row in found["differences"]} == {
        ("reservoir, nominal", "reservoir, extended")
    }


def test_the_true_boat_is_a_file_in_which_pilots_do_as_in_the_report(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pilots = [folder / side / "pilots" / "reservoir" for side in ("nominal", "extended")]
    with empty_figures():
        found = evaluate_folders(
            pilots,
            overrides=[f"boat={folder / 'true_boat.yaml'}"],
            out=tmp_path / "out",
            experiment=str(folder),
        )
        assert "hidden effects do not act" not in capsys.readouterr().err
        evaluate_folders(pilots[:1], {"episodes": 2}, out=tmp_path / "nominal", experiment=str(folder))
    line = (
        f"{folder}: its hidden effects do not act, the pilots drive boat swamp; for the true boat --set boat="
    )
    assert f"{line}{folder / 'true_boat.yaml'}" in capsys.readouterr().err
    both = (pq.read_table(one / "episodes.parquet").to_pylist() for one in (folder, found))
    old, new = ({(row["pilot"], row["level"], row["seed"]): row["time"] for row in rows} for rows in both)
    assert new == {
        (f"{side}-reservoir", level, seed): time
        for (pilot, level, seed), time in old.items()
        for side in ("nominal", "extended")
        if pilot == f"reservoir, {side}"
    }


def test_what_the_folder_does_not_hold_itself_is_reported_with_where_it_is(folder: Path) -> None:
    there = f"name {folder / 'extended'} or {folder / 'nominal'}, with --experiment {folder} --set boat="
    with pytest.raises(UserError, match=f"holds no trained pilot itself; {there}"):
        evaluate_folders(folder)
    with pytest.raises(UserError, match="with hidden or claims keeps no runs of its pilots; name a dataset"):
        read_shown([folder], [], None)


def test_the_logs_read_as_runs_of_the_boat_file_and_do_not_tell_the_truth(folder: Path) -> None:
    assert check_dataset(folder / "logs") == []
    logs = read_dataset(folder / "logs")
    assert (logs.meta.vehicle, logs.meta.source) == ("swamp", "scripted")
    assert not any(name.startswith("applied_") for run in logs.runs for name in run.columns)
    assert "thruster_gain" not in (folder / "logs" / "dataset.yaml").read_text()


def test_what_was_found_is_what_the_second_simulator_is_made_of(folder: Path) -> None:
    found = json.loads((folder / "diagnosis" / "diagnosis.json").read_text())
    boat = load_boat(folder / "diagnosis" / "extended_boat.yaml")
    assert [entry.effect.name for entry in boat.effects] == [cause["effect"] for cause in found["causes"]]
    assert check_dataset(folder / "extended" / "data") == []  # names the boat from where it lies now
    report = (folder / "report.md").read_text()
    assert "reservoir, calm" in report and found["verdict"].replace("_", " ") in report


def test_a_loop_that_was_killed_goes_on_from_its_logs_diagnosis_and_pilots(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    part = folder.parent / ".part-again"
    shutil.copytree(folder, part, ignore=shutil.ignore_patterns("results.json", "report.md"))
    shutil.rmtree(part / "extended" / "pilots")
    for module, name in ((closed_loop, "diagnose"), (closed_loop, "write_logs"), (learn, "record_scripted")):
        monkeypatch.setattr(module, name, None)  # may not be called
    loaded: list[str] = []
    monkeypatch.setattr(closed_loop, "load_boat", lambda boat: (loaded.append(boat), load_boat(boat))[1])
    run_experiment(folder.parent / "small.yaml", out=folder.parent / "again")
    first, second = (
        json.loads((at / "results.json").read_text()) for at in (folder, folder.parent / "again")
    )
    assert {**first, "measured": None} == {**second, "measured": None}
    assert [Path(boat).name for boat in loaded] == ["extended_boat.yaml"]  # the scene has the other
    seconds = second["measured"]["seconds"]
    assert "train reservoir, extended" in seconds and "train reservoir, nominal" not in seconds


def test_noise_is_added_to_what_sensors_measure_and_to_nothing_else() -> None:
    columns = circling(60.0) | {"applied_throttle_bs": np.ones(601)}
    logs = Logs(position_noise=0.2, heading_noise=0.1, velocity_noise=0.0, yaw_rate_noise=0.0)
    made = noisy(Run("run", columns), logs, np.random.default_rng(0))
    assert np.std(made["north"] - columns["north"]) == pytest.approx(0.2, rel=0.1)
    assert np.abs(made["heading"]).max() <= np.pi
    assert np.array_equal(made["surge"], columns["surge"])
    assert np.array_equal(made["azimuth_bs"], columns["azimuth_bs"])
    assert "applied_throttle_bs" not in made


def test_a_pilot_under_the_name_of_the_reference_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"pilots\.scripted: .*rename"):
        run_experiment("closed_loop", ["pilots.scripted={kind: line-of-sight}"], tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_wrong_hidden_effect_is_refused_before_any_work(tmp_path: Path) -> None:
    wrong = ["hidden.effects=[{effect: thruster_gian, thruster: bs, gain: 0.5}]"]
    with pytest.raises(UserError, match="thruster_gain"):
        run_experiment("closed_loop", wrong, tmp_path / "out")
    assert not (tmp_path / "out").exists()
    assert true_scene(read_scene(load_experiment("closed_loop"))).boat.effects

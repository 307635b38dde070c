"""Training, evaluating and doing again: the same numbers by whatever way, bit for bit."""

import json
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
import yaml
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.studies.run import run_experiment, train_experiment
from swamp_rl.experiments.studies.stored import evaluate_folders

from swamp_rl.boat import load_boat
from swamp_rl.course import load_course
from swamp_rl.errors import UserError
from swamp_rl.export import write_onnx
from swamp_rl.pilots.store import describe_pilot, load_pilot
from tests.support.tiny_experiment import content, empty_figures, write_tiny

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("stored")]  # what they share is made once


@pytest.fixture(scope="module", autouse=True)
def no_figures() -> Iterator[None]:
    """The figures of all results are empty files."""
    with empty_figures():
        yield


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the experiment, its result, and its pilots trained by `train`."""
    place = tmp_path_factory.mktemp("tiny")
    run_experiment(write_tiny(place), out=place / "run")
    train_experiment(place / "tiny.yaml", out=place / "trained")
    return place


def test_training_leaves_pilots_and_no_results(place: Path) -> None:
    assert json.loads((place / "trained" / "training.json").read_text())["pilots"] == [
        "scripted",
        "reservoir",
        "net",
        "ppo",
    ]
    assert not (place / "trained" / "results.json").exists()
    for name in ("scripted", "reservoir", "net", "ppo"):
        stored = place / "trained" / "pilots" / name / "weights.safetensors"
        assert stored.read_bytes() == (place / "run" / "pilots" / name / stored.name).read_bytes()


def test_training_then_evaluating_gives_what_running_gives(place: Path) -> None:
    out = evaluate_folders([place / "trained"], {}, out=place / "evaluated")
    assert content(out) == content(place / "run")
    seconds = json.loads((out / "results.json").read_text())["measured"]["seconds"]
    assert "train ppo" in seconds and "evaluate ppo, calm" in seconds


@pytest.mark.parametrize("given", ["run", "run/config", "run/config/experiment.yaml"])
def test_a_result_done_again_from_what_it_keeps_is_the_same_bit_for_bit(place: Path, given: str) -> None:
    config = load_experiment(place / given)
    assert config == load_experiment(place / "tiny.yaml")
    if given == "run":
        assert content(run_experiment(place / given, out=place / "again")) == content(place / "run")


def test_the_configuration_kept_is_used_where_files_have_changed_since(tmp_path: Path) -> None:
    boat = tmp_path / "mine.yaml"
    boat.write_text("extends: swamp\nname: mine\n")
    first = run_experiment(write_tiny(tmp_path, "scripted"), [f"boat={boat}"], tmp_path / "first")
    boat.unlink()
    assert content(run_experiment(first, out=tmp_path / "second")) == content(first)


def test_results_named_as_the_experiment_give_their_own_boat_from_anywhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_tiny(tmp_path, "scripted")
    (tmp_path / "mine.yaml").write_text("extends: swamp\nname: mine\n")
    monkeypatch.chdir(tmp_path)
    first = run_experiment("tiny.yaml", ["boat=mine.yaml"], tmp_path / "first")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    out = evaluate_folders(["line-of-sight"], {"episodes": 2}, out="out", experiment="../first")
    assert (out / "config" / "boats" / "mine.yaml").read_bytes() == (
        first / "config" / "boats" / "mine.yaml"
    ).read_bytes()


def test_hashes_can_be_checked_by_anyone_and_seeds_and_machine_are_reported(place: Path) -> None:
    subprocess.run(["sha256sum", "--check", "--quiet", "data.sha256"], cwd=place / "run", check=True)
    assert len((place / "run" / "data.sha256").read_text().splitlines()) == 1 + 2 + 3
    results: dict[str, Any] = json.loads((place / "run" / "results.json").read_text())
    assert results["seeds"] == {
        "record": 0,
        "pilots": {"scripted": 0, "reservoir": 0, "net": 0, "ppo": 0},
        "first_episode": 1,
    }
    assert results["measured"]["hardware"]["processors"] >= 1
    assert len(results["data"]["sha256"]) == 64


def test_a_pilot_is_stored_with_the_runs_it_was_fitted_on(place: Path) -> None:
    digest = json.loads((place / "run" / "results.json").read_text())["data"]["sha256"]
    fitted = {name: describe_pilot(place / "run" / "pilots" / name).fitted_on for name in ("net", "ppo")}
    assert fitted["ppo"] is None and fitted["net"] is not None
    assert (fitted["net"].dataset, fitted["net"].source) == (digest, "scripted")
    assert fitted["net"].runs == ("run-001", "run-002", "run-003")


def test_the_report_has_a_table_of_where_the_time_went(place: Path) -> None:
    report = (place / "run" / "report.md").read_text()
    seconds = json.loads((place / "run" / "results.json").read_text())["measured"]["seconds"]
    assert {"record runs", "train ppo", "evaluate ppo, calm", "draw figures"} <= seconds.keys()
    assert all(f"| {stage} |" in report for stage in seconds)


def test_other_episodes_are_evaluated_beside_and_with_the_same_pilots(place: Path) -> None:
    changes = {"levels": ["standard"], "episodes": 2, "seed": 9}
    out = evaluate_folders([place / "run"], changes)
    assert out == place / "run-evaluation"
    table = pq.read_table(out / "episodes.parquet").to_pydict()
    assert (set(table["level"]), set(table["seed"])) == ({"standard"}, {9, 10})
    assert "results.json" in {path.name for path in (place / "run").iterdir()}
    weights = Path("pilots") / "ppo" / "weights.safetensors"
    assert (out / weights).read_bytes() == (place / "run" / weights).read_bytes()


def test_results_named_from_here_are_distinguished_from_here(
    place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(place)
    assert evaluate_folders(["run"], {"episodes": 2}) == Path("run-evaluation")
    assert "see run-evaluation/report.md" in capsys.readouterr().out


@pytest.mark.parametrize("ask", [({"levels": ["calm"]}, []), ({}, ["evaluation.levels=[calm]"])])
def test_at_some_of_the_levels_the_targets_are_those_of_these_levels(
    place: Path, tmp_path: Path, ask: tuple[dict[str, Any], list[str]]
) -> None:
    with_targets = tmp_path / "with_targets"
    shutil.copytree(place / "run", with_targets)
    kept = with_targets / "config" / "experiment.yaml"
    data = yaml.safe_load(kept.read_text())
    data["evaluation"]["levels"] = ["calm", "standard"]
    data["targets"] = {"success": {"net": {"calm": 0.5, "standard": 0.5}, "ppo": {"standard": 0.5}}}
    kept.write_text(yaml.safe_dump(data))
    changes, overrides = ask
    out = evaluate_folders([with_targets], {"episodes": 1, **changes}, overrides)
    assert load_experiment(out).targets.success == {"net": {"calm": 0.5}}
    with pytest.raises(UserError, match="no disturbance file named 'clam'"):
        evaluate_folders([with_targets], {"levels": ["clam"]}, out=tmp_path / "out")


def test_stored_pilots_of_several_folders_drive_the_same_episodes(place: Path) -> None:
    folders = [place / "run" / "pilots" / "net", place / "trained" / "pilots" / "net"]
    out = evaluate_folders([*folders, place / "run" / "pilots" / "ppo"], {"episodes": 2}, out=place / "both")
    results = json.loads((out / "results.json").read_text())
    assert list(results["pilots"]) == ["run-net", "trained-net", "ppo"]
    first, second = (results["pilots"][name]["levels"] for name in ("run-net", "trained-net"))
    assert first == second
    page = (out / "report.md").read_text()
    assert "Training data" not in page and "Runs for comparison: 3 successful runs (scripted, " in page
    assert page.count(", trained on 3 runs (scripted)") == 2  # and ppo on none


def test_results_hold_the_hash_of_every_pilot_and_a_stored_one_that_has_changed_since_is_refused(
    place: Path, tmp_path: Path
) -> None:
    def hashed(folder: Path) -> str:
        return subprocess.run(
            ["sha256sum", folder / "pilot.json"], check=True, capture_output=True, text=True
        ).stdout.split()[0]

    net = tmp_path / "net"
    shutil.copytree(place / "run" / "pilots" / "net", net)
    out = evaluate_folders([net], {"episodes": 2}, out=tmp_path / "out", experiment=str(place / "tiny.yaml"))
    results = json.loads((out / "results.json").read_text())
    assert results["pilots"]["net"]["sha256"] == hashed(out / "pilots" / "net")
    assert load_experiment(out).pilots["net"].options == {"folder": str(net), "sha256": hashed(net)}
    whole = json.loads((place / "run" / "results.json").read_text())
    assert {n: p["sha256"] for n, p in whole["pilots"].items()} == {
        name: hashed(place / "run" / "pilots" / name) for name in ("scripted", "reservoir", "net", "ppo")
    }
    shutil.rmtree(net)
    shutil.copytree(place / "run" / "pilots" / "ppo", net)
    with pytest.raises(UserError, match=r"pilots\.net\.options\.sha256: the pilot in .* is no longer"):
        run_experiment(out, out=tmp_path / "again")


def test_pilots_trained_one_after_the_other_come_together(place: Path) -> None:
    for name in ("net", "scripted"):
        train_experiment(place / "tiny.yaml", out=place / "slowly", only=[name])
    assert sorted(path.name for path in (place / "slowly" / "pilots").iterdir()) == ["net", "scripted"]
    out = evaluate_folders([place / "slowly"], {})
    whole, some = (json.loads((folder / "results.json").read_text()) for folder in (place / "run", out))
    assert some["pilots"] == {name: whole["pilots"][name] for name in ("scripted", "net")}


def test_a_boat_that_replaces_a_missing_one_is_evaluated(tmp_path: Path) -> None:
    (tmp_path / "moved.yaml").write_text("extends: smoke\nname: moved\nboat: gone.yaml\n")
    found = evaluate_folders(
        "line-of-sight", {"episodes": 1}, ["boat=swamp"], tmp_path / "out", str(tmp_path / "moved.yaml")
    )
    assert load_experiment(found).boat == "swamp"


def test_a_model_in_the_working_directory_is_not_named_after_it(
    place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pilot = place / "run" / "pilots" / "net"
    write_onnx(load_pilot(pilot), tmp_path / "net.onnx")
    monkeypatch.chdir(tmp_path)
    found = evaluate_folders(["onnx:net.onnx", pilot], {"episodes": 1}, out="out")
    assert set(load_experiment(found).pilots) == {"onnx-net", "run-net"}


def test_what_another_job_has_made_is_not_replaced(place: Path, tmp_path: Path) -> None:
    for made, message in (
        ("trained", "holds pilots trained with another"),
        ("run", "holds a result of tiny"),
    ):
        mine = shutil.copytree(place / made, tmp_path / made)
        for task in (run_experiment, train_experiment):
            with pytest.raises(UserError, match=rf"{mine}: holds .*name another"):
                task("smoke", out=mine)
        with pytest.raises(UserError, match=message):
            run_experiment("smoke", out=mine)
        assert sorted(mine.rglob("*")) == [
            mine / path.relative_to(place / made) for path in sorted((place / made).rglob("*"))
        ]
        assert sorted(path.name for path in tmp_path.iterdir()) == [made]
        shutil.rmtree(mine)


def test_what_would_need_training_or_is_not_there_is_refused_in_one_line(place: Path, tmp_path: Path) -> None:
    def complaint(*words: Any, **more: Any) -> str:
        with pytest.raises(UserError) as error:
            evaluate_folders(*words, **more)
        assert "\n" not in str(error.value)
        return str(error.value)

    assert "nothing is trained again" in complaint([place / "run"], {}, ["pilots.net.options.epochs=9"])
    way = f"to drive another boat or course, name the pilots: {place / 'run' / 'pilots'}"
    assert way in complaint([place / "run"], {}, ["boat=swamp-light"])
    assert "did you mean 'episodes'" in complaint([place / "run"], {}, ["evaluation.episods=9"])
    assert "no such folder" in complaint([place / "nowhere"], {})
    damaged = tmp_path / "damaged"
    shutil.copytree(place / "run", damaged)
    (damaged / "pilots" / "net" / "weights.safetensors").write_bytes(b"cut")
    for folder in (damaged, damaged / "pilots" / "net"):
        assert f"{damaged}/pilots/net/weights.safetensors: is damaged" in complaint(
            [folder], {"episodes": 1}, out=tmp_path / "out"
        )
    shutil.rmtree(damaged / "config")
    for folder in (damaged, damaged / "pilots" / "ppo"):
        message = complaint([folder], {}, out=tmp_path / "out")
        assert message.startswith(str(folder)) and "name an experiment with --experiment" in message
    assert [path.name for path in tmp_path.iterdir()] == ["damaged"]
    with pytest.raises(UserError, match=r"no config/experiment\.yaml in this folder"):
        run_experiment(place / "run" / "figures")
    assert "holds no trained pilot" in complaint([place / "run" / "data", place / "run"], {})
    with pytest.raises(UserError, match="did you mean 'ppo'"):
        train_experiment(place / "tiny.yaml", out=place / "none", only=["pop"])
    with pytest.raises(UserError, match="complete result"):
        train_experiment(place / "tiny.yaml", out=place / "run")


def test_a_dataset_that_has_changed_since_is_refused(place: Path, tmp_path: Path) -> None:
    data = tmp_path / "data"
    data.mkdir()
    for file in (place / "run" / "data").iterdir():
        (data / file.name).write_bytes(file.read_bytes())
    first = run_experiment(write_tiny(tmp_path, "scripted"), [f"data.folder={data}"], tmp_path / "first")
    assert content(run_experiment(first, out=tmp_path / "second")) == content(first)
    (data / "dataset.yaml").write_text((data / "dataset.yaml").read_text() + "\n")
    with pytest.raises(UserError, match="no longer those that it was made with"):
        run_experiment(first, out=tmp_path / "third")


def test_a_boat_file_with_its_suffix_in_capitals_is_evaluated_as_it_was_in_the_training(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("Boat.YAML").write_text("extends: swamp\nname: mine\n")
    train_experiment("smoke", ["boat=Boat.YAML"], Path("out"), ["line-of-sight"])
    Path("Boat.YAML").unlink()
    found = evaluate_folders(Path("out"), {"episodes": 1, "levels": ["calm"]})
    assert (found / "config" / "boats" / "Boat.YAML").is_file()


def test_a_boat_and_a_course_that_extend_files_of_other_folders_are_evaluated_without_these(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    files = {
        "Flotte Süd/mine #2.yaml": "extends: swamp\nname: mine\n",
        "Flotte Süd/pier.yaml": "extends: camogli\n",
        "neu/extended.yaml": "extends: '../Flotte Süd/mine #2.yaml'\nname: extended\n",
        "neu/harbour.yaml": "extends: ../Flotte Süd/pier.yaml\n",
    }
    for name, text in files.items():
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).write_text(text)
    named = ["boat=neu/extended.yaml", "course=neu/harbour.yaml"]
    train_experiment("smoke", named, Path("out"), ["line-of-sight"])
    shutil.rmtree("Flotte Süd")
    shutil.rmtree("neu")
    found = evaluate_folders(Path("out"), {"episodes": 1, "levels": ["calm"]})
    kept = (found / "config" / "boats" / "extended.yaml").read_text()
    assert kept == "extends: 'mine #2.yaml'\nname: extended\n"


def test_a_boat_and_a_course_that_extend_files_of_their_own_names_are_evaluated_without_these(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    files = {
        "first/extended_boat.yaml": "extends: swamp\nname: first\nmass: 51.0\n",
        "first/camogli.yaml": "extends: camogli\n",
        "second/extended_boat.yaml": "extends: ../first/extended_boat.yaml\nname: second\n",
        "second/camogli.yaml": "extends: ../first/camogli.yaml\n",
    }
    for name, text in files.items():
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).write_text(text)
    named = ["boat=second/extended_boat.yaml", "course=second/camogli.yaml"]
    train_experiment("smoke", named, Path("out"), ["line-of-sight"])
    shutil.rmtree("first")
    shutil.rmtree("second")
    kept = evaluate_folders(Path("out"), {"episodes": 1, "levels": ["calm"]}) / "config"
    boat = load_boat(kept / "boats" / "extended_boat.yaml")
    assert (boat.name, boat.mass) == ("second", 51.0)
    assert load_course(kept / "courses" / "camogli.yaml") == load_course("camogli")

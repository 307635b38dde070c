"""No verb writes over a file that it reads, or into a dataset."""

import hashlib
import shutil
from pathlib import Path

import pytest

from swamp_rl.unfinished import locked
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture


@pytest.fixture
def dataset(call: Call) -> dict[str, str]:
    """The files of a dataset `runs` and their SHA-256."""
    assert call("record-scripted", "--out", "runs", "--count", 1)[0] == 0
    return sums()


def sums() -> dict[str, str]:
    files = (path for path in Path("runs").rglob("*") if path.is_file())
    return {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.mark.parametrize(
    "words",
    [
        "diagnose runs --out runs/diagnosis",
        "fleet runs --out runs/deeper/fleet",
        "identify boat runs --boat swamp --out runs/swamp.yaml",
        "runs export runs --to csv --out runs/csv",
        "runs show runs --out runs/tracks.png",
        "demo runs --html runs/page.html",
        "simulate --commands runs/run-001.parquet --out runs/simulated.csv",
        "boat new skiff --kind azimuth --length 4 --breadth 1 --mass 300 --thrust 400 --out runs/skiff.yaml",
        "vehicle --seconds 1 --log runs/vehicle.log",
        "record-scripted --count 1 --out linked/more",
    ],
)
def test_nothing_is_written_into_a_dataset(call: Call, dataset: dict[str, str], words: str) -> None:
    Path("linked").symlink_to("runs")
    assert_complains(call(*words.split()), "lies in the dataset", "name a place outside it")
    assert sums() == dataset


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("hold --out here.html", "here.html: a folder is written here, and .html ends the name of a file"),
        ("mission survey --out charge.PNG", "charge.PNG: a folder is written here"),
        ("capability swamp --out polar.png", "polar.png: a folder is written here"),
        ("record-scripted --count 1 --out runs.csv", "runs.csv: a folder is written here"),
        ("sweep reservoir_grid --out sweep.md", "sweep.md: a folder is written here"),
        ("trial straight --throttle 0.5 --out speed.json", "speed.json: a folder is written here"),
        ("run smoke --out results.yaml", "results.yaml: a folder is written here"),
        ("bench --out speed.txt", "--out speed.txt: end the name in .json"),
    ],
)
def test_an_output_is_what_its_suffix_says(call: Call, words: str, message: str) -> None:
    assert_complains(call(*words.split()), message)
    assert not list(Path().iterdir())


@pytest.mark.parametrize("words", [("--out=~/sea",), ("--out", "~/sea"), ("--set=name=x", "--out=~/sea=1")])
def test_the_home_folder_is_written_to_and_no_folder_named_tilde_is_made(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    home = tmp_path / "home"
    home.mkdir()
    (home / "boat.yaml").write_text("extends: swamp\nname: boat\n")
    asked = ("train", "smoke", "--only", "line-of-sight", "--set", "boat=~/boat.yaml")
    assert call(*asked, *words)[0] == 0
    assert [path.name for path in tmp_path.iterdir()] == ["home"]
    assert (home / words[-1].rpartition("~/")[2] / "pilots").is_dir()


def test_a_model_below_the_home_folder_is_looked_for_there(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert f"{tmp_path}/none.onnx: No such file" in "".join(map(str, call("evaluate", "onnx:~/none.onnx")))


def test_a_file_that_is_read_is_not_replaced(call: Call, dataset: dict[str, str]) -> None:
    Path("apart").mkdir()
    Path("apart/run.parquet").write_bytes(Path("runs/run-001.parquet").read_bytes())
    Path("apart/same.parquet").hardlink_to("apart/run.parquet")
    before = Path("apart/run.parquet").read_bytes()
    for out in ("apart/run.parquet", "apart/../apart/run.parquet", "apart/same.parquet"):
        result = call("simulate", "--commands", "apart/run.parquet", "--out", out)
        assert_complains(result, out, "already exists and is read by this command", "name another file")
    assert Path("apart/run.parquet").read_bytes() == before


@pytest.mark.parametrize(
    "words",
    [
        "simulate --commands runs/run-001.parquet --out mine.csv",
        "simulate --commands runs/run-001.parquet --out mine.csv --window 2",
        "demo runs --html mine.html",
        "demo runs --save mine.rrd",
        "demo runs --video mine.gif",
        "runs show runs --out mine.png",
        "vehicle --seconds 1 --log mine.log",
        "export reservoir --out mine.onnx",
        "bench --out mine.json",
    ],
)
def test_a_file_that_is_there_is_not_replaced(call: Call, dataset: dict[str, str], words: str) -> None:
    name = next(word for word in words.split() if word.startswith("mine."))
    Path(name).write_text("important")
    assert_complains(call(*words.split()), f"{name}: already exists; name another place, or remove it")
    assert Path(name).read_text() == "important"


def test_tracks_are_drawn_anew_for_the_same_runs_and_not_over_those_of_others_of_the_name(
    call: Call, dataset: dict[str, str]
) -> None:
    Path("other").mkdir()
    shutil.copytree("runs", "other/runs")
    for _ in range(2):
        assert call("runs", "show", "runs")[0] == 0
    drawn = Path("results/runs-tracks.png").read_bytes()
    result = call("runs", "show", "other/runs")
    assert_complains(
        result, "--out results/runs-tracks.png: already exists; name another place, or remove it"
    )
    assert Path("results/runs-tracks.png").read_bytes() == drawn
    assert call("runs", "show", "other/runs", "--out", "other.png")[0] == 0


def test_where_tracks_cannot_be_written_another_place_is_asked_for(
    call: Call, dataset: dict[str, str]
) -> None:
    Path("results").write_text("")
    assert_complains(call("runs", "show", "runs"), "results", "name another place with --out")


def test_beside_a_dataset_and_in_its_folder_of_analyses_is_allowed(
    call: Call, dataset: dict[str, str]
) -> None:
    for out in ("simulated.csv", "runs/analysis/simulated.csv"):
        assert call("simulate", "--commands", "runs/run-001.parquet", "--out", out)[0] == 0
    assert call("runs", "check", "runs")[0] == 0


@pytest.mark.parametrize(
    "words",
    [
        "sweep reservoir_grid --out made/out",
        "identify boat runs --boat swamp --out made/out",
        "run smoke --out made/out",
        "fleet runs --out made/out",
    ],
)
def test_a_second_command_on_an_output_is_refused_in_one_line(call: Call, words: str) -> None:
    Path("runs").mkdir()
    with locked(Path("made/out").absolute()):
        assert_complains(call(*words.split()), "made/out: another command is at work on it")
    assert list(Path().rglob("*")) == [Path("runs")]

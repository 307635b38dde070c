"""`swamp-rl demo`: which runs it shows, what it says, and where its server listens."""

import json
import shutil
import signal
import socket
from pathlib import Path

import psutil
import pytest
from swamp_rl.experiments.artifacts import demo_runs, flown
from swamp_rl.experiments.artifacts.demo_runs import read_shown

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.files import shipped_folders
from swamp_rl.pilots import arguments
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.pilots.made_for import made_for
from swamp_rl.pilots.store import save_pilot
from swamp_rl.runs import Run, RunMeta, append_run, create_dataset
from tests.support.command_line import Call, assert_complains
from tests.support.demo import dataset, started
from tests.support.patience import PATIENCE
from tests.support.runs import circling, described

pytestmark = pytest.mark.slow


@pytest.fixture
def results(tmp_path: Path) -> Path:
    """A results folder: two runs of people, two of a pilot, a race of one of each."""
    folder = tmp_path / "camogli"
    dataset(folder / "data", "human", ["run-1", "run-2"])
    dataset(folder / "driven" / "reservoir", "learned", ["reservoir-0", "reservoir-1"])
    entries = {"race": {"runs": {"human": "run-2", "reservoir": "reservoir-1"}}, "data": {"source": "human"}}
    (folder / "results.json").write_text(json.dumps(entries))
    return folder


def labels(sources: list[Path], *patterns: str) -> list[str]:
    return [f"{item.group}/{item.name}" for item in read_shown(sources, list(patterns), "gate").shown]


def test_a_dataset_is_shown_whole_under_the_name_of_its_source(tmp_path: Path) -> None:
    folder = dataset(tmp_path / "a", "scripted", ["x", "y"])
    assert labels([folder]) == ["scripted/x", "scripted/y"]
    assert labels([folder / "y.parquet"]) == ["scripted/y"]


def test_results_show_their_race_and_any_other_run_that_is_asked_for(results: Path) -> None:
    assert labels([results]) == ["human/run-2", "reservoir/reservoir-1"]
    assert len(labels([results], "*")) == 4
    assert labels([results], "human/*", "*-0") == ["human/run-1", "human/run-2", "reservoir/reservoir-0"]


def test_drivers_of_one_name_are_told_apart_by_their_dataset_in_colours_of_their_own(tmp_path: Path) -> None:
    folders = [dataset(tmp_path / name, "human", ["x"]) for name in ("a", "b")]
    assert labels(folders) == ["human a/x", "human b/x"]
    fleets = read_shown(folders, [], "gate").fleets
    assert len({fleet.colour for fleet in fleets}) == 2


def test_drivers_of_one_name_are_told_apart_by_their_boats_where_these_differ(tmp_path: Path) -> None:
    boats = {"a": "swamp", "b": "swamp-light"}
    folders = [dataset(tmp_path / name, "scripted", ["x"], vehicle=boat) for name, boat in boats.items()]
    assert labels(folders) == ["scripted swamp/x", "scripted swamp-light/x"]


def test_a_run_is_shown_under_who_had_the_helm_and_the_persons_nickname(tmp_path: Path) -> None:
    create_dataset(tmp_path / "a", described(source="human"))
    for name, helm in (("x", "person"), ("y", "pilot"), ("z", "both")):
        meta = RunMeta.model_validate({"helm": helm, "pilot": "reservoir", "nickname": "Ada"})
        append_run(tmp_path / "a", Run(name, circling(), meta))
    assert labels([tmp_path / "a"]) == ["human/x", "reservoir/y", "human and reservoir/z"]
    scene = read_shown([tmp_path / "a"], ["x"], "gate")
    assert scene.called(scene.shown[0]) == "human Ada"


def test_what_cannot_be_shown_is_said(results: Path, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"no run fits --runs zebra.*human/run-1"):
        labels([results], "zebra")
    with pytest.raises(UserError, match="no such file or folder"):
        labels([tmp_path / "nowhere"])
    elsewhere = dataset(tmp_path / "pond", "human", ["x"], course=None)
    with pytest.raises(UserError, match="different courses"):
        labels([results, elsewhere])


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("{}", "lacks race.runs or data.source"),
        ('{"race": null, "data": {"source": "human"}}', "lacks race.runs or data.source"),
        ("[1, 2]", "holds no JSON object"),
    ],
)
def test_damaged_results_are_reported_without_the_words_of_python(
    results: Path, text: str, fault: str
) -> None:
    (results / "results.json").write_text(text)
    with pytest.raises(UserError) as refused:
        labels([results])
    assert str(refused.value) == f"{results / 'results.json'}: {fault}; make the results again"


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["--web", "--port", "TAKEN"], "already in use; name another, or none for any free one"),
        ([], "no display to open a window on; add --web"),
        (["--save", "demo.txt"], "end the name in .rrd"),
        (["--video", "demo.avi"], "end the name in .mp4 or .gif"),
        (["--html", "demo"], "end the name in .html"),
        (["--video", "demo.mp4", "--speed", "0"], "--speed 0: give a number above 0"),
        (["--video", "demo.gif", "--speed", "nan"], "--speed nan: give a number above 0"),
        (["--html", "a.html", "--video", "a.gif", "--speed", "1e-9"], "--speed 1e-09: would give"),
        (["--web", "--port", "99999"], "--port"),
    ],
)
def test_what_is_asked_wrongly_is_one_line(
    results: Path, call: Call, monkeypatch: pytest.MonkeyPatch, words: list[str], part: str
) -> None:
    for display in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(display, raising=False)
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        taken = str(other.getsockname()[1])
        assert_complains(call("demo", results, *[taken if one == "TAKEN" else one for one in words]), part)
    if not words:  # a missing source is reported before a missing display
        assert_complains(call("demo", "nowhere"), "nowhere: no such file or folder")


@pytest.mark.parametrize(
    ("sources", "part"),
    [
        (
            ["nowhere"],
            "nowhere: no such file or folder; name a dataset",
        ),
        (["reservoir-alone"], "did you mean 'reservoir'? known here: line-of-sight"),
        (["sb3:missing.zip"], "missing.zip: No such file"),
        (["onnx:missing.onnx"], "missing.onnx: No such file"),
        (["nothing.like.it:Pilot"], "nothing.like.it:Pilot: cannot be imported"),
        (["pond", "line-of-sight"], "the runs have no course"),
        (
            ["tables"],
            "tables: has no dataset.yaml to tell the boat of its runs; write vehicle: NAME into one",
        ),
        (["boat.yaml"], "boat.yaml: is a boat file; name a dataset"),
        (["other"], "was made for boat launch (5 m, thrusters azimuth jet), it cannot drive swamp (1.24 m"),
        (["other"], "name a pilot of swamp, or runs of boat launch"),
        (["damaged"], "pilot.json: was changed since it was written"),
        (["pond", "--html", "file/a.html"], "a folder is needed there"),
    ],
)
def test_a_source_that_cannot_be_shown_is_one_line_and_leaves_nothing(
    tmp_path: Path, call: Call, sources: list[str], part: str
) -> None:
    dataset(tmp_path / "pond", "human", ["x"], course=None)
    (tmp_path / "boat.yaml").write_text("extends: swamp\nmass: 50.0\n")
    of_launch = {"boat": "launch", "length": 5.0, "thrusters": {"jet": "azimuth"}}
    made = made_for(load_boat("swamp"), "camogli", 0.1).model_copy(update=of_launch)
    for name in ("other", "damaged"):
        save_pilot(LineOfSightPilot(), tmp_path / name, made=made)
    description = tmp_path / "damaged" / "pilot.json"
    description.write_text(description.read_text().replace("launch", "laundry"))
    (tmp_path / "file").write_text("")
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables" / "one.csv").write_text("time\n")
    assert_complains(call("demo", *sources, *([] if "--html" in sources else ["--html", "a.html"])), part)
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {"pond", "boat.yaml", "other", "damaged", "file", "tables"}


def test_a_damaged_pilot_of_the_package_asks_for_a_new_installation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copy = tmp_path / "pilots" / "reservoir"
    shutil.copytree(shipped_folders("pilots")["reservoir"], copy)
    (copy / "weights.safetensors").write_bytes(b"")
    runs = shipped_folders("runs")
    for module in (demo_runs, flown, arguments):
        shipped = {"pilots": {"reservoir": copy}, "runs": runs}
        monkeypatch.setattr(module, "shipped_folders", shipped.__getitem__)
    with pytest.raises(UserError, match=r"is damaged.*install swamp-rl again"):
        read_shown([], [], None)


@pytest.mark.timed
@pytest.mark.parametrize("result", [signal.SIGTERM, signal.SIGHUP], ids=["terminated", "terminal closed"])
def test_the_web_viewer_listens_on_this_machine_only_and_ends_on_request(results: Path, result: int) -> None:
    process = started("demo", results, "--web")
    assert process.stdout is not None
    try:
        assert "1 human, 1 reservoir" in process.stdout.readline()
        address = process.stdout.readline()
        own = psutil.Process(process.pid)
        children = own.children(recursive=True)
        listening = [
            found.laddr
            for each in [own, *children]
            for found in each.net_connections(kind="inet")
            if found.status == psutil.CONN_LISTEN
        ]
        assert {place.ip for place in listening} == {"127.0.0.1"}
        assert len(listening) == 2
        assert any(address.startswith(f"http://127.0.0.1:{place.port}/?url=") for place in listening)
    finally:
        process.send_signal(result)
        process.send_signal(result)
        _, reported = process.communicate(timeout=PATIENCE)
    assert process.returncode == 128 + result
    assert reported.count("\n") == 1 and "ended in order" in reported
    gone, left = psutil.wait_procs(children, timeout=PATIENCE)
    assert left == [] and len(gone) == len(children)

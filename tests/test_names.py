"""Whatever a name in someone else's file says, nothing outside the folder that was named is touched."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from mcap.writer import Writer
from swamp_rl.experiments.artifacts.result_folders import Result
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.sweep.schema import load_sweep

from swamp_rl.errors import UserError
from swamp_rl.files import find_config, read_yaml
from swamp_rl.names import LONGEST, file_in, plain_name
from swamp_rl.runs import Run, append_run, create_dataset, inspect_dataset, read_dataset, write_run
from swamp_rl.runs.export_dataset import export_runs
from swamp_rl.runs.import_dataset import import_runs
from tests.support.driving import recordings
from tests.support.hostile_names import EXAMPLES, HOSTILE, SECRET, around, message_of, victims, written
from tests.support.runs import circling, described


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dataset that nothing is wrong with."""
    folder = tmp_path_factory.mktemp("good") / "runs"
    create_dataset(folder, described(vehicle="swamp-light", mass=48.0, draught=0.115))
    append_run(folder, Run("one", circling()), "csv")
    return folder


class Place:
    """A folder `here` to work in, whose dataset `runs` may be tampered with, and what lies around it."""

    def __init__(self, root: Path, good: Path) -> None:
        self.root, self.here = root, root / "here"
        self.runs = self.here / "runs"
        shutil.copytree(good, self.runs)
        victims(root)
        self.before = self.outside()

    def outside(self) -> dict[str, bytes]:
        """Every file around `here`, by path."""
        return around(self.here)

    def tamper(self, **changes: Any) -> None:
        written(self.runs / "dataset.yaml", read_yaml(self.runs / "dataset.yaml") | changes)

    def used(self) -> Iterator[str]:
        """Have the dataset read, exported to all formats and imported; the message of each."""
        for number, to in enumerate(("csv", "parquet", "mcap", "minari", "lerobot")):
            yield message_of(export_runs, self.runs, to, self.here / f"out{number}")
        yield message_of(import_runs, [self.runs], "csv", self.here / "imported")
        yield message_of(read_dataset, self.runs)

    def is_confined(self) -> bool:
        """Whether all around is as it was, and none of it has come into `here`."""
        leaked = (path for path in self.here.rglob("*") if path.is_file() and not path.is_symlink())
        return self.outside() == self.before and not any(b"secret" in path.read_bytes() for path in leaked)


@pytest.fixture(scope="module")
def places(tmp_path_factory: pytest.TempPathFactory, good: Path) -> Any:
    return lambda: Place(tmp_path_factory.mktemp("place"), good)


@given(name=HOSTILE | st.text(max_size=8))
@example(name="x" * (LONGEST - 5) + ".yaml")
def test_a_plain_name_stays_in_its_folder_and_any_other_is_refused(
    tmp_path_factory: pytest.TempPathFactory, name: str
) -> None:
    folder = tmp_path_factory.getbasetemp().resolve()
    try:
        path = folder / plain_name(name, ("", ".yaml"))
    except ValueError:
        return
    assert path.parent == folder and path.resolve() == path and path != folder
    path.touch()
    path.unlink()


def test_a_link_is_no_file_of_its_folder(tmp_path: Path) -> None:
    (tmp_path / "boat.yaml").symlink_to(tmp_path / "other.yaml")
    with pytest.raises(UserError, match="is a link"):
        file_in(tmp_path, "boat.yaml", (".yaml",))


@pytest.mark.parametrize("key", ["vehicle", "course", "copies", "file"])
@EXAMPLES
@given(name=HOSTILE)
@example(name="../victim/boat.yaml")
@example(name="../../victim/boat.csv")
def test_no_name_in_a_dataset_reaches_out_of_it(places: Any, key: str, name: str) -> None:
    place = places()
    name = name.replace("{root}", str(place.root))
    data = read_yaml(place.runs / "dataset.yaml")
    changes = {
        "vehicle": {"vehicle": name},
        "course": {"course": name},
        "copies": {"copies": {name: "0" * 64}, "vehicle": name.removesuffix(".yaml")},
        "file": {"runs": [{**data["runs"][0], "file": name}]},
    }
    place.tamper(**changes[key])
    refused = [line for line in place.used() if line]
    assert place.is_confined()
    if "/" in name:
        assert len(refused) == 7 and not list(place.here.glob("out*"))


@EXAMPLES
@given(name=HOSTILE)
@example(name="../../victim/boat.yaml")
def test_no_boat_of_a_dataset_extends_a_file_elsewhere(places: Any, name: str) -> None:
    place = places()
    written(place.runs / "own.yaml", {"extends": name.replace("{root}", str(place.root)), "name": "own"})
    place.tamper(vehicle="own.yaml", copies={})
    assert all(place.used())
    assert place.is_confined()


@pytest.mark.parametrize(
    "name", ["one.csv", "swamp.yaml", "swamp-light.yaml", "camogli.course.yaml", "dataset.yaml"]
)
def test_links_in_a_dataset_are_refused(places: Any, name: str) -> None:
    place = places()
    target = place.root / "victim" / "target"
    shutil.move(place.runs / name, target)
    (place.runs / name).symlink_to(target)
    place.before = place.outside()
    assert all("link" in line for line in place.used())
    assert place.is_confined()


@EXAMPLES
@given(vehicle=HOSTILE, course=HOSTILE, copy=HOSTILE, run=HOSTILE)
@example(vehicle="swamp", course="camogli", copy="../victim/boat.yaml", run="one")
@example(vehicle="swamp", course="camogli", copy="swamp.yaml", run="../../victim/boat")
def test_no_name_in_an_mcap_file_reaches_out(
    places: Any, vehicle: str, course: str, copy: str, run: str
) -> None:
    place = places()
    meta = described(vehicle=vehicle, course=course).model_dump(exclude_none=True, exclude={"runs"})
    record = {
        "run": json.dumps({"file": run}),
        "dataset": json.dumps(meta),
        "copies": json.dumps({copy: SECRET}),
    }
    path = place.here / "one.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        writer.add_metadata("swamp_rl", record)
        kind = writer.register_schema("Run", "jsonschema", b"{}")
        channel = writer.register_channel("/run", "json", kind)
        for number in range(20):
            row = {"time": number / 10, "north": 0.0, "east": 0.0, "heading": 0.0}
            writer.add_message(channel, number, json.dumps(row).encode(), number)
        writer.finish()
    message_of(import_runs, [path], "mcap", place.here / "imported")
    assert place.outside() == place.before


@EXAMPLES
@given(name=HOSTILE)
@example(name="../../victim/boat")
def test_a_run_is_written_under_a_plain_name_only(places: Any, name: str) -> None:
    place = places()
    name = name.replace("{root}", str(place.root))
    complaint = message_of(append_run, place.runs, Run(name, circling()))
    assert place.outside() == place.before
    assert complaint or {path.name for path in place.runs.iterdir()} >= {f"{name}.parquet"}
    assert complaint or "/" not in name


@EXAMPLES
@given(name=HOSTILE)
@example(name="../../victim/boat")
def test_names_in_an_experiment_and_a_sweep_are_those_of_folders_in_the_results(
    tmp_path_factory: pytest.TempPathFactory, name: str
) -> None:
    folder = tmp_path_factory.mktemp("yaml")
    experiment = read_yaml(find_config("experiments", "smoke"))
    pilots = {name: next(iter(experiment["pilots"].values()))}
    written(folder / "pilots.yaml", experiment | {"pilots": pilots, "targets": {}})
    written(folder / "name.yaml", experiment | {"name": name})
    written(folder / "sweep.yaml", read_yaml(find_config("sweeps", "reservoir_grid")) | {"name": name})
    for load, file in ((load_experiment, "pilots"), (load_experiment, "name"), (load_sweep, "sweep")):
        complaint = message_of(load, folder / f"{file}.yaml")
        assert complaint or (Path(name).name == name and not name.startswith("."))


@given(level=HOSTILE)
def test_no_level_in_results_names_a_file_elsewhere(
    tmp_path_factory: pytest.TempPathFactory, level: str
) -> None:
    folder = tmp_path_factory.mktemp("results") / "results"
    (folder / "config" / "disturbances").mkdir(parents=True)
    (folder.parent / "boat.yaml").write_text(SECRET)
    result = Result(folder, {}, {("pilot", level): None}, {}, {})  # type: ignore[dict-item]
    complaint = message_of(result.setting)
    assert complaint or "/" not in level


@EXAMPLES
@given(name=HOSTILE)
def test_a_recorder_gives_the_runs_of_its_dataset_and_no_others(
    tmp_path_factory: pytest.TempPathFactory, name: str
) -> None:
    folder = tmp_path_factory.mktemp("recorder") / "runs"
    kept = recordings(folder)
    try:
        write_run(folder.parent / "boat.csv", Run("boat", circling()))
        assert message_of(kept.read, name)
    finally:
        kept.close()


def test_a_folder_that_is_only_links_holds_no_runs(tmp_path: Path) -> None:
    write_run(tmp_path / "elsewhere.csv", Run("one", circling()))
    (tmp_path / "day").mkdir()
    (tmp_path / "day" / "one.csv").symlink_to(tmp_path / "elsewhere.csv")
    (fault,) = inspect_dataset(tmp_path / "day", "swamp").faults[:1]
    assert "is a link" in str(fault)

"""A dataset holds all that it needs, wherever it lies; and a plain folder of tables is worked out."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.run_set import read_run_set
from swamp_rl.errors import UserError
from swamp_rl.files import read_yaml, write_yaml
from swamp_rl.runs import (
    Run,
    RunMeta,
    append_run,
    copies,
    create_dataset,
    inspect_dataset,
    read_dataset,
    table,
    write_run,
)
from tests.support.runs import circling, described

HULL = "extends: swamp\nname: mine  # heavier\nmass: {mass} # kg\n"


@pytest.fixture
def boat(tmp_path: Path) -> Path:
    """A boat in two files of its own, the second found from the first by its place."""
    (tmp_path / "boats").mkdir()
    (tmp_path / "boats" / "hull.yaml").write_text(HULL.format(mass=60.0))
    path = tmp_path / "mine.yaml"
    path.write_text("# As she lay at the pier.\nextends: boats/hull.yaml\nname: mine\ndraught: 0.15\n")
    return path


def recorded(folder: Path, boat: str | Path) -> Path:
    create_dataset(folder, described(vehicle=str(boat)))
    append_run(folder, Run("one", circling(), RunMeta(outcome="success", group="monday")))
    return folder


def test_a_dataset_carries_its_boat_with_all_that_it_extends_and_its_course(
    boat: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = recorded(tmp_path / "runs", boat)
    wanted = load_boat(boat)
    for gone in (boat, tmp_path / "boats" / "hull.yaml"):
        gone.unlink()
    moved = Path(shutil.move(folder, tmp_path / "elsewhere"))
    monkeypatch.chdir(moved.parent)
    dataset = read_dataset("elsewhere")
    assert (dataset.meta.vehicle, dataset.meta.course) == ("mine", "camogli")
    assert dataset.boat == wanted
    assert dataset.course is not None and dataset.course.name == "camogli"
    assert dataset.runs[0].meta.group == "monday"
    assert "# As she lay at the pier." in (moved / "mine.yaml").read_text()
    assert set(dataset.meta.copies) == {"mine.yaml", "hull.yaml", "swamp.yaml", "camogli.course.yaml"}


def test_two_datasets_keep_the_versions_of_one_boat_that_they_were_made_with(tmp_path: Path) -> None:
    boat = tmp_path / "mine.yaml"
    for name, mass in (("before", 50.0), ("after", 55.0)):
        boat.write_text(HULL.format(mass=mass))
        recorded(tmp_path / name, boat)
    assert [read_dataset(tmp_path / name).boat.mass for name in ("before", "after")] == [50.0, 55.0]


def test_files_of_one_name_in_a_chain_are_distinguished(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "mine.yaml").write_text(HULL.format(mass=61.0))
    (tmp_path / "mine.yaml").write_text("{extends: deep/mine.yaml, name: mine, draught: 0.15}\n")
    dataset = read_dataset(recorded(tmp_path / "runs", tmp_path / "mine.yaml"))
    assert (dataset.boat.mass, dataset.boat.draught) == (61.0, 0.15)


def test_a_copy_that_was_changed_or_taken_away_is_noticed(tmp_path: Path) -> None:
    folder = recorded(tmp_path / "runs", "swamp-light")
    base = folder / "swamp.yaml"
    text = base.read_text()
    base.write_text(text + "\n")
    with pytest.raises(UserError, match=r"swamp\.yaml: is not the file that these runs were made with"):
        read_dataset(folder)
    base.unlink()
    with pytest.raises(UserError, match=r"swamp\.yaml: no such file, but dataset\.yaml lists it"):
        read_dataset(folder)


def test_a_dataset_of_before_the_copies_still_loads(folder: Path) -> None:
    data = read_yaml(folder / "dataset.yaml")
    for name in data.pop("copies"):
        (folder / name).unlink()
    write_yaml(folder / "dataset.yaml", data)
    dataset = read_dataset(folder)
    assert (dataset.boat, len(dataset.runs)) == (load_boat("swamp"), 2)


def plain(folder: Path, rates: tuple[float, ...] = (10.0, 10.0)) -> Path:
    """Tables alone, the first CSV and the second Parquet, of these sample rates [Hz]."""
    folder.mkdir()
    for number, (rate, kind) in enumerate(zip(rates, ("csv", "parquet"), strict=True)):
        columns = circling()
        columns["time"] = np.arange(len(columns["time"])) / rate
        write_run(folder / f"leg {number}.{kind}", Run("leg", columns))
    return folder


def test_a_plain_folder_is_a_dataset_once_its_boat_is_named(tmp_path: Path) -> None:
    dataset = read_dataset(plain(tmp_path / "day"), "swamp-light")
    boat = load_boat("swamp-light")
    assert [run.name for run in dataset.runs] == ["leg 0", "leg 1"]
    assert (dataset.meta.mass, dataset.meta.draught) == (boat.mass, boat.draught)
    assert (dataset.meta.sample_rate, dataset.meta.source) == (10.0, "measured")
    assert dataset.boat == boat


def test_of_a_plain_folder_what_must_be_known_is_asked_for_by_name(tmp_path: Path) -> None:
    (fault,) = inspect_dataset(plain(tmp_path / "day")).faults
    assert "--boat NAME" in str(fault)
    (fault,) = inspect_dataset(plain(tmp_path / "mixed", (10.0, 5.0)), "swamp").faults
    assert str(fault) == (
        "leg 1.parquet: column time: is sampled at 5 Hz, but leg 0.csv at 10 Hz; resample one of them "
        "(swamp-rl runs import --resample HZ), or keep them in folders of their own"
    )


def test_of_a_log_of_another_program_the_import_is_named(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("time,x,y,psi,left,right\n0,0,0,0,0,0\n0.1,0,0,0,0,0\n")
    named = r"log.csv: column north: is missing; add it .*runs import .* --list"
    with pytest.raises(UserError, match=named):
        read_dataset(tmp_path, "swamp")
    with pytest.raises(UserError, match=named):
        read_run_set(tmp_path, load_boat("swamp"), "swamp")


def test_a_description_of_one_line_is_enough(tmp_path: Path) -> None:
    folder = plain(tmp_path / "day")
    (folder / "dataset.yaml").write_text("vehicle: swamp\n")
    found = inspect_dataset(folder)
    assert not found.faults and len(found.runs) == 2
    assert any("mass 58 kg" in note and "2 runs" in note for note in found.notes)


def test_runs_of_a_plain_folder_have_the_outcome_that_the_course_gives_them(tmp_path: Path) -> None:
    dataset = read_dataset(plain(tmp_path / "day"), "swamp", "camogli")
    assert [run.meta.outcome for run in dataset.runs] == ["incomplete", "incomplete"]


def test_a_file_that_the_disk_refuses_while_it_is_copied_is_one_line(
    boat: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(path: Path, *_: object, **__: object) -> bytes:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(copies, "contents", refused)
    with pytest.raises(UserError, match=r"\.yaml: Permission denied"):
        create_dataset(tmp_path / "runs", described(vehicle=str(boat)))
    assert not (tmp_path / "runs").exists()


def test_a_file_that_may_not_be_read_is_not_to_be_copied_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(path: Path, *_: object) -> bytes:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(table, "contents", refused)
    faults = [str(fault) for fault in inspect_dataset(plain(tmp_path / "day"), "swamp").faults]
    assert all(one.endswith("cannot be read (Permission denied); change its permissions") for one in faults)
    assert faults


@pytest.mark.parametrize(("rows", "verb"), [("time\n0\n", "import"), ("time,north\n0,x\n", "check")])
def test_a_command_in_a_hint_can_be_typed_as_it_stands(tmp_path: Path, rows: str, verb: str) -> None:
    folder = plain(tmp_path / "Messfahrt am See")
    next(folder.glob("*.csv")).write_text(rows)
    if verb == "check":
        (folder / "dataset.yaml").write_text("vehicle: swamp\n")
    with pytest.raises(UserError) as error:
        read_dataset(folder, "swamp")
    assert f"swamp-rl runs {verb} '{folder}'" in str(error.value)

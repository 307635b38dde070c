"""`dataset.yaml` is strict: what is wrong with it is named by key, with what is allowed."""

from pathlib import Path

import pytest

from swamp_rl.errors import UserError
from swamp_rl.runs import (
    Run,
    append_run,
    check_dataset,
    create_dataset,
    inspect_dataset,
    read_dataset,
    read_run,
)
from tests.support.runs import circling, described

WRONG = {
    "mass: 58.0": {
        "mass: -1.0": "mass: must be greater than 0, not -1.0",
        "mass: .nan": "mass: must be",
        "mass: 58000.0": "dataset.yaml: mass: 58000 kg is implausible: mass / (water_density length",
        "mass: heavy": "mass: must be a number, not 'heavy'",
        "mas: 58.0": "mas: unknown key; did you mean 'mass'?",
        "mass: 58.0\nmass: 48.0": "'mass' is given twice",
        "mass: [58.0": "malformed YAML",
    },
    "draught: ": {"draught: 7": "dataset.yaml: draught: 70.14 m is implausible: draught / length"},
    "water_density: ": {"water_density: 9": "dataset.yaml: water_density: 91025 kg/m3 is implausible"},
    "source: simulated": {"source: dreamt": "source: must be 'measured', 'simulated'"},
    "vehicle: swamp": {
        "vehicle: swap": "did you mean 'swamp'?",
        "vehicle: ../swamp.yaml": "vehicle: '../swamp.yaml' must be a plain name",
        "": "vehicle: is missing",
    },
    "course: camogli": {"course: /etc/course.yaml": "course: '/etc/course.yaml' must be a plain name"},
    "swamp.yaml: ": {
        "gone.yaml: ": "gone.yaml: no such file, but dataset.yaml lists it under copies",
        "../swamp.yaml: ": "copies: '../swamp.yaml' must be a plain name",
        "swamp.yaml: 0": "copies.swamp.yaml: must match the pattern",
    },
    "file: one.csv": {
        "file: ../one.csv": "must be the name of a .csv or .parquet file",
        "file: two.csv": "listed twice",
        "name: one": "runs.0.file is missing",
        "file: gone.csv": "is listed in dataset.yaml but is not here",
    },
    "seed: 1\n": {"seed: -1\n": "runs.0.seed: must be at least 0"},
}


@pytest.mark.parametrize(("good", "wrong"), [(good, wrong) for good in WRONG for wrong in WRONG[good]])
def test_a_mistake_in_the_description_is_named(folder: Path, good: str, wrong: str) -> None:
    path = folder / "dataset.yaml"
    text = path.read_text()
    assert good in text
    path.write_text(text.replace(good, wrong, 1))
    faults = check_dataset(folder)
    assert any(WRONG[good][wrong] in str(fault) for fault in faults), [str(fault) for fault in faults]
    with pytest.raises(UserError):
        read_dataset(folder)


def test_a_folder_without_a_description_or_without_runs_is_a_fault(tmp_path: Path) -> None:
    assert "is missing" in check_dataset(tmp_path)[0].message
    create_dataset(tmp_path, described())
    assert "lists no runs" in check_dataset(tmp_path)[0].message


def test_a_run_of_a_load_that_its_boat_cannot_have_is_not_written(tmp_path: Path) -> None:
    create_dataset(tmp_path, described(mass=58000.0))
    with pytest.raises(UserError, match=r"dataset\.yaml: mass: 58000 kg is implausible"):
        append_run(tmp_path, Run("one", circling()))
    assert not list(tmp_path.glob("*.parquet"))


def test_a_dataset_that_was_read_keeps_its_boat(folder: Path) -> None:
    dataset = read_dataset(folder)
    boat = dataset.boat
    (folder / "swamp.yaml").write_text("mass: 60.0\n")
    assert dataset.boat is boat


def test_a_folder_of_datasets_is_distinguished_from_one(tmp_path: Path) -> None:
    for name in ("june", "may"):
        create_dataset(tmp_path / name, described())
    (fault,) = check_dataset(tmp_path)
    assert "holds datasets" in fault.message and str(tmp_path / "june") in fault.message


def test_a_folder_that_does_not_exist_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no such folder"):
        check_dataset(tmp_path / "nowhere")


def test_a_log_in_the_place_of_a_dataset_is_reported_how_to_become_one(tmp_path: Path) -> None:
    (tmp_path / "trip.csv").write_text("time\n0\n")
    with pytest.raises(UserError, match=r"trip\.csv: is a file.*swamp-rl runs import"):
        check_dataset(tmp_path / "trip.csv")


def test_a_table_that_is_not_listed_is_a_fault(folder: Path) -> None:
    (folder / "stray.csv").write_text((folder / "one.csv").read_text())
    (fault,) = check_dataset(folder)
    assert (fault.file, "not listed" in fault.message) == ("stray.csv", True)


def test_the_vehicle_may_be_a_boat_file_beside_the_runs(tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text("extends: swamp\nname: own\nmass: 48.0\ndraught: 0.115\n")
    create_dataset(tmp_path, described(vehicle="own.yaml", mass=48.0, draught=0.115))
    append_run(tmp_path, Run("one", circling()))
    assert check_dataset(tmp_path) == []
    assert read_dataset(tmp_path).boat.mass == 48.0


def test_a_lone_table_is_a_run_that_nothing_is_said_of(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "copy.csv").write_bytes((folder / "one.csv").read_bytes())
    assert read_run(tmp_path / "copy.csv").meta.seed is None
    with pytest.raises(UserError, match="no such file"):
        read_run(tmp_path / "nothing.csv")


@pytest.mark.parametrize(
    "name", ["stray\x1b]0;title\x07.csv", "stray\rdone.csv", "stray\nnext.csv", "stray\u202evsc.csv"]
)
def test_what_a_terminal_acts_on_in_a_stray_files_name_is_not_printed(folder: Path, name: str) -> None:
    (folder / name).write_text((folder / "one.csv").read_text())
    (folder / f".part-{name}").write_text("")
    found = inspect_dataset(folder)
    lines = [*map(str, found.faults), *found.notes]
    assert len(lines) == 2 and all("stray" in line and line.isprintable() for line in lines)

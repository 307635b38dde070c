"""MATLAB's files as logs: vectors, matrices, other variables, and files that are refused."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs, read_log
from swamp_rl.logs.listing import listing
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.kind_of_file import kind_of
from tests.support.from_scratch import written
from tests.support.logs import weaving

MAP = ["time=t", "x=place[0]", "y=place[1]", "yaw=psi", "throttle_port=port", "throttle_starboard=stbd"]


def recorded(path: Path, **changed: object) -> Path:
    was = weaving()
    variables = {
        "t": was["time"],
        "place": np.column_stack([was["north"], was["east"]]),
        "psi": was["heading"],
        "port": was["throttle_port"],
        "stbd": was["throttle_starboard"],
        "gains": np.array([3.0, 0.5, 1.0]),
        "note": "calm",
    }
    savemat(path, variables | changed, oned_as="column")
    return path


def imported(path: Path) -> Run:
    about, out = About(boat=str(written(path.parent, "twin"))), path.parent / "out"
    import_logs([path], kind_of([path]), out, about, Wishes(), Reading(mapping_of(MAP)))
    (run,) = read_dataset(out).runs
    return run


def test_vectors_and_columns_of_a_matrix_become_a_run(tmp_path: Path) -> None:
    run, was = imported(recorded(tmp_path / "sea.mat")), weaving()
    for name in ("north", "east", "heading", "throttle_port", "throttle_starboard"):
        assert run.columns[name] == pytest.approx(was[name], abs=1e-9), name


def test_a_vector_that_the_recorder_left_one_longer_is_cut(tmp_path: Path) -> None:
    longer = np.append(weaving()["heading"], 9.0)
    run = imported(recorded(tmp_path / "sea.mat", psi=longer))
    assert run.columns["heading"] == pytest.approx(weaving()["heading"], abs=1e-9)


def test_a_row_vector_and_a_matrix_of_rows_are_columns_too(tmp_path: Path) -> None:
    was = weaving()
    rows = {"place": np.stack([was["north"], was["east"]]), "t": was["time"][None]}
    run = imported(recorded(tmp_path / "sea.mat", **rows))
    assert run.columns["east"] == pytest.approx(was["east"], abs=1e-9)


def test_variables_of_another_length_or_type_are_listed_as_not_read(tmp_path: Path) -> None:
    path = recorded(tmp_path / "sea.mat")
    lines = list(listing(read_log(path, "matlab")))
    assert lines[0] == "sea (sea.mat), table: 301 rows"
    assert lines[-1] == "not read: gains, note (of another length or type)"
    assert any(line.startswith("  place[1]: ") for line in lines)


def test_files_that_cannot_be_read_are_refused_in_one_line(tmp_path: Path) -> None:
    whole = recorded(tmp_path / "sea.mat").read_bytes()
    newer = whole[:124] + b"\x00\x02IM" + b"\x89HDF"
    savemat(tmp_path / "words.mat", {"note": "calm"})
    refused = {
        "version 7.3": newer,
        "not a complete MATLAB file": whole[:3000],
        "no vectors": (tmp_path / "words.mat").read_bytes(),
    }
    for words, content in refused.items():
        path = tmp_path / "refused.mat"
        path.write_bytes(content)
        with pytest.raises(UserError) as error:
            read_log(path, "matlab")
        assert words in str(error.value) and "\n" not in str(error.value)


def test_a_mark_of_a_missing_value_is_reported(tmp_path: Path) -> None:
    angle = np.degrees(np.mod(weaving()["heading"], 2.0 * np.pi))
    angle[40] = -999.0
    with pytest.raises(UserError, match="row 41, column heading: is missing, marked by -999"):
        about, wishes = About(boat=str(written(tmp_path, "twin"))), Wishes(units={"yaw": "deg"})
        log = recorded(tmp_path / "log.mat", psi=angle)
        import_logs([log], "matlab", tmp_path / "out", about, wishes, Reading(mapping_of(MAP)))

"""Files are found by name, read with clear errors, and written whole or not at all."""

import errno
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict, Field

from swamp_rl.errors import UserError
from swamp_rl.explain import likest
from swamp_rl.files import find_config, new_files_beside, read_yaml, validated, write_beside, write_yaml
from swamp_rl.replacement import WRITTEN
from swamp_rl.unfinished import folder_beside

# PyYAML folds the rare line ends of Unicode when it reads them.
TEXT = st.text(st.characters(exclude_categories=("Cs",), exclude_characters="\x85\u2028\u2029"))
SCALARS = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | TEXT
VALUES = st.recursive(SCALARS, lambda inner: st.lists(inner) | st.dictionaries(TEXT, inner), max_leaves=8)


class Motor(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)

    power: float = Field(1.0, gt=0.0)
    fuel: str = "none"


class Ship(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)

    name: str
    motors: list[Motor] = []
    spare: dict[str, Motor] | None = None


def test_a_file_appears_only_once_it_is_whole(tmp_path: Path) -> None:
    target = tmp_path / "deep" / "file.txt"
    with write_beside(target) as part:
        part.write_text("whole")
        assert part.parent == target.parent
        assert part.suffix == ".txt"
        assert not target.exists()
    assert [path.name for path in target.parent.iterdir()] == ["file.txt"]
    assert target.read_text() == "whole"


@pytest.mark.parametrize("stop", [RuntimeError, KeyboardInterrupt, SystemExit])
def test_an_older_file_survives_a_writer_that_is_stopped(tmp_path: Path, stop: type[BaseException]) -> None:
    target = tmp_path / "file.txt"
    target.write_text("old")
    with pytest.raises(stop), write_beside(target) as part:
        part.write_text("half")
        raise stop
    assert [path.name for path in tmp_path.iterdir()] == ["file.txt"]
    assert target.read_text() == "old"


def test_of_new_files_the_last_one_is_the_last_to_appear(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page, result = tmp_path / "made.html", tmp_path / "made.yaml"
    there = []

    def seen(part: Path, path: Path) -> None:
        there.append(visible(tmp_path))
        os.rename(part, path)

    monkeypatch.setattr(os, "replace", seen)
    with new_files_beside(page, result) as parts:
        for part in parts:
            part.write_text("whole")
    assert there == [[], ["made.html"]]
    assert sorted(os.listdir(tmp_path)) == ["made.html", "made.yaml"]


@pytest.mark.parametrize("stopped_at", [0, 1])
def test_new_files_whose_renaming_is_interrupted_are_not_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stopped_at: int
) -> None:
    calls = iter(range(2))

    def stops(part: Path, path: Path) -> None:
        os.rename(part, path)
        if next(calls) == stopped_at:
            raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", stops)
    with pytest.raises(KeyboardInterrupt), new_files_beside(tmp_path / "a", tmp_path / "b") as parts:
        for part in parts:
            part.write_text("whole")
    assert os.listdir(tmp_path) == []


def test_new_files_replace_nothing_that_appeared_meanwhile(tmp_path: Path) -> None:
    with (
        pytest.raises(UserError, match="b: already exists"),
        new_files_beside(tmp_path / "a", tmp_path / "b") as parts,
    ):
        for part in parts:
            part.write_text("ours")
        (tmp_path / "b").write_text("theirs")
    assert os.listdir(tmp_path) == ["b"] and (tmp_path / "b").read_text() == "theirs"


def visible(folder: Path) -> list[str]:
    return sorted(name for name in os.listdir(folder) if not name.startswith("."))


def test_a_full_disk_names_the_file_that_was_asked_for(tmp_path: Path) -> None:
    target = tmp_path / "file.txt"
    with pytest.raises(UserError) as caught, write_beside(target) as part:
        part.write_text("half")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(part))
    assert str(caught.value) == f"{target}: No space left on device; free some room"
    assert list(tmp_path.iterdir()) == []


def test_a_path_through_a_file_is_a_clear_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with (
        pytest.raises(UserError, match="a folder is needed there"),
        write_beside(tmp_path / "file" / "inside"),
    ):
        pass
    with pytest.raises(UserError, match="is a file"), folder_beside(tmp_path / "file"):
        pass


def test_a_folder_appears_only_once_it_is_whole(tmp_path: Path) -> None:
    with folder_beside(tmp_path / "results") as part:
        (part / "inner").mkdir()
        (part / "inner" / "file.txt").write_text("whole")
        assert not (tmp_path / "results").exists()
    assert (tmp_path / "results" / "inner" / "file.txt").read_text() == "whole"
    assert [path.name for path in tmp_path.iterdir()] == ["results"]


def test_an_older_result_is_replaced_whole(tmp_path: Path) -> None:
    for text in ("old", "new"):
        with folder_beside(tmp_path / "results", replaces="results.json") as part:
            (part / "results.json").write_text(text)
            (part / f"{text}.txt").write_text("")
    assert {path.name for path in (tmp_path / "results").iterdir()} == {WRITTEN, "results.json", "new.txt"}
    assert [path.name for path in tmp_path.iterdir()] == ["results"]


def test_an_older_result_survives_a_writer_that_is_stopped(tmp_path: Path) -> None:
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "results.json").write_text("old")
    with pytest.raises(KeyboardInterrupt), folder_beside(tmp_path / "results", replaces="results.json"):
        raise KeyboardInterrupt
    assert (tmp_path / "results" / "results.json").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["results"]


def test_a_folder_of_something_else_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "letter.txt").write_text("dear")
    with (
        pytest.raises(UserError, match="not an earlier result"),
        folder_beside(tmp_path / "home", replaces="results.json"),
    ):
        pytest.fail("no work may be done for a folder that cannot be written")
    assert (tmp_path / "home" / "letter.txt").read_text() == "dear"


@given(st.dictionaries(TEXT, VALUES))
def test_yaml_comes_back_as_it_was_written_or_is_not_written(
    tmp_path_factory: pytest.TempPathFactory, data: dict
) -> None:
    path = tmp_path_factory.mktemp("yaml") / "file.yaml"
    try:
        write_yaml(path, data)
    except UserError as error:
        assert "does not print" in str(error) and list(path.parent.iterdir()) == []
        assert not repr(data).isascii() or "\\x" in repr(data)
    else:
        assert read_yaml(path) == data


def test_a_number_with_an_exponent_is_a_number(tmp_path: Path) -> None:
    (tmp_path / "file.yaml").write_text("rate: 3e-4\nbig: 2.E+3\nname: 1e5x\n")
    assert read_yaml(tmp_path / "file.yaml") == {"rate": 3e-4, "big": 2000.0, "name": "1e5x"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: {b: 0,5, c: 1}", "line 1, column 10: malformed YAML: 5 is no key; a comma ends a value: write"),
        ("a: 1\nb: 2\na: 3\n", "line 3, column 1: malformed YAML: key 'a' is given twice"),
        ("a: [1\n", "malformed YAML"),
        ("- 1\n", "holds a list; it must be a mapping"),
        ("", "holds nothing"),
        ("1: a\n", "key 1 is not text"),
        ("a: !!python/object/apply:os.getcwd []\n", "malformed YAML"),
        ("? [1, 2]\n: 3\n", "malformed YAML"),
        ("a: " + "[" * 100_000, "nested more than 100 deep"),
    ],
)
def test_yaml_that_is_no_mapping_of_keys_is_refused_with_its_place(
    tmp_path: Path, text: str, message: str
) -> None:
    (tmp_path / "file.yaml").write_text(text)
    with pytest.raises(UserError) as caught:
        read_yaml(tmp_path / "file.yaml")
    assert message in str(caught.value)
    assert str(tmp_path / "file.yaml") in str(caught.value)
    assert "\n" not in str(caught.value)


@given(st.binary())
def test_any_bytes_are_either_a_mapping_or_one_line_of_complaint(
    tmp_path_factory: pytest.TempPathFactory, data: bytes
) -> None:
    path = tmp_path_factory.mktemp("yaml") / "file.yaml"
    path.write_bytes(data)
    try:
        assert isinstance(read_yaml(path), dict)
    except UserError as error:
        assert len(str(error).splitlines()) == 1


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("pilots:\n\tmine: 1\n", 2, "indent with spaces, not tabs"),
        ("name:mine\nboat: swamp\n", 2, "a space follows a colon, also on the line before"),
        ("boat: swamp\nseed:1\nname: mine\n", 3, "a colon and a space follow a key, also on the line before"),
        ("levels: [calm, severe\nseed: 1\n", 2, "close the bracket"),
        ("name: 'mine\nseed: 1\n", 3, "close the quotation mark"),
        ("data:\n  good: 1\n failed: 2\n", 3, "indent the keys of one block alike"),
    ],
)
def test_a_usual_slip_in_yaml_is_reported_with_its_remedy(
    tmp_path: Path, text: str, line: int, message: str
) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(UserError) as caught:
        read_yaml(path)
    assert str(caught.value).startswith(f"{path}: line {line}, column ")
    assert message in str(caught.value)


def test_a_config_is_found_by_bare_name_or_by_path(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("name: mine\n")
    assert find_config("boats", "swamp").name == "swamp.yaml"
    assert find_config("boats", tmp_path / "mine.yaml") == tmp_path / "mine.yaml"


def test_a_config_named_without_its_suffix_is_answered_with_the_file_beside(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "swamq.yaml").write_text("extends: swamp")
    with pytest.raises(UserError, match=r"no boat file named 'swamq'; did you mean 'swamq\.yaml'\?"):
        find_config("boats", "swamq")


def test_an_unknown_config_lists_those_there_are(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder" / "inner").mkdir(parents=True)
    with pytest.raises(UserError, match=r"no boat file named 'swmp'; did you mean 'swamp'\?.*swamp-light"):
        find_config("boats", "swmp")
    with pytest.raises(UserError, match=r"nowhere/file\.yaml: no such file"):
        find_config("boats", "nowhere/file.yaml")
    for folder in (".", "./", "folder", "folder/inner"):
        with pytest.raises(UserError, match=r"is a folder; give a path"):
            find_config("boats", folder)


@pytest.mark.parametrize(("there", "asked"), [("mine.yaml", "mine.yml"), ("mine.yml", "mine.yaml")])
def test_a_file_that_ends_in_the_other_way_of_yaml_is_suggested(
    tmp_path: Path, there: str, asked: str
) -> None:
    (tmp_path / there).write_text("name: mine\n")
    with pytest.raises(UserError, match=rf"{asked}: no such file; did you mean '{there}'\?"):
        find_config("boats", tmp_path / asked)


def test_a_suffix_in_capitals_is_that_of_a_yaml_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("Boat.YAML", "boat2.Yml"):
        Path(name).write_text("extends: swamp\nname: mine\n")
        assert find_config("boats", name) == Path(name)


def test_a_file_that_is_no_yaml_is_not_called_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "mine.txt").write_text("name: mine\n")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UserError, match=r"mine\.txt: is no YAML file; \w+ are files that end in \.yaml"):
        find_config("boats", "mine.txt")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({}, "f.yaml: name: is missing; add it"),
        ({"nane": "x", "name": "y"}, "f.yaml: nane: unknown key; did you mean 'name'?"),
        ({"name": "x", "motors": [{"powr": 1.0}]}, "motors.0.powr: unknown key; did you mean 'power'?"),
        (
            {"name": "x", "spare": {"left": {"fule": "a"}}},
            "spare.left.fule: unknown key; did you mean 'fuel'?",
        ),
        (
            {"name": "x", "motors": [{"power": 0.0}]},
            "motors.0.power: must be greater than 0, not 0.0",
        ),
        ({"name": 1, "motors": 2}, "name: must be text, not 1"),
    ],
)
def test_what_does_not_fit_is_named_by_dotted_key(data: dict[str, object], message: str) -> None:
    with pytest.raises(UserError) as caught:
        validated("f.yaml", Ship, data)
    assert message in str(caught.value)
    assert all(line.startswith("f.yaml: ") for line in str(caught.value).splitlines())


@pytest.mark.parametrize(
    ("word", "known", "found"),
    [
        ("heading", ("easting", "northing", "lap"), None),
        ("pitch", ("depth", "time"), None),
        ("tiem", ("time", "north"), "time"),
        ("Heading_deg", ("time", "heading"), "heading"),
        ("headng", ("time", "heading"), "heading"),
    ],
)
def test_a_word_that_has_only_letters_in_common_is_not_suggested(
    word: str, known: tuple[str, ...], found: str | None
) -> None:
    assert likest(word, known) == found


def test_every_fault_has_its_line() -> None:
    with pytest.raises(UserError) as caught:
        validated("f.yaml", Ship, {"name": 1, "motors": 2})
    listed = [line.rpartition(":")[0] for line in str(caught.value).splitlines()]
    assert listed == ["f.yaml: name", "f.yaml: motors"]

"""Bags and MCAP files with any names of topics, fields and types: reported in lines that no terminal acts on,
and nothing written but the new dataset."""

import json
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from mcap.writer import Writer

from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import read_log
from tests.support.binary_logs import bag
from tests.support.command_line import Call
from tests.support.command_line import call as call  # the fixture
from tests.support.hostile_names import NAMES, around, assert_harmless, victims

QUOTED = [ascii(name)[:20] for name in NAMES]


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A bag of each storage."""
    folder = tmp_path_factory.mktemp("bags")
    return {
        "db3": next(bag(folder / "two", "sqlite3", seconds=2.0).glob("*.db3")),
        "mcap": next(bag(folder / "cdr", "mcap", seconds=2.0).glob("*.mcap")),
        "bag": bag(folder / "one.bag", "ros1", seconds=2.0),
    }


def imported(call: Call, path: Path, *words: str) -> None:
    """List and import a file: the message is harmless, a complaint one line, and nothing is written but a
    dataset that can be read again."""
    before = around(Path.cwd())
    for more in (("--list",), ("--out", "out")):
        code, out, complaint = call("runs", "import", path, *words, *more)
        assert code in (0, 2)
        assert_harmless(out)
        assert_harmless(complaint, lines=1)
    assert around(Path.cwd()) == before
    if Path("out").exists():
        checked, out, complaint = call("runs", "check", "out")
        assert checked == 0, complaint
        assert_harmless(out)


@pytest.fixture
def here(call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory, with victims beside it."""
    victims(tmp_path)
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


@pytest.mark.parametrize(("number", "name"), list(enumerate(NAMES)), ids=QUOTED)
def test_topics_and_types_of_a_ros_2_database(
    call: Call, here: Path, good: dict[str, Path], number: int, name: str
) -> None:
    change = ("name = ? || id", "type = ?", "name = ?", "type = 'evil/msg/' || ?")[number % 4]
    path = here / "log.db3"
    path.write_bytes(good["db3"].read_bytes())
    with closing(sqlite3.connect(path)) as database, database:
        database.execute(f"UPDATE topics SET {change} WHERE id > 1", (name,))
    imported(call, path)


@pytest.mark.parametrize(("number", "name"), list(enumerate(NAMES)), ids=QUOTED)
def test_topics_and_fields_of_other_bags(
    call: Call, here: Path, good: dict[str, Path], number: int, name: str
) -> None:
    """Replaced by a name of the same length, as the formats tell lengths."""
    kind = ("mcap", "bag")[number % 2]
    old = (b"/boat/odometry", b"position", b"Odometry")[number % 3]
    path = here / f"log.{kind}"
    new = (name.encode() + b"_" * len(old))[: len(old)]
    path.write_bytes(good[kind].read_bytes().replace(old, new))
    imported(call, path, "--from", "rosbag")


def write_messages(path: Path, topic: str, field: str, schema: str) -> None:
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        kind = writer.register_schema(schema, "jsonschema", b"{}")
        channels = [writer.register_channel(one, "json", kind) for one in dict.fromkeys((topic, "/run"))]
        for number in range(20):
            row = {"time": number / 10, "north": 0.1 * number, "east": 0.0, "heading": 0.0, field: 1.0}
            row |= {f"{what}_{k}": 0.0 for what in ("azimuth", "throttle") for k in ("bs", "bp", "ss", "sp")}
            for channel in channels:
                writer.add_message(channel, number, json.dumps(row).encode(), number)
        writer.finish()


@pytest.mark.parametrize("name", NAMES, ids=QUOTED)
def test_topics_fields_and_schemas_of_json_messages(call: Call, here: Path, name: str) -> None:
    write_messages(here / "topic.mcap", name, "more", "Run")
    code, out, complaint = call("runs", "import", "topic.mcap", "--out", "out")
    assert (code, out) == (2, "") and "one is needed: --topic NAME" in complaint
    assert_harmless(complaint, lines=1)
    write_messages(here / "field.mcap", "/run", name, name)
    code, out, complaint = call("runs", "import", "field.mcap", "--out", "out")
    assert_harmless(out)
    assert_harmless(complaint, lines=1)
    assert code == (0 if name.isprintable() and 0 < len(name.strip()) < 200 else 2)
    assert code == 0 or "is not a column name" in complaint
    write_messages(here / "schema.mcap", "/run", "more", name)
    assert call("runs", "import", "schema.mcap", "--out", "other")[0] == 0
    assert call("runs", "check", "other")[0] == 0


def test_a_file_of_a_bag_whose_name_is_an_address_of_another_is_refused(tmp_path: Path) -> None:
    folder = bag(tmp_path / "bag", "sqlite3", seconds=2.0)
    (held,) = folder.glob("*.db3")
    shutil.copy(held, tmp_path / "other.db3")
    held.rename(folder / "..%2Fother.db3")
    description = folder / "metadata.yaml"
    description.write_text(description.read_text().replace(held.name, "..%2Fother.db3"))
    with pytest.raises(UserError, match="has % in its name"):
        read_log(folder, "rosbag")

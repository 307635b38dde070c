"""`metadata.yaml` and SQLite files of a ROS 2 bag: what must be in them for the bag to be read."""

import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.explain import explanations
from swamp_rl.files import read_yaml
from swamp_rl.logs.binary import LARGEST
from swamp_rl.ordinary import ordinary
from swamp_rl.runs.kind_of_file import BAG_METADATA
from swamp_rl.sqlite_file import refuse_endless

LARGEST_METADATA = 2**23
OF_ADDRESSES = set("%?#")
"""Of an address of a file, as which rosbags gives a path to SQLite: `..%2Fother.db3` is in another folder."""
ROOT = "rosbag2_bagfile_information"
Count = Annotated[int, Field(ge=0, lt=2**63)]


class Part(BaseModel):
    """What is read; other keys may hold anything."""

    model_config = ConfigDict(frozen=True, strict=True)


class Duration(Part):
    """Of all messages."""

    nanoseconds: Count


class Start(Part):
    """Of the first message."""

    nanoseconds_since_epoch: Count


class Topic(Part):
    """type_description_hash: since version 7."""

    name: str
    type: str
    serialization_format: Literal["cdr"]
    type_description_hash: str = ""


class Counted(Part):
    """A topic and its number of messages."""

    topic_metadata: Topic
    message_count: Count


class Bag(Part):
    """version: of the format, 9 the newest that is read; compression_mode: `message`, `none` or empty."""

    version: Annotated[int, Field(ge=1, le=9)]
    storage_identifier: Literal["sqlite3", "mcap"]
    duration: Duration
    starting_time: Start
    message_count: Count
    topics_with_message_count: list[Counted]
    compression_format: str | None = None
    compression_mode: str = ""
    files: list[Any] = []


def refuse_odd_bag(folder: Path) -> None:
    """UserError where a bag's description is not whole, or its files are not ordinary ones in the folder."""
    path = ordinary(folder / BAG_METADATA, LARGEST_METADATA)
    metadata: Any = read_yaml(path).get(ROOT)
    names = metadata.get("relative_file_paths") if isinstance(metadata, dict) else None
    if not (isinstance(names, list) and all(isinstance(name, str) for name in names)):
        raise UserError(f"{path}: {ROOT} has no list of names relative_file_paths; copy the bag again")
    if str(metadata.get("compression_mode") or "").lower() == "file":
        raise UserError(f"{folder}: its files are compressed as a whole; decompress them (ros2 bag convert)")
    for name in names:
        held = folder / Path(name).name
        if held.is_symlink():
            raise UserError(f"{held}: is a link; put a copy of the file in its place")
        ordinary(held, LARGEST)
        if metadata.get("storage_identifier") == "sqlite3":
            refuse_odd_tables(held)
    try:
        Bag.model_validate(metadata)
    except ValidationError as error:
        key, message = explanations(error, Bag)[0]
        raise UserError(f"{path}: {ROOT}.{key}: {message}; or copy the bag again") from error


def refuse_odd_tables(path: Path) -> None:
    """UserError for a bag's SQLite file with rows without end, or whose name rosbags takes for another."""
    if odd := set(str(path.absolute())) & OF_ADDRESSES:
        raise UserError(f"{clipped(path, 200)}: has {min(odd)} in its name or folder; rename that")
    try:
        with closing(sqlite3.connect(f"file:{path.absolute()}?immutable=1", uri=True)) as connection:
            refuse_endless(connection)
    except sqlite3.Error as error:
        raise UserError(f"{path}: {error}; copy the bag again") from error

"""Runs as MCAP files, which robot recorders and viewers share: JSON messages with their schema."""

import hashlib
import importlib
import json
import math
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from swamp_rl.boat import Boat
from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.extras import missing
from swamp_rl.files import explain, write_beside
from swamp_rl.json_text import parsed_json
from swamp_rl.ordinary import ordinary
from swamp_rl.runs.copies import carried_boat
from swamp_rl.runs.faults import Fault
from swamp_rl.runs.import_foreign import Foreign
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import DatasetMeta, RunMeta, parsed_meta
from swamp_rl.runs.table import Table

TOPIC = "/run"
MOST_BYTES = 2**29
"""Of a file's messages, unpacked."""
MOST_NAMED = 12
RECORD = "swamp_rl"
"""The metadata record that holds what `dataset.yaml` says, and the copies beside it."""
NO_COPIES: Mapping[str, bytes] = {}


def write_mcap(path: Path, run: Run, dataset: DatasetMeta, copies: Mapping[str, bytes] = NO_COPIES) -> None:
    """One run as one file: a message for each row on `/run`, each number as text that gives all its bits.

    copies: the files of the dataset's boat and course by name.
    """
    Writer = _mcap("mcap.writer").Writer
    properties = {name: {"type": "number"} for name in run.columns}
    schema = {"type": "object", "title": "Run", "properties": properties, "required": list(run.columns)}
    records = {"run": _json(run.meta), "dataset": _json(dataset.model_copy(update={"runs": []}))}
    records["copies"] = json.dumps({name: held.decode() for name, held in copies.items()})
    records["sha256"] = _digest(records)
    with write_beside(path) as part, part.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="", library=RECORD)
        kind = writer.register_schema("swamp_rl.Run", "jsonschema", json.dumps(schema).encode())
        channel = writer.register_channel(TOPIC, "json", kind)
        writer.add_metadata(RECORD, records)
        stamps = np.round((run.time - run.time[0]) * 1e9).astype(np.int64)
        rows = zip(*(values.tolist() for values in run.columns.values()), strict=True)
        for number, (stamp, row) in enumerate(zip(stamps.tolist(), rows, strict=True)):
            message = json.dumps(dict(zip(run.columns, row, strict=True)), allow_nan=False)
            writer.add_message(channel, stamp, message.encode(), stamp, sequence=number)
        writer.finish()


def _json(meta: RunMeta | DatasetMeta) -> str:
    return json.dumps(meta.model_dump(exclude_none=True, exclude={"file", "rows"}))


def read_mcap(path: Path, topic: str | None = None) -> Foreign:
    """The messages of one topic as a table, fields of objects in objects under names with dots.

    Checksums are verified: MCAP's own, and that of the metadata of a file of ours. The time is a field
    `time`, else the log's, from the first message. topic: needed where several hold JSON.
    UserError for a damaged file, for none or several topics, and by row and column for what is no number.
    """
    messages: dict[str, list[tuple[int, Any]]] = {}
    others: set[str] = set()
    record: dict[str, str] | None = None
    with _reading(path), ordinary(path, None).open("rb") as stream:
        record = _own_record(path, stream)
        for _, channel, message in _reader(stream).iter_messages(log_time_order=False):
            if channel.message_encoding != "json":
                others.add(channel.topic)
                continue
            found = messages.setdefault(channel.topic, [])
            found.append((message.log_time, _parsed(path, channel.topic, len(found) + 1, message.data)))
    chosen = _topic(path, messages, others, topic)
    meta, dataset, copies = _metadata(path, record)
    return Foreign(path.name, path.stem, _table(path, messages[chosen]), meta, dataset, copies)


def boat_of_mcap(path: Path) -> Boat | None:
    """The boat that a file of `write_mcap` tells of, None where it tells of none; UserError for a damaged
    file.
    """
    record: dict[str, str] | None = None
    with _reading(path), ordinary(path, None).open("rb") as stream:
        record = _own_record(path, stream)
    _, dataset, copies = _metadata(path, record)
    return None if dataset is None else carried_boat(dataset, copies)


def _own_record(path: Path, stream: Any) -> dict[str, str] | None:
    """What a file of `write_mcap` tells of its run, empty where that is lost; None for other files.

    UserError for a file that is too large unpacked.
    """
    _refuse_unpacked(path, stream)
    records = {record.name: record.metadata for record in _reader(stream).iter_metadata()}
    ours = _reader(stream).get_header().library == RECORD
    found: dict[str, str] | None = records.get(RECORD, {} if ours else None)
    return found


def _refuse_unpacked(path: Path, stream: Any) -> None:
    """UserError where the chunks hold more than MOST_BYTES unpacked, ValueError where one holds more than it
    says: LZ4 unpacks as much as there is, Zstandard as much as its own header tells."""
    size = 0
    for record in _mcap("mcap.stream_reader").StreamReader(stream, emit_chunks=True).records:
        if type(record).__name__ != "Chunk":
            continue
        size += record.uncompressed_size
        if size > MOST_BYTES:
            raise UserError(f"{path}: holds {size / 2**30:.3g} GiB unpacked; divide it into runs")
        if _unpacked(record.compression, record.data, record.uncompressed_size) > record.uncompressed_size:
            raise ValueError("a chunk is larger than it declares")


def _unpacked(compression: str, data: bytes, stated: int) -> int:
    """How many bytes it will unpack to, at most one more than stated; 0 where mcap itself keeps to that."""
    if compression == "lz4":
        return len(importlib.import_module("lz4.frame").LZ4FrameDecompressor().decompress(data, stated + 1))
    if compression == "zstd":
        return int(importlib.import_module("zstandard").frame_content_size(data))
    return 0


def _reader(stream: Any) -> Any:
    """From the file's beginning to its end; one that follows the index could be led to other chunks."""
    stream.seek(0)
    return _mcap("mcap.reader").NonSeekingReader(stream, validate_crcs=True)


def _digest(record: Mapping[str, str]) -> str:
    return hashlib.sha256("\n".join(record[key] for key in ("run", "dataset", "copies")).encode()).hexdigest()


def _mcap(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise missing("MCAP files need mcap", "exchange") from error


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Whatever a reader of damaged bytes raises, as one line."""
    try:
        yield
    except UserError:
        raise
    except FileNotFoundError as error:
        raise UserError(f"{path}: no such file; name an .mcap file") from error
    except Exception as error:
        if type(error).__name__ == "EndOfFile":  # of the optional package mcap
            raise UserError(
                f"{path}: the end of the MCAP file is missing; wait if it is still being written, or copy it "
                "again, or repair it with `mcap recover`"
            ) from error
        raise UserError(
            f"{path}: is not a complete MCAP file ({type(error).__name__}: {error}); copy it again"
        ) from error


def _parsed(path: Path, topic: str, row: int, data: bytes) -> dict[str, Any]:
    try:
        found = parsed_json(data)
    except ValueError as error:
        raise UserError(f"{path}: {clipped(topic)}, row {row}: is no JSON ({error})") from error
    if not isinstance(found, dict):
        raise UserError(f"{path}: {clipped(topic)}, row {row}: is no JSON object of named numbers")
    return dict(_flat(found))


def _flat(found: dict[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in found.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def _topic(path: Path, messages: dict[str, Any], others: set[str], asked: str | None) -> str:
    known = _listed(messages)
    if others and not messages:
        raise UserError(
            f"{path}: has no JSON messages, but {_listed(others)}; of a ROS bag, runs import --from rosbag "
            "makes a dataset, and of this runs export --to mcap an MCAP file with JSON"
        )
    if asked is not None and asked not in messages:
        raise UserError(f"{path}: no topic {clipped(repr(asked))} with JSON messages; there is {known}")
    if asked is None and len(messages) != 1:
        binary = f" (not JSON: {_listed(others)})" if others else ""
        raise UserError(
            f"{path}: its topics with JSON messages are {known}{binary}; one is needed: --topic NAME"
        )
    return asked or next(iter(messages))


def _listed(topics: Collection[str]) -> str:
    """The first of a file's topics, for a line."""
    some = ", ".join(clipped(topic) for topic in sorted(topics)[:MOST_NAMED])
    return (f"{some} …" if len(topics) > MOST_NAMED else some) or "none"


def _metadata(
    path: Path, record: dict[str, str] | None
) -> tuple[RunMeta, DatasetMeta | None, dict[str, bytes]]:
    if record is None:
        return RunMeta(), None, {}
    try:
        if record["sha256"] != _digest(record):
            raise ValueError("its SHA-256 is another")
        meta = RunMeta.model_validate(parsed_json(record["run"]))
        copies = {name: text.encode() for name, text in parsed_json(record["copies"]).items()}
        return meta, parsed_meta(parsed_json(record["dataset"])), copies
    except ValidationError as error:
        raise explain(f"{path}: its record {RECORD}", error) from error
    except (KeyError, ValueError, AttributeError) as error:
        raise UserError(f"{path}: its record {RECORD} is damaged ({error})") from error


def _number(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        return float(value) if math.isfinite(value) else None
    except OverflowError:
        return None


def _table(path: Path, messages: list[tuple[int, dict[str, Any]]]) -> Table:
    names = dict.fromkeys(name for _, message in messages for name in message)
    table = Table(rows=np.arange(1, len(messages) + 1))
    for name in names:
        values = np.full(len(messages), np.nan)
        unread = np.zeros(len(messages), bool)
        for i, (_, message) in enumerate(messages):
            number = _number(message.get(name))
            values[i], unread[i] = (np.nan, True) if number is None else (number, False)
        if unread.any():
            first = int(np.argmax(unread))
            wrong = messages[first][1].get(name)
            advice = (
                "is missing; complete the messages"
                if wrong is None
                else f"{str(wrong)[:40]!r} is not a number"
            )
            table.faults.append(Fault(path.name, first + 1, name, advice))
        table.columns[name], table.unread[name] = values, unread
    if "time" not in table.columns:
        stamps = [stamp for stamp, _ in messages]
        table.columns["time"] = np.array([stamp - stamps[0] for stamp in stamps], float) / 1e9
    return table

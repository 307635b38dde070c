"""From logs of other recorders to one dataset, by a mapping, whole or not at all."""

from collections.abc import Collection, Iterator, Sequence
from collections.abc import Mapping as Mapped
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from swamp_rl.boat import Boat, load_boat
from swamp_rl.errors import UserError
from swamp_rl.explain import likest
from swamp_rl.logs.azimuths import with_nearest_azimuths
from swamp_rl.logs.convert import foreign_of
from swamp_rl.logs.dataflash import read_dataflash
from swamp_rl.logs.defaults import default_mapping, ros_kinds, wanted_messages
from swamp_rl.logs.frames import names_by_column
from swamp_rl.logs.keep import KEEP, kept_parts
from swamp_rl.logs.log import Log
from swamp_rl.logs.mapping import Mapping
from swamp_rl.logs.matlab import read_matlab
from swamp_rl.logs.own_runs import own_mapping, with_own_entries
from swamp_rl.logs.restarts import parts_between_restarts
from swamp_rl.logs.ros import read_bag
from swamp_rl.logs.tables import read_folder_log, read_table_log
from swamp_rl.logs.ulog import read_ulog
from swamp_rl.logs.velocity_frame import foreign_in_its_axes
from swamp_rl.runs.check import unknown_columns
from swamp_rl.runs.columns import FIXED
from swamp_rl.runs.copies import boat_file
from swamp_rl.runs.dataset import read_meta
from swamp_rl.runs.import_dataset import (
    About,
    files_of_kind,
    import_tables,
    names_apart,
    refuse_idle,
    whole_folder,
)
from swamp_rl.runs.import_foreign import Foreign, Wishes
from swamp_rl.runs.kind_of_file import is_bag_folder
from swamp_rl.runs.schema import META, DatasetMeta

ABOUT_ONE = 1.2
"""Greatest ratio of the rates of logs that are joined at one rate."""
TABLES = ("csv", "parquet")
BINARY = ("dataflash", "ulog", "rosbag")
MAPPED = ("matlab", *BINARY)
"""Kinds that only a mapping imports, by default that of BINARY."""
QUANTITIES = ("latitude", "longitude", "yaw", "velocity_north", "velocity_east")
"""Names of a mapping that are written like columns of a run."""


@dataclass(frozen=True)
class Reading:
    """How logs are read: the `mapping`; `join`: the files are tables of one run of this name; `folders`: each
    source is a folder, whose files are tables of one run."""

    mapping: Mapping
    join: str | None = None
    folders: bool = False


def import_logs(
    sources: Sequence[Path], kind: str, out: Path | str, about: About, wishes: Wishes, reading: Reading
) -> DatasetMeta:
    """Write the runs that a mapping makes of logs into the new dataset `out`; what it then says.

    UserError lists the faults with file, row and column, and then there is no `out`.
    """
    if kind not in (*TABLES, *MAPPED):
        raise UserError(f"--map: is not for --from {kind}; leave it out, or give --column")
    refuse_idle(kind, about, wishes)
    mapping = replace(reading.mapping, units={**reading.mapping.units, **wishes.units})
    boat = load_boat(about.boat or _own_boat(sources) or "swamp")
    logs, mappings = [], []
    for log in read_logs(sources, kind, mapping, reading.folders):
        parts = parts_between_restarts(log) if kind in BINARY else [log]
        logs += parts
        mappings += [_whole_mapping(kind, part, mapping, boat) for part in parts]
    if reading.join is not None:
        logs, mappings = [as_one(logs, reading.join)], mappings[:1] if kind in BINARY else [mapping]
    datasets = {home: read_meta(home) for home in {log.home for log in logs} if home is not None}
    pairs = list(zip(logs, mappings, strict=True))
    _refuse_units(pairs[0][1], wishes.units)
    single = [_foreign(log, own, mapping, kind, boat, wishes) for log, own in pairs]
    if wishes.resample is None and (rate := _common_rate(single)) is not None:
        single = [
            _foreign(log, own, mapping, kind, boat, replace(wishes, resample=rate)) for log, own in pairs
        ]
    single = [
        one if log.home is None else with_own_entries(one, log, datasets[log.home], mapping)
        for one, log in zip(single, logs, strict=True)
    ]
    single = [part for one in single for part in kept_parts(one)]
    return import_tables(single, out, about, replace(wishes, units={}))


def _own_boat(sources: Sequence[Path]) -> str | Path | None:
    """The boat of the dataset that a source is, or is a run of."""
    homes = [home for source in sources for home in (source, source.parent) if (home / META).is_file()]
    return boat_file(homes[0], read_meta(homes[0])) if homes else None


def _whole_mapping(kind: str, log: Log, given: Mapping, boat: Boat) -> Mapping:
    """The given mapping, and what the format or the run itself has of the columns that it does not give."""
    if kind in BINARY:
        return given.over(default_mapping(kind, log, given, boat))
    return given if log.home is None else given.over(own_mapping(log, given))


def _refuse_units(mapping: Mapping, units: Mapped[str, str]) -> None:
    """UserError for a unit of what the mapping does not give, with what becomes such a column."""
    for ours, unit in units.items():
        if ours not in mapping.columns:
            made = names_by_column(mapping).get(ours)
            hint = f"; {made} becomes {ours}: --unit {made}={unit}" if made else ""
            there = ", ".join(mapping.columns)
            raise UserError(
                f"--unit or --degrees {ours}: the mapping has no such column; it has {there}{hint}"
            )


def _common_rate(single: Sequence[Foreign]) -> float | None:
    """The median rate [Hz] of joined logs of about one rate; None where they have one, or differ by more."""
    if not all(one.even for one in single):
        return None
    rates = [1.0 / float(np.median(np.diff(one.table.columns["time"]))) for one in single]
    apart = max(rates) / min(rates)
    return float(f"{np.median(rates):.3g}") if 1.0 + 1e-6 < apart <= ABOUT_ONE else None


def _foreign(log: Log, mapping: Mapping, given: Mapping, kind: str, boat: Boat, wishes: Wishes) -> Foreign:
    """The run's table; a log without a mapping names what the default one looks for. given: the part of the
    mapping that the user wrote."""
    if not mapping.columns:
        known = ", ".join(list(log.tables)[:12])
        raise UserError(f"{log.file}: none of the usual messages is there ({known}); see --list, and --map")
    own = {key: value for key, value in log.metadata.items() if not key.startswith("parameter ")}
    own |= _without_commands(boat, mapping, None if kind in BINARY else log)
    read = replace(log, metadata=own)
    convert = partial(foreign_of, read, rate=wishes.resample, fill=wishes.fill, counted=wishes.rate)
    by_type = kind == "rosbag" and {"u", "v"} <= mapping.columns.keys() - given.columns.keys()
    found = foreign_in_its_axes(mapping, convert) if by_type else convert(mapping)
    found = with_nearest_azimuths(found, boat)
    found = replace(found, meta=found.meta.model_copy(update=_unknown(found, boat)))
    if kind in BINARY:
        for what, columns in (("position", {"latitude", "north"}), ("heading", {"heading"})):
            if not columns & found.table.columns.keys():
                raise UserError(f"{log.file}: no message gives a valid {what}; see --list, and give --map")
    return found


def _unknown(found: Foreign, boat: Boat) -> dict[str, str]:
    """What to tell of columns that the run format does not know, with the known name that is most alike."""
    names = set(unknown_columns(list(found.table.columns), boat)) - {*QUANTITIES, KEEP}
    near = {name: likest(name, (*FIXED, *QUANTITIES)) for name in sorted(names)}
    listed = [f"{name} (did you mean {other!r}?)" if other else name for name, other in near.items()]
    return {"unknown_columns": f"{', '.join(listed)}; kept as they are"} if listed else {}


def _without_commands(boat: Boat, mapping: Mapping, tables: Log | None) -> dict[str, str]:
    """What to tell where the mapping lacks commands of the boat's thrusters; of tables, only those commands
    that are columns of the log under the same name."""
    there = None if tables is None else {one for log in tables.tables.values() for one in log.table.columns}
    lacking = [
        column
        for thruster in boat.thrusters
        for column in thruster.command_columns
        if column is not None and column not in mapping.columns and (there is None or column in there)
    ]
    if not lacking:
        return {}
    field = "TABLE.FIELD" if there is None or tables is None or len(tables.tables) > 1 else lacking[0]
    message = f"missing: {', '.join(lacking)} of {boat.name}; see --list, and give --map {lacking[0]}={field}"
    return {"commands": message}


def paths_of(sources: Sequence[Path], kind: str) -> list[Path]:
    """The logs that sources are or hold; of ROS 2 each bag's folder."""
    found = []
    for source in sources:
        if kind == "rosbag" and source.is_dir():
            folders = [source] if is_bag_folder(source) else sorted(filter(is_bag_folder, source.iterdir()))
            found += folders or files_of_kind([source], kind)
        else:
            found += files_of_kind([source], kind)
    return found


def read_logs(sources: Sequence[Path], kind: str, mapping: Mapping | None, folders: bool) -> Iterator[Log]:
    """The logs that sources are or hold, one after the other; mapping: what is read of them, by default all.

    folders: each source is a folder whose files are the tables of one log. UserError: a reader's.
    """
    if folders:
        wanted = {name.partition(".")[0] for name in mapping.names if "." in name} if mapping else None
        for folder, name in names_apart(sources, lambda source: [source]).items():
            yield replace(read_folder_log(folder, tables_in(folder, kind), wanted), name=name)
        return
    wanted = wanted_messages(kind, mapping) if mapping and kind in BINARY else None
    for path, name in names_apart(sources, lambda source: paths_of([source], kind)).items():
        yield replace(read_log(path, kind, wanted), name=name)


def tables_in(folder: Path, kind: str) -> list[Path]:
    """The files of a kind of TABLES in a folder and the folders in it."""
    if kind not in TABLES:
        raise UserError(f"--join-folders: is for tables; give --from {' or '.join(TABLES)}")
    if not folder.is_dir():
        raise UserError(f"{folder}: is not a folder; leave --join-folders out, or name folders")
    return whole_folder(folder, kind)


def read_log(path: Path, kind: str, wanted: Collection[str] | None = None) -> Log:
    """A log of any kind; wanted: tables that are needed, all by default. UserError: its reader's."""
    if kind == "dataflash":
        return read_dataflash(path, wanted)
    if kind == "ulog":
        return read_ulog(path, wanted)
    if kind == "rosbag":
        return read_bag(path, wanted, ros_kinds())
    return read_matlab(path) if kind == "matlab" else read_table_log(path)


def as_one(logs: Sequence[Log], name: str) -> Log:
    """The tables of several files as one log."""
    tables = {table.name: table for log in logs for table in log.tables.values()}
    return Log(" + ".join(Path(log.file).name for log in logs), name, tables)

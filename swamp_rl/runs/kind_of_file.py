"""What kind of file a source is, by its suffix or its header."""

from collections.abc import Sequence
from pathlib import Path

from swamp_rl.errors import UserError
from swamp_rl.ordinary import ordinary
from swamp_rl.runs.schema import META
from swamp_rl.runs.table import FORMATS
from swamp_rl.runs.text_header import TEXTS, complaint_of, has_names

SUFFIXES = {
    "csv": (".csv", ".tsv"),
    "parquet": (".parquet",),
    "mcap": (".mcap",),
    "telemetry": (".txt", ".log", ".dat"),
    "free-running": (".csv",),
    "matlab": (".mat",),
    "dataflash": (".bin",),
    "ulog": (".ulg",),
    "rosbag": (".bag", ".db3", ".mcap"),
}
"""The last four are read by `swamp_rl.logs`."""
SURE = {
    ".csv": "csv",
    ".tsv": "csv",
    ".parquet": "parquet",
    ".mat": "matlab",
    ".bin": "dataflash",
    ".ulg": "ulog",
    ".bag": "rosbag",
    ".db3": "rosbag",
}
"""Kinds that a suffix alone tells."""
REMEDIES = {
    **dict.fromkeys((".xls", ".xlsx", ".ods"), "save the sheet as CSV"),
    **dict.fromkeys((".gz", ".zip", ".xz", ".bz2", ".zst", ".7z", ".tar"), "unpack it"),
    **dict.fromkeys(
        (".npy", ".npz", ".h5", ".hdf5", ".json", ".jsonl", ".pkl", ".pickle", ".feather", ".nc"),
        "write its columns to a CSV or Parquet file, with pandas for example",
    ),
    **dict.fromkeys((".nmea", ".gpx", ".kml"), "convert it to CSV, with gpsbabel for example"),
    ".tlog": "import the autopilot's .bin log of the same time",
}
"""What to do with files that are not read, by their suffixes."""
BEGINNINGS = {
    b"FMT,": "it is a DataFlash log converted to text; import the autopilot's .bin log that it was made of",
    b"$G": f"it holds NMEA sentences; {REMEDIES['.nmea']}",
}
"""The same of text files, by their first bytes."""
MCAP = b"\x89MCAP0\r\n\x01"
BEFORE_PROFILE = len(MCAP) + 8 + 4
"""Bytes of an MCAP file that begin it, with the header's opcode, and those before the profile's text: lengths
of the record and of the text (mcap.dev/spec). ROS writes `ros1` or `ros2`."""
BAG_METADATA = "metadata.yaml"
"""Describes a bag of ROS 2 in its folder."""


def is_bag_folder(path: Path) -> bool:
    """Whether a folder is a bag of ROS 2."""
    return path.is_dir() and (path / BAG_METADATA).is_file()


def kind_of(sources: Sequence[Path]) -> str:
    """The kind of which all sources are, by their suffixes and those of the files in folders; UserError where
    these do not tell it.
    """
    found = {kind: source for source in reversed(sources) for kind in _kinds(source)}
    if None in found:
        unknown = found[None]
        if advice := _remedy(unknown):
            raise UserError(f"{unknown}: is not read; {advice}")
        if complaint := _is_text(unknown) and complaint_of(unknown):
            raise UserError(
                f"{unknown}: {complaint}; of text that is no table give --from telemetry or free-running"
            )
        raise UserError(
            f"{unknown}: neither its suffix nor its header tells what it is; give --from, one of "
            f"{', '.join(SUFFIXES)}"
        )
    if set(found) == set(FORMATS) and all((source / META).is_file() for source in sources):
        return FORMATS[0]  # datasets, of which each says which files are its runs
    if len(found) > 1:
        raise UserError(
            f"{sources[0]}{' and others' * (len(sources) > 1)}: files of several kinds "
            f"({', '.join(sorted(map(str, found)))}); give --from with one of them"
        )
    return str(next(iter(found)))


def _remedy(path: Path) -> str | None:
    """What to do with a file that is not read, by its suffix or its first bytes."""
    if _is_text(path):
        with ordinary(path, None).open("rb") as stream:
            begin = stream.read(max(map(len, BEGINNINGS)))
        return next((remedy for first, remedy in BEGINNINGS.items() if begin.startswith(first)), None)
    return REMEDIES.get(path.suffix.lower())


def _is_text(path: Path) -> bool:
    return path.suffix.lower() in TEXTS and path.is_file()


def _kinds(source: Path) -> set[str | None]:
    """The kinds that suffixes tell of a file, or of the files of a folder or of the folders in it."""
    if not source.exists():
        raise UserError(f"{source}: no such file or folder; check the name")
    if is_bag_folder(source):
        return {"rosbag"}
    if not source.is_dir():
        return {_kind_of_file(source)}
    if (source / "meta" / "info.json").is_file() or next(source.rglob("main_data.hdf5"), None):
        raise UserError(
            f"{source}: is a folder of LeRobot or Minari, which is not imported; runs doctor reads it"
        )
    for inside in (source.iterdir(), source.rglob("*")):
        shown = [path for path in inside if not path.name.startswith(".")]
        logs = [path for path in shown if path.suffix.lower() in (*SURE, ".mcap") or is_bag_folder(path)]
        if logs:
            return {"rosbag" if is_bag_folder(path) else _kind_of_file(path) for path in logs}
    raise UserError(
        f"{source}: neither it nor a folder in it has {', '.join(SURE)} or .mcap files; check the name, "
        "name text files one by one, or give --from telemetry"
    )


def _kind_of_file(path: Path) -> str | None:
    """The kind that a suffix tells, or the profile in the header of an MCAP file; None where neither does."""
    suffix = path.suffix.lower()
    if suffix in TEXTS and suffix not in SURE:
        return "csv" if has_names(path) else None
    if suffix != ".mcap":
        return SURE.get(suffix)
    profile = mcap_profile(path)
    if profile is None:
        return None
    return "rosbag" if profile.startswith("ros") else "mcap"


def mcap_profile(path: Path) -> str | None:
    """The profile in an MCAP file's header, its first 16 bytes; None for a file that does not begin so."""
    with ordinary(path, None).open("rb") as stream:
        begin = stream.read(BEFORE_PROFILE + 16)
    if len(begin) < BEFORE_PROFILE or not begin.startswith(MCAP):
        return None
    length = int.from_bytes(begin[BEFORE_PROFILE - 4 : BEFORE_PROFILE], "little")
    return begin[BEFORE_PROFILE:][:length].decode(errors="replace")

"""The files that a dataset carries so that it stands alone: its boat's, what that extends, its course's."""

import hashlib
import re
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.load import boat_chain
from swamp_rl.course import load_course
from swamp_rl.errors import UserError
from swamp_rl.files import find_config, os_error, read_yaml, yaml_text
from swamp_rl.names import YAML, file_in, free_name, is_yaml, plain_name
from swamp_rl.ordinary import contents
from swamp_rl.runs.schema import COURSE, META, DatasetMeta
from swamp_rl.yaml_text import MOST_BYTES

Files = dict[str, bytes]
_EXTENDS = re.compile(rb"^extends[ \t]*:.*$", re.MULTILINE)


def standing_alone(
    meta: DatasetMeta, boat: str | Path | None = None, course: str | Path | None = None
) -> tuple[DatasetMeta, Files]:
    """What `dataset.yaml` is to say of copies of the boat's and the course's files, and these by name.

    boat, course: names or paths of whoever makes the dataset, by default those that `meta` gives. `vehicle`
    and `course` are then the names of the copies, which extend each other and nothing else.
    """
    files: Files = {}
    given = course or meta.course
    if given is not None:
        load_course(given)
        path = find_config("courses", given)
        stem = _stem(path.name.removesuffix(path.suffix).removesuffix(COURSE.removesuffix(".yaml")))
        files[stem + COURSE] = _bytes_of(path)
        given = stem
    vehicle = _copy_boat(boat or meta.vehicle, files)
    digests = {name: hashlib.sha256(held).hexdigest() for name, held in files.items()}
    return meta.model_copy(update={"vehicle": vehicle, "course": given, "copies": digests}), files


def _bytes_of(path: Path) -> bytes:
    try:
        return contents(path)
    except OSError as error:
        raise os_error(error, path) from error


def _stem(name: str) -> str:
    return re.sub(r"[^\w.-]", "_", name).lstrip(".")[:60] or "copy"


def _copy_boat(boat: str | Path, files: Files) -> str:
    """Add the boat's file and those that it extends; the name of its own without the suffix."""
    below = ""
    for path, data in boat_chain(boat):
        name = free_name(f"{_stem(path.stem)}.yaml", {META, *files})
        files[name] = extending(_bytes_of(path), data, below) if below else _bytes_of(path)
        below = name
    return below.removesuffix(".yaml")


def extending(text: bytes, data: Mapping[str, Any], base: str) -> bytes:
    """A boat file that extends the file `base` beside it and is the same otherwise, comments and all."""
    lines = _EXTENDS.findall(text)
    if len(lines) == 1 and str(data["extends"]).encode() in lines[0]:
        line = yaml_text({"extends": base}).rstrip().encode()
        return _EXTENDS.sub(lambda _: line, text)
    return yaml_text({**data, "extends": base}).encode()


def write_copies(folder: Path, copies: Mapping[str, bytes]) -> None:
    """The files of a boat and a course into a folder; UserError for a name that reaches out of it."""
    for name, held in copies.items():
        file_in(folder, name, YAML).write_bytes(held)


def boat_of(folder: Path, meta: DatasetMeta) -> Boat:
    """The dataset's boat, by its copy; where it has none, by a file beside the runs or by a known name.

    UserError for one that reaches out of the folder, or whose copy is not as it was when the runs were made.
    """
    try:
        return load_boat(boat_file(folder, meta))
    except UserError as error:
        raise UserError(f"{folder / META}: vehicle: {error}") from error


def carried_boat(meta: DatasetMeta, copies: Mapping[str, bytes]) -> Boat:
    """The boat of a dataset in another format, which carries the copies with it; UserError as `boat_of`."""
    with tempfile.TemporaryDirectory() as folder:
        write_copies(Path(folder), copies)
        return load_boat(boat_file(Path(folder), meta))


def boat_file(folder: Path, meta: DatasetMeta) -> str | Path:
    """Where the dataset's boat is read from: a file in its folder, or a name in configs/boats."""
    found = _carried(folder, meta, meta.vehicle, ".yaml")
    _refuse_reaching_out(folder, found)
    return found


def course_file(folder: Path, meta: DatasetMeta) -> str | Path | None:
    """Where the dataset's course is read from, as `boat_file`; None where it names none."""
    return None if meta.course is None else _carried(folder, meta, meta.course, COURSE)


def _carried(folder: Path, meta: DatasetMeta, name: str, suffix: str) -> str | Path:
    refuse_changed(folder, meta)
    if name + suffix in meta.copies:
        return file_in(folder, name + suffix, YAML)
    if not is_yaml(name):
        return _known_name(folder, name)
    found = file_in(folder, name, YAML)
    if not found.is_file():
        raise UserError(f"{found}: no such file beside the runs; put it there, or give a name in configs")
    return found


def _known_name(folder: Path, name: str) -> str:
    try:
        return plain_name(name)
    except ValueError as error:
        raise UserError(f"{folder}: {error}; copy the file into the folder") from error


def refuse_changed(folder: Path, meta: DatasetMeta) -> None:
    """UserError where a copy is missing or is not what it was when the runs were made."""
    for name, digest in meta.copies.items():
        path = file_in(folder, name, YAML)
        if not path.is_file():
            raise UserError(f"{path}: no such file, but {META} lists it under copies; put it back")
        if hashlib.sha256(_held(path)).hexdigest() != digest:
            raise UserError(
                f"{path}: is not the file that these runs were made with (its SHA-256 is not that under "
                f"copies in {META}); put that back, or drop the entry to take this one"
            )


def _held(path: Path) -> bytes:
    try:
        return contents(path, MOST_BYTES, follow=False)
    except OSError as error:
        raise os_error(error, path) from error


def _refuse_reaching_out(folder: Path, boat: str | Path) -> None:
    """UserError where a boat file of the folder extends anything but another one there or a known boat."""
    seen: set[Path] = set()
    while isinstance(boat, Path) and boat not in seen:
        seen.add(boat)
        base = read_yaml(boat).get("extends") if boat.is_file() else None
        if not isinstance(base, str):
            return  # nothing, or what the loader refuses
        try:
            name = plain_name(base)
            boat = file_in(folder, name, YAML) if is_yaml(name) else name
        except (ValueError, UserError) as error:
            raise UserError(f"{boat}: extends: {error}") from error

"""Files: found by name, read with clear errors, and written so that a half-written one never looks whole."""

import errno
import os
import uuid
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import yaml

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError, errors_at
from swamp_rl.explain import explain as explain
from swamp_rl.explain import explanations as explanations
from swamp_rl.explain import in_yaml, likest
from swamp_rl.explain import validated as validated
from swamp_rl.names import is_yaml
from swamp_rl.ordinary import ordinary
from swamp_rl.yaml_text import MOST_BYTES, dumped, parsed, remedy

CONFIG_KINDS = (
    "boats",
    "courses",
    "designs",
    "disturbances",
    "trials",
    "missions",
    "paths",
    "vehicles",
    "experiments",
    "sweeps",
)
SUFFIXES_OF_FILES = (
    *(".csv", ".gif", ".html", ".jpg", ".json", ".mcap", ".md", ".mp4", ".onnx"),
    *(".parquet", ".pdf", ".png", ".rrd", ".svg", ".txt", ".yaml", ".yml", ".zip"),
)
"""Of files that commands write or that are asked of them, in lower case."""
UNFINISHED = (".part-", ".new-", ".old-", ".lock-")
"""Of the names of what is being written, before the name that it will have: none begins another."""
HINTS = {
    errno.ENOSPC: "free some room",
    errno.EDQUOT: "free some room",
    errno.EEXIST: "a folder is needed there, name another path",
    errno.ENOTDIR: "a folder is needed there, name another path",
}


def os_error(error: OSError, path: Path | str) -> UserError:
    """The operating system's refusal as one line. It names the file that `error` names, or `path` where that
    is none or a hidden one; a folder that is being built, by the name that it will have."""
    named = error.filename if isinstance(error.filename, str | Path) else None
    where = path if named is None or _built(Path(named)) else named
    hint = HINTS.get(error.errno or 0, "check the name and the permissions")
    return UserError(f"{clipped(_built(Path(where)) or where, 300)}: {error.strerror or error}; {hint}")


def _built(path: Path) -> Path | None:
    """The place of what is being built and holds `path` or is it; None if nothing is."""
    for place in reversed((path, *path.parents)):
        for prefix in UNFINISHED:
            if place.name.startswith(prefix):
                return place.with_name(place.name.removeprefix(prefix))
    return None


@contextmanager
def write_beside(path: Path | str) -> Iterator[Path]:
    """Yield a temporary path in the folder of `path`, renamed to `path` once the block has ended well.

    The name keeps its suffix, for writers that choose a format by it. The file is flushed to the disk before
    the rename; whatever ends the block early removes it and leaves an older `path` as it was.
    OSError -> UserError.
    """
    path = Path(path)
    part = _part(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield part
        flush(part)
        os.replace(part, path)
        flush(path.parent)
    except OSError as error:
        raise os_error(error, path) from error
    finally:
        with suppress(OSError):
            part.unlink()


@contextmanager
def new_files_beside(*paths: Path) -> Iterator[list[Path]]:
    """Yield a temporary path for each new file of `paths`, all renamed once the block has ended well.

    They are renamed in the order given: where a kill comes between, the last one, which is the result, is not
    there. Whatever else ends the block or the renaming early leaves none of them. UserError where one of
    `paths` exists by then. OSError -> UserError.
    """
    parts, begun = [_part(path) for path in paths], list[Path]()
    try:
        for path in paths:
            path.parent.mkdir(parents=True, exist_ok=True)
        yield parts
        for part in parts:
            flush(part)
        refuse_existing(paths)
        for part, path in zip(parts, paths, strict=True):
            begun.append(path)
            os.replace(part, path)
            flush(path.parent)
        begun.clear()
    except OSError as error:
        raise os_error(error, paths[-1]) from error
    finally:
        for path in (*begun, *parts):
            with suppress(OSError):
                path.unlink()


def _part(path: Path) -> Path:
    refuse_nameless(path)
    return path.with_name(f".part-{uuid.uuid4().hex[:8]}-{path.name}")


def refuse_nameless(path: Path) -> None:
    """UserError where nothing can be written beside `path`, as it is a root or ends in `..`."""
    if path.name in ("", ".."):
        raise UserError(f"{path}: is a folder above others; give the file or folder to be written a name")


def refuse_existing(paths: Iterable[Path]) -> None:
    """UserError for the first of `paths` that is there, be it a link to nothing."""
    for path in paths:
        if os.path.lexists(path):
            raise UserError(f"{path}: already exists; name another --out or remove it")


def refuse_name_of_file(path: Path) -> None:
    """UserError where folder `path` is to be made under a name that ends as those of files do."""
    if path.suffix.lower() in SUFFIXES_OF_FILES and not path.exists():
        raise UserError(
            f"{path}: a folder is written here, and {path.suffix} ends the name of a file; name a folder, "
            f"such as {path.stem}"
        )


def flush_whole(folder: Path) -> None:
    """Have a folder and all that lies in it on the disk, what is deepest first."""
    for path in (*sorted(folder.rglob("*"), reverse=True), folder):
        flush(path)


def flush(path: Path) -> None:
    """Have the operating system put a file, or a folder's list of names, on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


_copies: ContextVar[Mapping[tuple[str, str], Path]] = ContextVar("copies", default={})  # noqa: B039


@contextmanager
def config_copies(copies: Mapping[tuple[str, str], Path]) -> Iterator[None]:
    """Within the block `find_config` gives these files, by kind and name or path, in place of its own."""
    token = _copies.set(copies)
    try:
        yield
    finally:
        _copies.reset(token)


def find_config(kind: str, name_or_path: str | Path) -> Path:
    """The YAML file meant by a bare name (`swamp` -> configs/boats/swamp.yaml) or by a path."""
    if kind not in CONFIG_KINDS:
        raise ValueError(f"kind is one of {CONFIG_KINDS}, not {kind!r}")
    refuse_object(kind, name_or_path)
    one = f"{kind.removesuffix('s')} file"
    copy = _copies.get().get((kind, str(name_or_path)))
    if copy is not None:
        return copy
    given = Path(name_or_path)
    if _is_path(given):
        if not given.name or os.path.isdir(given):
            raise UserError(f"{given}: is a folder; give a path to a YAML file or one of {_known(kind)}")
        if not is_file(given):
            other = given.with_suffix(".yml" if given.suffix == ".yaml" else ".yaml")
            hint = f"did you mean {clipped(other.name)!r}? " if is_file(other) else ""
            known = f"give a path to a YAML file or one of {_known(kind)}"
            raise UserError(f"{clipped(given, 200)}: no such file; {hint}{known}")
        return given
    found = _configs() / kind / f"{given}.yaml"
    if not is_file(found):
        if os.path.isdir(given):
            raise UserError(f"{given}: is a folder; give a path to a YAML file or one of {_known(kind)}")
        if given.suffix and is_file(given):
            raise UserError(f"{clipped(given)}: is no YAML file; {kind} are files that end in .yaml")
        beside = [name for name in (f"{given}.yaml", f"{given}.yml") if is_file(Path(name))]
        near = beside[0] if beside else likest(clipped(given), config_names(kind))
        hint = f"did you mean {clipped(near)!r}? " if near else ""
        raise UserError(f"no {one} named {clipped(given)!r}; {hint}give a path or one of {_known(kind)}")
    return found


def refuse_object(kind: str, given: Any) -> None:
    """UserError for what is neither a name nor a path, as an object that was read from such a file."""
    if not isinstance(given, str | os.PathLike):
        raise UserError(f"one of the {kind} is of the type {type(given).__name__}; give a name or a path")


def written_path(out: Any) -> Path:
    """The path that the argument `out` of a function names; UserError for what is none."""
    if not isinstance(out, str | os.PathLike):
        raise UserError(f"out: is of the type {type(out).__name__}; give the path of what is to be written")
    return Path(out)


def extended_config(kind: str, path: Path, extended: Any) -> Path:
    """The file that the one at `path` extends: a bare name of that kind, or a path from its own folder."""
    if not isinstance(extended, str) or not extended:
        raise UserError(f"{path}: extends must be the name or the path of a file, not {in_yaml(extended)}")
    with errors_at(f"{path}: extends"):
        is_name = Path(extended).suffix == "" and len(Path(extended).parts) == 1
        return find_config(kind, extended if is_name else path.parent / extended)


def config_beside(path: Path, named: str) -> str:
    """The name or path of a configuration that the file at `path` gives; see `or_beside` for a path."""
    return or_beside(path, named) if _is_path(Path(named)) else named


def or_beside(path: Path, named: str) -> str:
    """A path that the file at `path` gives: from the working directory, or, where only that exists, from the
    file's own folder."""
    beside = path.parent / named
    try:
        return str(beside) if beside.exists() and not Path(named).exists() else named
    except (OSError, ValueError):  # too long, or with a null byte
        return named


def _is_path(given: Path) -> bool:
    return is_yaml(given) or len(given.parts) != 1


def is_file(path: Path) -> bool:
    """Whether an ordinary file is there; a name too long or with a null byte is none."""
    try:
        return path.is_file()
    except OSError:
        return False


def _configs() -> Path:
    inside_wheel = Path(__file__).parent / "configs"
    return inside_wheel if inside_wheel.is_dir() else Path(__file__).parents[1] / "configs"


def config_names(kind: str) -> list[str]:
    """Bare names of the shipped files of one of CONFIG_KINDS, sorted."""
    return sorted(file.stem for file in (_configs() / kind).glob("*.yaml"))


def shipped_folders(kind: str) -> dict[str, Path]:
    """Folders that come with the package, by name: its stored `pilots`, or its `runs`."""
    return {path.name: path for path in sorted((_configs() / kind).glob("*")) if path.is_dir()}


def _known(kind: str) -> str:
    return ", ".join(config_names(kind)) or f"(none in {_configs() / kind})"


def read_yaml(path: Path | str, of: str = "") -> dict[str, Any]:
    """The mapping a YAML file holds; UserError with file and line if missing, malformed or no mapping.

    of: the end of the complaint about what is no mapping.
    """
    path = Path(path)
    try:
        data = parsed(_read_text(path))
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}; check the name") from error
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: byte {error.start} is not UTF-8 text; save the file as UTF-8") from error
    except (yaml.YAMLError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        line = f" line {mark.line + 1}, column {mark.column + 1}:" if mark else ""
        problem = clipped(" ".join(str(getattr(error, "problem", None) or error).split()), 200)
        raise UserError(f"{path}:{line} malformed YAML: {problem}{remedy(problem)}") from error
    if not isinstance(data, dict):
        raise UserError(f"{path}: holds {_kind_of(data)}; it must be a mapping of keys to values{of}")
    odd = [key for key in data if not isinstance(key, str)]
    if odd:
        raise UserError(f"{path}: key {clipped(repr(odd[0]))} is not text; put it in quotes")
    return data


def _read_text(path: Path) -> str:
    """Of a file that may be of any kind and size: no more of it than YAML may have."""
    with ordinary(path, None).open("rb") as file:
        return file.read(MOST_BYTES + 1).decode("utf-8")


def _kind_of(data: Any) -> str:
    named = {type(None): "nothing", list: "a list", str: "only text"}
    return named.get(type(data), f"a lone {type(data).__name__}")


def yaml_text(data: Mapping[str, Any]) -> str:
    """A mapping as YAML; floats keep every bit. UserError where it is too much for `read_yaml`."""
    try:
        return dumped(data)
    except (yaml.YAMLError, ValueError) as error:
        problem = getattr(error, "problem", None) or error
        raise UserError(f"as it would be written, it {problem}, and could not be read again") from error


def write_text(path: Path | str, text: str) -> None:
    """Write a text as UTF-8, beside it first and then renamed, as `write_beside`."""
    with write_beside(path) as part:
        part.write_text(text, encoding="utf-8")


def write_yaml(path: Path | str, data: Mapping[str, Any]) -> None:
    """Write a mapping as `yaml_text`, as `write_text`."""
    write_text(path, yaml_text(data))

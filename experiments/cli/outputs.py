"""What a verb writes lands neither on a file that is there nor in a dataset: one check for all verbs."""

import functools
import hashlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import typer

from swamp_rl.errors import UserError

OUTPUTS = frozenset({"out", "log", "save", "video", "html"})
"""Parameters of verbs that name what is written."""
BEGIN = 2**12
"""Bytes of a picture that hold its texts."""


def guard_inputs(app: typer.Typer) -> None:
    """Have every verb of `app` and of the groups in it refuse such an output before it does anything."""
    for verb in app.registered_commands:
        if verb.callback is not None:
            verb.callback = _guarded(verb.callback)
    for group in app.registered_groups:
        if group.typer_instance is not None:
            guard_inputs(group.typer_instance)


def refuse_suffix(option: str, path: Path | None, *suffixes: str) -> None:
    """UserError where what an option names to be written ends in none of `suffixes`."""
    if path is not None and path.suffix.lower() not in suffixes:
        raise UserError(f"{option} {path}: end the name in {' or '.join(suffixes)}")


def mark_of(source: Path) -> str:
    """The text by which a picture or page is known to be an earlier one of this file or folder."""
    return f"swamp-rl {hashlib.sha256(str(source.resolve()).encode()).hexdigest()}"


def refuse_to_replace(message: str, path: Path, read: Iterable[Path]) -> None:
    """UserError for a file that is there, but for an earlier picture or page of one of those read."""
    if not path.is_file():
        return  # a folder, a device such as /dev/stdout, or nothing
    if any(one.is_file() and one.samefile(path) for one in read):
        raise UserError(f"{message}: already exists and is read by this command; name another file")
    begin = b""
    with suppress(OSError), path.open("rb") as file:
        begin = file.read(BEGIN)
    if not any(mark_of(one).encode() in begin for one in read):
        raise UserError(f"{message}: already exists; name another place, or remove it")


def _guarded(verb: Any) -> Any:
    @functools.wraps(verb)
    def guarded(**given: Any) -> Any:
        _refuse_outputs_among_inputs(given)
        return verb(**given)

    return guarded


def _refuse_outputs_among_inputs(given: Mapping[str, Any]) -> None:
    """given: the parameters of a verb by their names."""
    read = [Path(text) for name, value in given.items() if name not in OUTPUTS for text in _texts(value)]
    for name in sorted(OUTPUTS & given.keys()):
        for text in _texts(given[name]):
            # A name that no file can have, or links in a circle: whoever opens it says so.
            with suppress(OSError, RuntimeError, ValueError):
                _refuse(f"--{name} {text}", Path(text), read)


def _texts(value: Any) -> Iterator[str]:
    """The texts that may be paths."""
    for one in value if isinstance(value, list | tuple) else [value]:
        if isinstance(one, str | Path):
            yield str(one)


def _refuse(message: str, path: Path, read: list[Path]) -> None:
    from swamp_rl.runs.schema import ANALYSIS, META

    place = path.resolve()
    for folder in place.parents:
        inside = place.relative_to(folder)
        if (folder / META).is_file() and inside.parts[0] != ANALYSIS:
            raise UserError(f"{message}: lies in the dataset {folder}; name a place outside it")
    refuse_to_replace(message, path, read)

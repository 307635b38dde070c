"""Whatever a file of any format holds, only the package's own error, in one line, leaves its loader."""

import os
import re
import signal
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies

from benchmarks.attack.folder_formats import read_in_fork
from benchmarks.attack.formats import FORMATS, outcome
from benchmarks.attack.fuzz import HANG
from swamp_rl.errors import UserError

CORPUS = Path(__file__).parent / "corpus"
"""Inputs that once left a loader by another way, in a folder for each format."""
FOUND = sorted(path for path in CORPUS.glob("*/*") if path.is_file())


NOT_FILES = {
    "--set",
    "--map",
    "--clock",
    "message",
    "trials.sqlite row",
    "weights, sealed anew",
    "unfinished.json",
    "datagrams to a module",
    "datagrams to the sensors",
    "telemetry packets",
    "results.json",
    "results, versions.json",
    "fleet, diagnosis.json",
    "fleet, fleet_input.json",
    "doctor, lerobot swamp_rl.json",
    "doctor, minari metadata.json",
}
"""Formats that come as an argument, by a socket or in a row, or whose readers read the file before or
can do without it."""


class LateError(BaseException):
    """Nothing handles it."""


@contextmanager
def ends_within(seconds: float) -> Iterator[None]:
    """Fail what takes longer, be it in a call that waits."""

    def late(*_: Any) -> None:
        raise LateError(f"still not ended after {seconds:g} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@strategies.composite
def edits(draw: strategies.DrawFn) -> list[tuple[float, int, bytes]]:
    """Places (as shares of the file's length), how many bytes are left out there, and what is put there."""
    edit = strategies.tuples(
        strategies.floats(0.0, 1.0), strategies.integers(0, 12), strategies.binary(max_size=12)
    )
    return draw(strategies.lists(edit, min_size=1, max_size=6))


def edited(data: bytes, changes: list[tuple[float, int, bytes]]) -> bytes:
    """The bytes with each of the changes."""
    for share, left_out, put in changes:
        at = round(share * len(data))
        data = data[:at] + put + data[at + left_out :]
    return data


@pytest.mark.parametrize("name", FORMATS)
def test_a_damaged_file_is_read_or_refused_in_one_line(
    name: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    format = FORMATS[name]
    path = format.make(tmp_path_factory.mktemp("attack"))
    good = path.read_bytes()
    assert outcome(format, path, good) == "accepted"

    @settings(max_examples=12, deadline=None)
    @given(edits())
    def holds(changes: list[tuple[float, int, bytes]]) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # weights beyond float64 overflow
            assert outcome(format, path, edited(good, changes)) in ("accepted", "refused")

    holds()


@pytest.mark.parametrize("cut", [0.0, 0.1, 0.5, 0.99])
@pytest.mark.parametrize("name", FORMATS)
def test_a_file_cut_short_is_read_or_refused_in_one_line(name: str, cut: float, tmp_path: Path) -> None:
    format = FORMATS[name]
    path = format.make(tmp_path)
    good = path.read_bytes()
    assert outcome(format, path, good[: int(cut * len(good))]) in ("accepted", "refused")


NUMBER = re.compile(rb"(?<![\w.+-])[-+]?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.])")
EXTREME = (b"1.0e+308", b"-1.0e+308", b"1.0e-320", b"9" * 400)
PLACES = 8


@pytest.mark.parametrize("name", FORMATS)
def test_a_number_at_the_end_of_floating_point_is_read_or_refused_in_one_line(
    name: str, tmp_path: Path
) -> None:
    format = FORMATS[name]
    path = format.make(tmp_path)
    good = path.read_bytes()
    assert outcome(format, path, good) == "accepted"
    places = [] if b"\0" in good else [found.span() for found in NUMBER.finditer(good)]  # of text alone
    for begin, end in places[:: max(1, len(places) // PLACES)]:
        for extreme in EXTREME:
            with warnings.catch_warnings():
                warnings.simplefilter("error", RuntimeWarning)  # another line on the error stream
                outcome(format, path, good[:begin] + extreme + good[end:])


@pytest.mark.parametrize("found", FOUND, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_what_an_attack_once_found_is_found_no_more(found: Path, tmp_path: Path) -> None:
    format = FORMATS[found.parent.name]
    path = format.make(tmp_path)
    assert outcome(format, path, found.read_bytes()) in ("accepted", "refused")


def a_pipe(path: Path) -> None:
    os.mkfifo(path)


def a_folder(path: Path) -> None:
    path.mkdir()


def a_device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def a_file_of_a_terabyte(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(2**40)  # sparse, so it takes no room


@pytest.mark.parametrize("put", [a_pipe, a_folder, a_device, a_file_of_a_terabyte])
@pytest.mark.parametrize("name", [name for name in FORMATS if name not in NOT_FILES])
def test_what_is_no_file_of_its_kind_is_refused_at_once(
    name: str, put: Callable[[Path], None], tmp_path: Path
) -> None:
    path = FORMATS[name].make(tmp_path)
    path.unlink()
    put(path)
    with ends_within(HANG), pytest.raises(UserError) as refused:
        FORMATS[name].read(path)
    assert str(refused.value).isprintable() and len(str(refused.value)) < 3000


@pytest.mark.parametrize(("before", "after", "refused"), [(2**30, 2**20, False), (0, 2**30 + 2**27, True)])
def test_the_memory_of_a_fork_is_what_it_takes_beside_what_it_inherits(
    tmp_path: Path, before: int, after: int, refused: bool
) -> None:
    held = np.ones(before, np.uint8)
    work = read_in_fork(lambda path: int(np.ones(after, np.uint8)[-1]))
    if refused:
        with pytest.raises(AssertionError, match="holds"):
            work(tmp_path)
    else:
        assert work(tmp_path) == held[0] == 1

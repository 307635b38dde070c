"""Power cuts: what a recorder had not yet flushed is dropped, reordered or torn; nothing accepted is lost.

python -m benchmarks.attack power [--count 300] [--seed 1]

The calls of a recorder that accepts and discards short runs are written down once. A cut comes after any of
them. What is then on the disk: bytes of a file as far as its last fsync, and of later writes any choice, the
place of one that is missing being zeros, the last one torn; names as far as the last fsync of their folder,
and of later creations, renames and removals any choice. POSIX promises no more, and file systems differ.
"""

import os
import shutil
import sys
from argparse import Namespace
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.attack.counts import Count
from benchmarks.attack.kills import wrong_after
from benchmarks.attack.recorder import driven, recorder, warm, write_course
from benchmarks.attack.samples import parse_once
from benchmarks.attack.syscalls import armed, forked, logged_to, mark, report, scratch, with_shim

COUNT, QUICK = 300, 40
SECTOR = 512
"Bytes that a disk writes whole or not at all."


@dataclass(frozen=True)
class Call:
    """One call that changed or flushed a file, or a mark."""

    what: str
    path: str
    other: str
    number: int
    data: bytes


@dataclass
class File:
    """Writes (offset, data) and truncations (length, None) in order; so many of them are flushed."""

    changes: list[tuple[int, bytes | None]] = field(default_factory=list)
    flushed: int = 0

    def survives(self, rng: np.random.Generator) -> bytes:
        """Bytes after a cut."""
        late = self.changes[self.flushed :]
        share = rng.choice([0.0, 0.5, 1.0])
        kept = self.changes[: self.flushed] + [change for change in late if rng.random() < share]
        if len(kept) > self.flushed and rng.random() < 0.5:
            kept[-1] = _torn(*kept[-1], rng)
        content = bytearray()
        for offset, data in kept:
            if data is None:
                content = bytearray(content[:offset].ljust(offset, b"\0"))
            else:
                content = bytearray(content.ljust(offset, b"\0"))
                content[offset : offset + len(data)] = data
        return bytes(content)


def _torn(offset: int, data: bytes | None, rng: np.random.Generator) -> tuple[int, bytes | None]:
    """A write of which some sectors did not reach the disk, or only the beginning did."""
    if data is None:
        return offset, data
    if rng.random() < 0.5:
        return offset, data[: int(rng.integers(len(data) + 1))]
    torn = bytearray(data)
    for start in range(-(offset % SECTOR), len(data), SECTOR):
        if rng.random() < 0.5:
            part = slice(max(start, 0), min(start + SECTOR, len(data)))
            torn[part] = bytes(part.stop - part.start)
    return offset, bytes(torn)


class Disk:
    """Files and names as calls change them, and what a power cut leaves."""

    def __init__(self) -> None:
        self.files: list[File] = []
        self.now: dict[str, int | None] = {}
        "File by path, None for a folder."
        self.names: list[tuple[Call, int | None, bool]] = []
        "Changes of names in order, the file made, and whether each is flushed."

    def take(self, call: Call) -> None:
        """Do a call."""
        made = None
        if call.what == "create":
            self.files.append(File())
            made = self.now[call.path] = len(self.files) - 1
        elif call.what == "mkdir":
            self.now[call.path] = None
        elif call.what == "rename":
            self.now[call.other] = self.now.pop(call.path)
        elif call.what == "unlink":
            del self.now[call.path]
        elif call.what in ("write", "truncate"):
            index = self.now[call.path]
            assert index is not None
            self.files[index].changes.append((call.number, call.data if call.what == "write" else None))
            return
        elif call.what == "fsync":
            self._flush(call.path)
            return
        else:
            return
        self.names.append((call, made, False))

    def _flush(self, path: str) -> None:
        index = self.now.get(path)
        if index is not None:
            self.files[index].flushed = len(self.files[index].changes)
            return
        for place, (call, made, _) in enumerate(self.names):
            if path in (os.path.dirname(call.path), os.path.dirname(call.other)):
                self.names[place] = (call, made, True)

    def survives(self, rng: np.random.Generator) -> Iterator[tuple[str, bytes | None]]:
        """Paths after a cut with their bytes, None for a folder, a folder before what is in it."""
        share = rng.choice([0.0, 0.5, 1.0])
        there: dict[str, int | None] = {}
        for call, made, flushed in self.names:
            if not flushed and rng.random() >= share:
                continue
            if call.what == "rename":
                if call.path in there:
                    there[call.other] = there.pop(call.path)
            elif call.what == "unlink":
                there.pop(call.path, None)
            else:
                there[call.path] = made
        for path, index in sorted(there.items()):
            yield path, None if index is None else self.files[index].survives(rng)


def calls_of(case: Path) -> list[Call]:
    """What a recorder does on the disk while two of its lives accept four runs and discard two."""
    log = case.with_suffix(".log")

    def life() -> None:
        with log.open("wb") as file:
            logged_to(file.fileno())
            armed(case)
            for _ in range(2):
                game, now = recorder(case), 0.0
                for keep in (True, False, True):
                    now = driven(game, now)
                    if keep:
                        name = game.accept()()
                        mark(f"accepted {name}")
                        game.accepted()
                    else:
                        game.drop(again=False)
                game.close()

    ended = forked(life)
    if ended.code != 0:
        raise RuntimeError(f"the recorder ended with {ended.code}: {ended.err}")
    return list(_parsed(log.read_bytes()))


def _parsed(log: bytes) -> Iterator[Call]:
    place = 0
    while place < len(log):
        end = log.index(b"\n", place)
        what, path, other, number, length = log[place:end].decode().split("\t")
        place = end + 1 + int(length)
        yield Call(what, path, other, int(number), log[end + 1 : place])


def cut(count: int, seed: int) -> Count:
    """Counts of power cuts and of what cannot be explained about them."""
    rng = np.random.default_rng(seed)
    unexplained: list[str] = []
    with scratch() as root:
        case = root / "case"
        warm(root / "warm", lambda warmed: driven(recorder(warmed), 0.0))
        write_course(case)
        calls = calls_of(case)
        for number in range(count):
            after = int(rng.integers(len(calls) + 1))
            disk = Disk()
            for call in calls[:after]:
                disk.take(call)
            shutil.rmtree(case / "out", ignore_errors=True)
            for path, content in disk.survives(rng):
                if content is None:
                    Path(path).mkdir(parents=True)
                elif Path(path).parent.is_dir():
                    Path(path).write_bytes(content)
            accepted = {call.path.split()[1] for call in calls[:after] if call.what == "mark"}
            try:
                wrong = wrong_after(case, accepted, len(calls))
            except Exception as error:
                wrong = f"{type(error).__name__}: {error}"
            if wrong:
                unexplained.append(f"cut {number} after call {after} of {len(calls)}: {wrong}")
                print(unexplained[-1], file=sys.stderr, flush=True)
    return Count("power", "cuts under a recorder, after any system call", count, unexplained, seed=seed)


def attack(asked: Namespace) -> Iterator[Count]:
    """Counts, from a process whose calls are in our hand."""
    count = asked.count or (QUICK if asked.quick else COUNT)
    yield from with_shim("benchmarks.attack.power", [str(count), str(asked.seed)])


if __name__ == "__main__":
    parse_once()
    report(cut(int(sys.argv[1]), int(sys.argv[2])))

"""The dataset that a recorder fills: each run listed as soon as it is accepted, none lost to a crash."""

import fcntl
import os
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from swamp_rl.counted import counted
from swamp_rl.errors import UserError
from swamp_rl.files import flush, os_error, refuse_nameless, validated
from swamp_rl.names import file_in
from swamp_rl.runs import DatasetMeta, Run, RunMeta, adopt_run, create_dataset, read_run
from swamp_rl.runs.copies import standing_alone
from swamp_rl.runs.dataset import META, read_meta
from swamp_rl.teleop.journal import Journal, cut_torn_rows, read_description, write_description

UNFINISHED = "unfinished"
NAME = re.compile(r"run-([0-9]+)")
INTERRUPTED = "interrupted"
"Outcome of a run that was never accepted, because its recorder was stopped."
BOARD = 8
"Places on the leaderboard."
SAME = ("vehicle", "course", "sample_rate", "source")
"What a dataset and those who add to it must agree on."


HALF = ".part-????????-*.*"
"Files that a recorder was writing when it was killed."


def _no_link(path: str, flags: int) -> int:
    """Open neither a link nor, to wait for its other end, a pipe."""
    return os.open(path, flags | os.O_NOFOLLOW | os.O_NONBLOCK, 0o644)


class Recordings:
    """A folder of runs with one writer; runs that a killed recorder left are taken in when it is opened."""

    def __init__(self, folder: Path, meta: DatasetMeta, report: Callable[[str], None]) -> None:
        """UserError where the folder holds another kind of runs, or another recorder writes there."""
        if folder != Path():
            refuse_nameless(folder)
        self.folder, self.unfinished = folder, folder / UNFINISHED
        new = [path for path in (self.unfinished, folder, *folder.parents) if not path.exists()]
        try:
            if not (folder / META).exists():
                create_dataset(folder, meta)
            if self.unfinished.is_symlink():
                raise UserError(f"{self.unfinished}: is a link; remove it, or name another folder")
            self.unfinished.mkdir(exist_ok=True)
            for path in new:  # else a power cut could take the folder with all that is in it
                flush(path.parent)
            self._lock = open(self.unfinished / ".lock", "a", opener=_no_link)  # noqa: SIM115
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise UserError(f"{folder}: another recorder writes there; stop it or name another") from error
        except OSError as error:
            raise os_error(error, folder) from error
        self._refuse_another_kind(meta)
        for left in (*folder.glob(HALF), *self.unfinished.glob(HALF)):
            left.unlink(missing_ok=True)
        for name in self._left_behind():
            self._recover(self.unfinished / f"{name}.json", report)
        self._count_and_board()

    def begin(self, columns: Sequence[str], about: Mapping[str, Any]) -> Journal:
        """A journal under the next free name; UserError where the folder cannot be listed."""
        try:
            taken = [path.stem for path in (*self.folder.iterdir(), *self.unfinished.iterdir())]
        except OSError as error:
            raise os_error(error, self.folder) from error
        numbers = [int(found[1]) for name in taken if (found := NAME.fullmatch(name))]
        return Journal(self.unfinished, f"run-{max(numbers, default=0) + 1:04d}", columns, about)

    def accept(self, journal: Journal, about: Mapping[str, Any]) -> str:
        """Take a finished run into the dataset, on the disk when this returns; its name.

        UserError where the disk refuses; then nothing is lost, and it may be tried again.
        """
        try:
            if self._lists(journal.table.name):
                flush(self.folder)  # an earlier try listed it, and only then failed
            else:
                self._called_back(journal.table)
                journal.close()
                write_description(journal.description, {**about, "accepted": True})
                self._adopt(journal.table, about)
        except BaseException as error:
            with suppress(OSError, UserError):
                self._called_back(journal.table)
            if isinstance(error, OSError):
                raise os_error(error, self.folder) from error
            raise
        with suppress(OSError):  # else it is removed at the next start
            journal.description.unlink()
        self.count += 1
        self._rank(journal.table.stem, about)
        return journal.table.stem

    def discard(self, journal: Journal) -> None:
        """Forget a run that is not accepted, wherever a failed acceptance has left it."""
        moved = self.folder / journal.table.name
        with suppress(OSError, UserError):
            if moved.exists() and not self._lists(moved.name):
                moved.unlink()
        journal.remove()

    def sentence(self) -> str:
        """How many runs were kept, and how many are interrupted and unfinished, in words."""
        left = len(list(self.unfinished.glob("run-*.csv")))
        unfinished = f", {counted(left, 'unfinished run')} to be stored at the next start" if left else ""
        interrupted = f", {self._interrupted} interrupted" if self._interrupted else ""
        return f"{counted(self.count, 'run')}{interrupted}{unfinished}"

    def read(self, name: str) -> Run:
        """The run of that name; UserError if the dataset lists none."""
        for listed in read_meta(self.folder).runs:
            if listed.file is not None and Path(listed.file).stem == name:
                return read_run(self.folder / listed.file)
        raise UserError(f"there is no run {name[:40]!r}")

    def close(self) -> None:
        """Let others write."""
        with suppress(OSError):  # the file is empty, so there is nothing to lose
            self._lock.close()

    def _refuse_another_kind(self, meta: DatasetMeta) -> None:
        there = read_meta(self.folder)
        meta, _ = standing_alone(meta)
        for key in SAME:
            if getattr(there, key) != getattr(meta, key):
                raise UserError(
                    f"{self.folder / META}: {key} is {getattr(there, key)}, but {getattr(meta, key)} "
                    "is to be recorded; name another folder"
                )
        if there.copies and there.copies != meta.copies:
            raise UserError(
                f"{self.folder}: the file of boat {there.vehicle} or of its course has changed since the "
                "first run; name another folder"
            )

    def _left_behind(self) -> list[str]:
        """Names of the runs that an earlier recorder began and neither listed nor removed."""
        listed = self._listed()
        tables = [path.stem for path in self.folder.glob("run-*.csv") if path.name not in listed]
        # A power cut may keep a table and lose the description that was made, or removed, beside it.
        tables += [path.stem for path in self.unfinished.glob("run-*.csv")]
        return sorted(
            {path.stem for path in self.unfinished.glob("*.json")} | set(filter(NAME.fullmatch, tables))
        )

    def _recover(self, description: Path, report: Callable[[str], None]) -> None:
        """Finish what a killed recorder began: list what it had accepted, mark the rest as interrupted."""
        table = description.with_suffix(".csv")
        try:
            about = read_description(file_in(self.unfinished, description.name, (".json",)))
            table = file_in(self.unfinished, table.name, (".csv",))
            accepted = about.pop("accepted", False)
            if not accepted:
                about["outcome"] = INTERRUPTED
            self._called_back(table)
            if table.exists() and cut_torn_rows(table) >= 2:
                self._adopt(table, about)
                report(
                    f"{table.stem}: {'accepted' if accepted else 'never finished'}, taken into the dataset"
                )
            table.unlink(missing_ok=True)
            description.unlink(missing_ok=True)
        except (OSError, UserError) as error:
            report(f"{table}: left as it is; {error}")

    def _called_back(self, table: Path) -> None:
        """Put a run back that was renamed into the dataset but not listed there, because that failed."""
        moved = self.folder / table.name
        if moved.exists() and not table.exists() and not self._lists(moved.name):
            moved.rename(table)

    def _lists(self, file: str) -> bool:
        return file in self._listed()

    def _listed(self) -> set[str | None]:
        """Takes a time that grows with the number of runs."""
        return {run.file for run in read_meta(self.folder).runs}

    def _adopt(self, table: Path, about: Mapping[str, Any]) -> None:
        adopt_run(self.folder, table, validated(table.with_suffix(".json"), RunMeta, about))

    def _count_and_board(self) -> None:
        runs = read_meta(self.folder).runs
        self.count = sum(run.outcome != INTERRUPTED for run in runs)
        self._interrupted = len(runs) - self.count
        self.board: list[dict[str, Any]] = []
        for run in runs:
            self._rank(Path(str(run.file)).stem, run.model_dump())

    def _rank(self, name: str, about: Mapping[str, Any]) -> None:
        """Put a successful run on the board, the fastest first, if it is fast enough."""
        if about.get("outcome") != "success" or not isinstance(about.get("seconds"), float):
            return
        entry = {key: about.get(key) for key in ("nickname", "seconds", "level", "helm")}
        self.board = sorted([*self.board, {"run": name} | entry], key=lambda row: row["seconds"])[:BOARD]

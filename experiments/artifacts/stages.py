"""Progress bars of a long job, how long each of its stages took, and the memory it needed."""

import json
import resource
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from swamp_rl.experiments.artifacts.versions import hardware

from swamp_rl.files import write_text
from swamp_rl.json_text import read_json
from swamp_rl.one_thread import threads
from swamp_rl.pilots.callbacks import Tick


@dataclass(frozen=True)
class Stages:
    """The bars on the screen, and `seconds` by the name of each stage that has ended.

    log: the file that keeps them for a later life of the job; what it holds already is taken over. quiet:
    there is no output, as in one of many trials.
    """

    bars: Any
    seconds: dict[str, float] = field(default_factory=dict)
    log: Path | None = None
    quiet: bool = False

    def say(self, line: str) -> None:
        """A note on the error stream, unless quiet."""
        if not self.quiet:
            say(line)

    def logged_in(self, file: Path) -> "Stages":
        """The same bars with the seconds that `file` keeps, to which each stage's are added from now on."""
        known = read_json(file, "remove it") if file.is_file() else {}
        return replace(self, seconds=known, log=file)

    @contextmanager
    def stage(self, name: str, total: float | None = None) -> Iterator[Tick]:
        """One bar for the time of the block; without `total` it only shows that something goes on."""
        task = self.bars.add_task(name, total=total)
        begin = time.perf_counter()
        yield lambda done: self.bars.update(task, completed=done)
        self.seconds[name] = time.perf_counter() - begin
        if self.log is not None:
            write_text(self.log, json.dumps(self.seconds))
        self.bars.update(task, total=1.0, completed=1.0)


def say(line: str) -> None:
    """A note on the error stream."""
    print("swamp-rl:", line, file=sys.stderr)


@contextmanager
def stages() -> Iterator[Stages]:
    """Bars on the error stream; none, and not a word, where that is not a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description:<34}", markup=False),
        BarColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, disable=not console.is_terminal) as bars:
        yield Stages(bars)


def peak_memory() -> float:
    """Most memory this process has held so far [GB]."""
    # Linux counts kilobytes, macOS bytes.
    unit = 1.0 if sys.platform == "darwin" else 1024.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e9


def measured(progress: Stages) -> dict[str, Any]:
    """What the job took, as results.json has it, and on which machine."""
    return {
        "seconds": {name: round(value, 2) for name, value in progress.seconds.items()},
        "total_seconds": round(sum(progress.seconds.values()), 1),
        "peak_memory_gb": round(peak_memory(), 2),
        "hardware": hardware(),
        "threads": threads(),
    }

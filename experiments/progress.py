"""Progress bars of a long job, how long each of its stages took, and the memory it needed."""

import resource
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

Tick = Callable[[float], None]
"""Told how much of the stage's total is done so far."""


@dataclass(frozen=True)
class Stages:
    """The bars on the screen, and `seconds` by the name of each stage that has ended."""

    bars: Any
    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str, total: float | None = None) -> Iterator[Tick]:
        """One bar for the time of the block; without `total` it only shows that something goes on."""
        task = self.bars.add_task(name, total=total)
        begin = time.perf_counter()
        yield lambda done: self.bars.update(task, completed=done)
        self.seconds[name] = time.perf_counter() - begin
        self.bars.update(task, total=1.0, completed=1.0)


@contextmanager
def stages() -> Iterator[Stages]:
    """Bars on the error stream; none, and not a word, where that is not a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description:<34}"),
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

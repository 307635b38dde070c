"""Progress of a long verb on the terminal."""

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.markup import escape
from rich.status import Status


class _Shown(logging.Handler):
    """Prints stages with the seconds since the start; a terminal's status line has the last record."""

    def __init__(self, console: Console, status: Status) -> None:
        super().__init__(logging.DEBUG)
        self.console, self.status, self.began = console, status, time.perf_counter()

    def emit(self, record: logging.LogRecord) -> None:
        """Print a stage, show anything else in the status line."""
        line = f"{time.perf_counter() - self.began:5.0f} s  {record.getMessage()}"
        if record.levelno >= logging.INFO:
            self.console.print(line, markup=False, soft_wrap=True)
        elif self.console.is_terminal:
            self.status.update(escape(line))


@contextmanager
def progress(logger: logging.Logger) -> Iterator[None]:
    """Show the records of `logger` while the block runs."""
    console = Console(highlight=False)
    level = logger.level
    with console.status("") as status:
        handler = _Shown(console, status)
        logger.addHandler(handler)
        logger.setLevel(logging.DEBUG)
        try:
            yield
        finally:
            logger.removeHandler(handler)
            logger.setLevel(level)

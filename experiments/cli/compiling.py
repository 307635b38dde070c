"""The one line that a terminal shows while the simulator is compiled."""

import logging
import sys

LOGGER = "swamp_rl.physics.compile"
"""Of `swamp_rl.physics.compile`, which takes half a second to import."""


class _Line(logging.Handler):
    """Prints a record on the error stream, as it is at that moment: a status line may stand in its place."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print it."""
        print("swamp-rl:", record.getMessage(), file=sys.stderr)


def show_compiling() -> None:
    """Say on the error stream, where that is a terminal, that compiling takes a while, before it does."""
    logger = logging.getLogger(LOGGER)
    if sys.stderr.isatty() and not logger.handlers:
        logger.addHandler(_Line())
        logger.setLevel(logging.INFO)

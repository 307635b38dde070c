"""The command line: a file for each verb or group of verbs."""

import sys
from collections.abc import Callable
from typing import Any


def main(stopped: Callable[[int], Any] = sys.exit) -> None:
    """Run the command line; Ctrl-C ends it in one line, be it while its verbs are imported.

    stopped: ends the process with an exit code where a signal has ended the verb.
    """
    try:
        from swamp_rl.experiments.cli import app
    except KeyboardInterrupt:
        print("swamp-rl: interrupted before it began", file=sys.stderr)
        sys.exit(130)
    app.main(stopped)


__all__ = ["main"]

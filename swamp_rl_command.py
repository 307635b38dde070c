"""The command `swamp-rl`: outside the package, so that Ctrl-C while that is imported is one line as well."""

import atexit
import os
import signal
import sys
import warnings
from contextlib import suppress
from typing import Any, NoReturn

EARLY = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated", signal.SIGHUP: "hung up"}


def main() -> None:
    """Run the command line; a signal before its verbs are there ends it in one line, after them in none.

    Warnings of libraries, about which its user can do nothing, are not printed, unless Python's own option
    asks for them.
    """
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
        os.environ["PYTHONWARNINGS"] = "ignore"  # of the processes that the command starts
    code: list[int] = []
    atexit.register(_last, code)  # the first to be registered is the last to be called
    for number in EARLY:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _before)
    try:
        try:
            from swamp_rl.experiments.cli import main as command
        except KeyboardInterrupt:
            print("swamp-rl: interrupted before it began", file=sys.stderr)
            sys.exit(130)
        command(_at_once)
    except SystemExit as ended:
        if isinstance(ended.code, int):
            code.append(ended.code)
        raise
    finally:  # while Python ends, it would print where it was
        for number in EARLY:
            if signal.getsignal(number) == _before:
                signal.signal(number, signal.SIG_DFL)


def _before(number: int, frame: Any) -> None:
    """End the process: nothing is begun. An exception could be lost in what is being imported."""
    os.write(2, f"swamp-rl: {EARLY[signal.Signals(number)]} before it began\n".encode())
    os._exit(128 + number)


def _last(code: list[int]) -> None:
    """End the process once all that Python ends is ended.

    What the system would still end are the threads of libraries: one that Arrow had begun aborted up to nine
    of a hundred commands (SIGABRT) after they were done.
    """
    if code:
        _at_once(code[0])


def _at_once(code: int) -> NoReturn:
    """End the process whose verb has ended, and which has cleared away what it had begun."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)

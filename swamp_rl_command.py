"""The command `swamp-rl`: outside the package, so that Ctrl-C while that is imported is one line as well."""

import signal
import sys


def main() -> None:
    """Run the command line; Ctrl-C before its verbs are there ends it in one line, after them in none."""
    try:
        from swamp_rl.experiments.cli import main as command
    except KeyboardInterrupt:
        print("swamp-rl: interrupted before it began", file=sys.stderr)
        sys.exit(130)
    try:
        command()
    finally:  # while Python ends, it would print where it was
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_DFL)

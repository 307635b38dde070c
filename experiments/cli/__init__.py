"""The command line: a file for each verb or group of verbs."""

import sys


def main() -> None:
    """Run the command line; Ctrl-C ends it in one line, be it while its verbs are imported."""
    try:
        from swamp_rl.experiments.cli import app
    except KeyboardInterrupt:
        print("swamp-rl: interrupted before it began", file=sys.stderr)
        sys.exit(130)
    app.main()


__all__ = ["main"]

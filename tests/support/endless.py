"""The command `swamp-rl` with a verb that works in two processes without end, for tests that interrupt it.

python -m tests.support.endless endless NOTES [--keeps]

NOTES is a folder: the verb builds NOTES/out, each worker leaves its process's number in NOTES/at-work, and
the verb, once it is interrupted, NOTES/ending. It ends when NOTES/end is there. With --keeps it is one that a
signal ends well, and leaves NOTES/kept. A worker that is imported while NOTES/slow is there leaves its number
in that folder, and goes on when that is renamed.
"""

import os
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path


def work(job: str) -> str:
    """Without end, and with a temporary file."""
    notes = Path(job)
    Path(tempfile.mkdtemp(), "half").touch()
    (notes / "at-work" / str(os.getpid())).touch()
    while True:
        time.sleep(1.0)


def endless(notes: Path, keeps: bool = False) -> None:
    """A verb as any other, but for its end."""
    import typer

    from swamp_rl.unfinished import folder_beside
    from swamp_rl.workers import answers

    (notes / "at-work").mkdir()
    expected = (KeyboardInterrupt,) if keeps else ()
    with folder_beside(notes / "out") as part, suppress(*expected):
        (part / "half").touch()
        try:
            list(answers(work, [str(notes)] * 2, 2))
        finally:
            (notes / "ending").touch()
            while not (notes / "end").exists():
                time.sleep(0.005)
    typer.echo("kept")
    (notes / "kept").touch()


def main() -> None:
    from swamp_rl.experiments.cli.app import app

    from swamp_rl_command import main as command

    app.command()(endless)
    command()


if __name__ == "__main__":
    main()
elif __name__ == "__mp_main__":
    slow = Path(sys.argv[2], "slow")
    with suppress(OSError):
        (slow / str(os.getpid())).touch()
    while slow.exists():
        time.sleep(0.005)

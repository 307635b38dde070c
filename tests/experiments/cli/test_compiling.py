"""The line that says that the simulator is being compiled: at a terminal, once, and only when it is."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

COMMAND = [sys.executable, "-c", "from swamp_rl_command import main; main()"]
SAID = b"swamp-rl: compiling the simulator"


def error_of_a_terminal(words: list[str], cache: Path) -> bytes:
    """What a command writes to the error stream, where that is a terminal."""
    ours, theirs = pty.openpty()
    try:
        subprocess.run(
            [*COMMAND, *words],
            env={**os.environ, "XDG_CACHE_HOME": str(cache)},
            stdout=subprocess.DEVNULL,
            stderr=theirs,
            check=True,
        )
        os.set_blocking(ours, False)
        try:
            return os.read(ours, 65536)
        except BlockingIOError:
            return b""
    finally:
        os.close(theirs)
        os.close(ours)


@pytest.mark.slow
def test_the_first_use_says_at_a_terminal_that_it_compiles_and_the_second_does_not(tmp_path: Path) -> None:
    words = ["mission", "survey"]
    first = error_of_a_terminal(words, tmp_path)
    assert first.startswith(SAID) and len(first.splitlines()) == 1
    assert error_of_a_terminal(words, tmp_path) == b""


def test_a_verb_without_a_simulation_says_nothing(tmp_path: Path) -> None:
    assert error_of_a_terminal(["courses"], tmp_path) == b""

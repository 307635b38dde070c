"""The command line, called in this process."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from swamp_rl.experiments.cli import app as cli

Called = tuple[int, str, str]

COMMAND = str(Path(sys.executable).with_name("swamp-rl"))
"""The installed command, for a test that needs it in a process of its own."""


Call = Callable[..., Called]


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    """Call the command line from an empty folder; exit code, output, error output."""
    monkeypatch.chdir(tmp_path)

    def called(*words: object) -> Called:
        monkeypatch.setattr(sys, "argv", ["swamp-rl", *map(str, words)])
        with pytest.raises(SystemExit) as stop:
            cli.main()
        message = capsys.readouterr()
        return int(stop.value.code or 0), message.out, message.err

    return called


def assert_complains(called: Called, *parts: str, code: int = cli.BAD_INPUT) -> None:
    assert called[0] == code
    assert len(called[2].splitlines()) == 1
    assert called[2].startswith("swamp-rl: ")
    assert all(part in called[2] for part in parts), called[2]

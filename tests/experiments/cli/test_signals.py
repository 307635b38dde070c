"""Ctrl-C, SIGTERM and SIGHUP, once and again: a second one does not interrupt what the first one ends."""

import os
import pty
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import psutil
import pytest
from swamp_rl.experiments.cli import signals
from swamp_rl.experiments.cli.signals import heed_no_more, stoppable

from swamp_rl.workers.signals import held
from tests.support.command_line import Call
from tests.support.pages import ROOT
from tests.support.patience import PATIENCE, until

ENDED = {
    signal.SIGINT: (130, "interrupted"),
    signal.SIGTERM: (143, "terminated"),
    signal.SIGHUP: (129, "hung up"),
}


@pytest.mark.parametrize("second", signals.SIGNALS)
def test_a_second_signal_does_not_interrupt_what_the_first_one_ends(second: int) -> None:
    switched_off = False
    with stoppable() as came, pytest.raises(KeyboardInterrupt):
        try:
            signal.raise_signal(signal.SIGINT)
        finally:
            signal.raise_signal(second)
            switched_off = True
    assert switched_off
    assert came == [signal.SIGINT, second]


def test_a_signal_after_the_grace_interrupts_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(signals, "GRACE", 0.0)
    with stoppable() as came:
        for _ in range(2):
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
    assert came == [signal.SIGINT] * 2


def test_a_hang_up_that_was_ignored_before_stays_ignored() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as by nohup
    try:
        with stoppable() as came:
            signal.raise_signal(signal.SIGHUP)
            heed_no_more()
            assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
        assert came == []
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize("number", signals.SIGNALS)
def test_nothing_interrupts_the_last_line_of_a_command(number: int) -> None:
    with stoppable():
        heed_no_more()
        signal.raise_signal(number)


@pytest.mark.parametrize("number", signals.SIGNALS)
def test_a_signal_while_a_process_starts_is_heeded_once_it_is_known(number: int) -> None:
    known = False
    with stoppable() as came, pytest.raises(KeyboardInterrupt), held():
        signal.raise_signal(number)
        known = True
    assert known and came == [number]


@pytest.mark.parametrize("number", signals.SIGNALS)
def test_a_signal_lost_in_an_import_still_ends_the_command_in_one_line(number: int, tmp_path: Path) -> None:
    losing = f"import os\ntry:\n    os.kill(os.getpid(), {number:d})\nexcept BaseException:\n    pass\n"
    (tmp_path / "gymnasium.py").write_text(losing)  # the first library that the package imports
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    called = subprocess.run(
        [sys.executable, "-c", "from swamp_rl_command import main; main()", "--version"],
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    code, word = ENDED[signal.Signals(number)]
    assert called.returncode == code
    assert (called.stdout, called.stderr) == ("", f"swamp-rl: {word} before it began\n")


ABORTED = """
import atexit, ctypes, sys
from swamp_rl.experiments import cli

def ends(stopped):
    libc = ctypes.CDLL(None)
    libc.__cxa_atexit(libc.abort, None, None)  # as a library's thread may, which the system ends
    atexit.register(print, "ended in order")
    sys.exit(3)

cli.main = ends
from swamp_rl_command import main
main()
"""


def test_a_library_that_aborts_while_the_process_ends_does_not_change_the_exit_code() -> None:
    called = subprocess.run(
        [sys.executable, "-c", ABORTED], cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE
    )
    assert (called.returncode, called.stdout, called.stderr) == (3, "ended in order\n", "")


WARNS = """
import sys, warnings
from swamp_rl.experiments import cli

def warned(stopped):
    warnings.warn("identical limits", UserWarning)
    sys.exit(0)

cli.main = warned
from swamp_rl_command import main
main()
"""


@pytest.mark.parametrize(("asked", "printed"), [((), False), (("-W", "default"), True)])
def test_warnings_of_libraries_are_printed_only_where_python_is_asked_for_them(
    asked: tuple[str, ...], printed: bool
) -> None:
    called = subprocess.run(
        [sys.executable, *asked, "-c", WARNS], cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE
    )
    assert (called.returncode, "identical limits" in called.stderr) == (0, printed)


@contextmanager
def endless(notes: Path, *more: str, terminal: int | None = None) -> Iterator[subprocess.Popen[str]]:
    """The verb of `tests.support.endless` in a session of its own, temporary files in `notes`/tmp."""
    (notes / "tmp").mkdir()
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.support.endless", "endless", str(notes), *more],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT), "TMPDIR": str(notes / "tmp")},
        stdin=terminal,
        stdout=terminal or subprocess.PIPE,
        stderr=terminal or subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=None if terminal is None else lambda: os.close(os.open(os.ttyname(0), os.O_RDWR)),
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def numbers(folder: Path, process: subprocess.Popen[str]) -> list[int]:
    """The numbers that both worker processes have left in a folder."""

    def both() -> bool:
        assert process.poll() is None, process.communicate()
        return folder.is_dir() and len(list(folder.iterdir())) == 2

    until(both, f"two workers are in {folder.name}")
    return [int(path.name) for path in folder.iterdir()]


def assert_nothing_left(notes: Path, workers: list[int]) -> None:
    assert list(notes.glob(".part-*")) == list((notes / "tmp").iterdir()) == []
    until(lambda: not any(map(alive, workers)), "the workers have ended")


def alive(number: int) -> bool:
    """Whether a process is there, and not only its exit status."""
    with suppress(psutil.NoSuchProcess):
        return psutil.Process(number).status() != psutil.STATUS_ZOMBIE
    return False


@pytest.mark.parametrize(
    ("words", "message"), [(["run", "smoke"], "; the same command resumes"), (["bench"], "")]
)
def test_ctrl_c_tells_whether_the_same_command_resumes(
    words: list[str], message: str, call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("swamp_rl.experiments.studies.run.run_experiment", interrupted)
    monkeypatch.setattr("swamp_rl.experiments.studies.speed.run_bench", interrupted)
    line = call(*words)[2]
    assert line == f"swamp-rl: interrupted; only what was finished is kept{message}\n"


@pytest.mark.timed
@pytest.mark.parametrize(
    ("first", "second"),
    [(signal.SIGINT, signal.SIGINT), (signal.SIGTERM, signal.SIGINT), (signal.SIGHUP, signal.SIGTERM)],
)
def test_a_command_asked_twice_to_end_says_one_line_and_leaves_neither_processes_nor_files(
    first: int, second: int, tmp_path: Path
) -> None:
    with endless(tmp_path) as process:
        workers = numbers(tmp_path / "at-work", process)
        os.killpg(process.pid, first)
        until((tmp_path / "ending").exists, "the first signal is heeded")
        os.killpg(process.pid, second)
        (tmp_path / "end").touch()
        result = process.communicate(timeout=PATIENCE)
    code, word = ENDED[signal.Signals(first)]
    assert result == ("", f"swamp-rl: {word}; only what was finished is kept\n")
    assert process.returncode == code
    assert not (tmp_path / "out").exists()
    assert_nothing_left(tmp_path, workers)


@pytest.mark.timed
def test_worker_processes_that_are_still_starting_do_not_heed_ctrl_c(tmp_path: Path) -> None:
    (tmp_path / "end").touch()
    (tmp_path / "slow").mkdir()
    with endless(tmp_path) as process:
        starting = numbers(tmp_path / "slow", process)
        for number in starting:
            os.kill(number, signal.SIGINT)
        (tmp_path / "slow").rename(tmp_path / "fast")
        assert sorted(numbers(tmp_path / "at-work", process)) == sorted(starting)
        os.killpg(process.pid, signal.SIGINT)
        result = process.communicate(timeout=PATIENCE)
    assert result == ("", "swamp-rl: interrupted; only what was finished is kept\n")
    assert process.returncode == 130
    assert_nothing_left(tmp_path, starting)


@pytest.mark.timed
@pytest.mark.parametrize("number", signals.SIGNALS)
def test_of_a_verb_that_a_signal_ends_in_order_only_ctrl_c_is_the_ordinary_end(
    number: int, tmp_path: Path
) -> None:
    (tmp_path / "end").touch()
    with endless(tmp_path, "--keeps") as process:
        numbers(tmp_path / "at-work", process)
        os.kill(process.pid, number)
        out, result = process.communicate(timeout=PATIENCE)
    code, word = ENDED[signal.Signals(number)]
    assert out == "kept\n" and (tmp_path / "kept").exists()
    ordinary = number == signal.SIGINT
    assert (process.returncode, result) == (
        (0, "") if ordinary else (code, f"swamp-rl: {word}; ended in order\n")
    )


@pytest.mark.timed
def test_what_a_command_keeps_it_keeps_when_its_terminal_is_closed(tmp_path: Path) -> None:
    ours, theirs = pty.openpty()
    (tmp_path / "end").touch()
    with endless(tmp_path, "--keeps", terminal=theirs) as process:
        os.close(theirs)
        workers = numbers(tmp_path / "at-work", process)
        os.close(ours)  # the system hangs up
        assert process.wait(timeout=PATIENCE) == 129
    assert (tmp_path / "kept").exists() and (tmp_path / "out" / "half").exists()
    assert_nothing_left(tmp_path, workers)

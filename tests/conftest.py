"""Fixtures that several test files share: a browser, and a folder of runs."""

import gc
import importlib
import os
import shutil
import signal
import tempfile
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from _pytest.nodeid import coerce_node_id
from hypothesis import settings
from playwright.sync_api import Browser, sync_playwright

from swamp_rl.runs import Run, RunMeta, append_run, create_dataset
from tests.support.runs import circling, described
from tests.support.tiny_experiment import empty_figures

# Compiled functions make a first example slow; the number of examples bounds the time instead.
# The examples are the same in every run, so that a failure comes again; those of `search` are not.
settings.register_profile("swamp", deadline=None, max_examples=40, derandomize=True, print_blob=True)
settings.register_profile("search", deadline=None, max_examples=400, print_blob=True)
settings.load_profile("swamp")

FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


def pytest_configure(config: pytest.Config) -> None:
    """Have the scheduler keep the order of the tests, and not put large groups before the slow tests."""
    config.option.loadscopereorder = False
    _heed_signals()


def _heed_signals() -> None:
    """Have commands that tests start and interrupt be interrupted where this process ignores it (nohup, &).

    What is ignored here would be ignored by them too; what is handled here is theirs to decide.
    """
    for number in (signal.SIGINT, signal.SIGHUP):
        if signal.getsignal(number) == signal.SIG_IGN:
            signal.signal(number, lambda *_: None)


def pytest_sessionstart(session: pytest.Session) -> None:
    """Have the first worker of the whole suite compile what nearly every test runs, and each of the others
    import the test modules from another one on.

    Both are left on the disk, the modules as pytest compiles them, with their assertions: so everything is
    compiled once. What fails is reported when it is collected or tested.
    """
    whole = session.config.args_source == pytest.Config.ArgsSource.TESTPATHS
    worker, count = (os.environ.get(f"PYTEST_XDIST_WORKER{name}", "") for name in ("", "_COUNT"))
    if not whole or not worker:
        return
    if worker == "gw0":
        with suppress(Exception):
            importlib.import_module("tests.support.compiled_first").compile_first()
        return
    root = session.config.rootpath
    files = [file for path in session.config.args for file in sorted((root / path).rglob("test_*.py"))]
    first = (int(worker.removeprefix("gw")) - 1) * len(files) // (int(count) - 1)
    for file in files[first:] + files[:first]:
        with suppress(Exception, pytest.skip.Exception):
            importlib.import_module(".".join(file.relative_to(root).with_suffix("").parts))


def pytest_collection_finish() -> None:
    """What is imported by now stays: it is not looked through for garbage again and again."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 10)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Tests of a file go to one worker, which makes and compiles once what they share; slow ones that share
    no fixture go to any.

    Those marked slow come first, then those marked timed, which wait, then the files with the most tests: no
    worker ends with a long one while the other has nothing left. The group ends the test's name, which is
    where the scheduler reads it: pytest-xdist 3.8 writes it into an attribute that pytest 9.2 no longer has.
    """
    if not config.getoption("loadgroup", False):
        return
    groups = {item: group_of(item) for item in items}
    sizes = Counter(groups.values())
    items.sort(key=lambda item: (not has(item, "slow"), not has(item, "timed"), -sizes[groups[item]]))
    for item, group in groups.items():
        if group and not item.nodeid.endswith(f"@{group}"):
            item._id = coerce_node_id(f"{item.nodeid}@{group}")  # type: ignore[attr-defined]


def has(item: pytest.Item, marker: str) -> bool:
    return item.get_closest_marker(marker) is not None


def group_of(item: pytest.Item) -> str:
    """What goes to one worker with it; empty for a slow test that goes to any."""
    known = item._fixtureinfo.name2fixturedefs if isinstance(item, pytest.Function) else {}
    shared = any(made.scope == "module" for every in known.values() for made in every)
    mark = item.get_closest_marker("xdist_group")
    return mark.args[0] if mark else item.location[0] if shared or not has(item, "slow") else ""


@pytest.fixture(scope="session", autouse=True)
def logs_of_stable_baselines3(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """A folder for the loggers of models that tests train by stable-baselines3 alone."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SB3_LOGDIR", str(tmp_path_factory.mktemp("sb3")))
        yield


@pytest.fixture(scope="session", autouse=True)
def unflushed() -> Iterator[None]:
    """Files are not flushed to the disk, which no test of this process could see, and all would wait for."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", os.fstat)
        yield


@pytest.fixture
def no_figures() -> Iterator[None]:
    """The figures of results and of diagnoses are empty files; tests of their own look at them."""
    with empty_figures():
        yield


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The temporary directory and the working directory, empty, and no other for stable-baselines3."""
    monkeypatch.delenv("SB3_LOGDIR")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="session")
def chromium() -> str:
    """The browser of every test that needs one: without it they are skipped, but fail where CI is set."""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if found := shutil.which(name):
            return found
    message = "chromium is not installed; the pages are not tested (Debian: apt-get install chromium)"
    if os.environ.get("CI"):
        pytest.fail(message)
    pytest.skip(message)


@pytest.fixture(scope="module")
def browser(chromium: str) -> Iterator[Browser]:
    """Started once for a file of tests, calling nobody."""
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        yield started
        started.close()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A dataset of two runs, the first CSV and successful, the second Parquet and failed."""
    folder = tmp_path / "runs"
    create_dataset(folder, described())
    append_run(folder, Run("one", circling(), RunMeta(seed=1, outcome="success")), "csv")
    append_run(folder, Run("two", circling(start=2.0), RunMeta(seed=2, outcome="buoy")), "parquet")
    return folder

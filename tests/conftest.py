"""Fixtures that several test files share: a browser, and a folder of runs."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings
from playwright.sync_api import Browser, sync_playwright

from swamp_rl.runs import Run, RunMeta, append_run, create_dataset
from tests.support.runs import circling, described

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

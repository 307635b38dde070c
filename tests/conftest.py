"""What several test files share: a boat's run that is right in every column, and a folder of such runs."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings
from numpy.typing import NDArray
from playwright.sync_api import Browser, sync_playwright

from swamp_rl.runs import DatasetMeta, Run, RunMeta, append_run, create_dataset

# Compiled functions make a first example slow; the number of examples bounds the time instead.
settings.register_profile("swamp", deadline=None, max_examples=40)
settings.load_profile("swamp")

THRUSTERS = ("bs", "bp", "ss", "sp")
SAMPLE_RATE = 10.0
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


def circling(seconds: float = 3.0, start: float = 0.0) -> dict[str, NDArray[np.float64]]:
    """Columns of a boat on a circle of 2 m at 0.5 m/s, with every thruster commanded."""
    time = np.arange(round(seconds * SAMPLE_RATE) + 1) / SAMPLE_RATE
    course = start + 0.25 * time
    columns = {
        "time": time,
        "north": 2.0 * np.sin(course),
        "east": -2.0 * np.cos(course),
        "heading": np.pi - np.mod(np.pi - course, 2.0 * np.pi),
        "surge": np.full_like(time, 0.5),
        "sway": np.zeros_like(time),
        "yaw_rate": np.full_like(time, 0.25),
    }
    columns |= {f"azimuth_{name}": 0.3 * np.sin(time) for name in THRUSTERS}
    columns |= {f"throttle_{name}": 0.5 + 0.1 * np.cos(time) for name in THRUSTERS}
    return columns | {"joy_thrust": 0.5 + 0.1 * np.cos(time), "joy_angle": 0.2 * np.sin(time)}


def described(**changes: object) -> DatasetMeta:
    """A `dataset.yaml` for the runs of `circling`."""
    values = {
        "vehicle": "swamp",
        "mass": 58.0,
        "draught": 0.14,
        "water_density": 1025.0,
        "sample_rate": SAMPLE_RATE,
        "source": "simulated",
        "course": "camogli",
    }
    return DatasetMeta.model_validate(values | changes)


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

"""How long tests wait for what is to happen: so long that only what hangs fails, however busy the machine."""

import os
import time
from collections.abc import Callable

from playwright.sync_api import Page

PATIENCE = float(os.environ.get("SWAMP_RL_PATIENCE", "300"))
"""Seconds. Nothing waits for it to pass, so it costs time where a test fails only."""


def until(holds: Callable[[], bool], what: str) -> None:
    """Wait until it holds; AssertionError, with what was waited for, where it never does."""
    last = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < last, f"in {PATIENCE:g} s it never came that {what}"
        time.sleep(0.005)


def patient(page: Page) -> Page:
    """The page, whose every wait is as long."""
    page.set_default_timeout(1000.0 * PATIENCE)
    return page

"""Rerun's own viewer, as `demo --web` serves it, in a real browser: the blueprint is what is seen first.

Chromium draws it without a graphics card, which takes it a while. The picture is left in the test's folder.
"""

import io
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import ViewportSize, sync_playwright

from tests.support.demo import dataset, started
from tests.support.patience import PATIENCE, patient

pytestmark = [pytest.mark.slow, pytest.mark.timed]

FLAGS = [
    "--headless=new",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
]
SIZE: ViewportSize = {"width": 1000, "height": 600}
CHART, SEA = (18, 34, 48), (30, 70, 105)
ENOUGH = (0.5, 0.4, 0.5)  # of each view; they are painted one after another, so all are waited for


def share(picture: np.ndarray, colour: tuple[int, ...]) -> float:
    """Of the picture (H, W, 3) that has about that colour."""
    return float((np.abs(picture.astype(int) - colour).max(axis=2) < 24).mean())


def parts(picture: np.ndarray) -> tuple[float, float, float]:
    """How much of the chart, of the space view and of the series is painted in its own ground's colour."""
    left, right = np.split(picture, [round(5 / 11 * picture.shape[1])], axis=1)
    above, below = np.split(right, 2)
    return share(left, CHART), share(above, SEA), share(below, (255, 255, 255))


def test_the_web_viewer_shows_chart_space_and_series_at_first_sight(tmp_path: Path, chromium: str) -> None:
    folder = dataset(tmp_path / "runs", "scripted", ["x", "y"])
    process = started("demo", folder, "--web")
    assert process.stdout is not None
    try:
        process.stdout.readline()
        address = process.stdout.readline()
        with sync_playwright() as browsers:
            browser = browsers.chromium.launch(executable_path=chromium, args=FLAGS)
            page = patient(browser.new_page(viewport=SIZE))
            wrong: list[str] = []
            page.on("pageerror", lambda error: wrong.append(str(error)))
            page.goto(address)
            until = time.monotonic() + PATIENCE
            seen = (0.0, 0.0, 0.0)
            while not np.all(np.array(seen) > ENOUGH) and time.monotonic() < until:
                page.wait_for_timeout(1000)
                data = page.screenshot(path=tmp_path / "web.png", timeout=1000.0 * PATIENCE)
                seen = parts(np.asarray(Image.open(io.BytesIO(data)).convert("RGB")))
            browser.close()
    finally:
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=PATIENCE)
    assert wrong == []
    assert np.all(np.array(seen) > ENOUGH), dict(zip(("chart", "space", "series"), seen, strict=True))

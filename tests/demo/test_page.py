"""The animated page: complete in itself, its names never markup, its numbers those of the runs."""

import json
import re
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import sync_playwright

from swamp_rl.constants import SWAMP_LENGTH
from swamp_rl.course import fitted, load_course
from swamp_rl.demo.page import STEP, page, write_page
from swamp_rl.demo.scene import DemoScene, demo_scene
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, RunMeta
from tests.support.patience import patient, until
from tests.support.runs import circling

pytestmark = [pytest.mark.slow, pytest.mark.timed]

NUMBERS = """
window.written = [];
const fill = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
  if (this.canvas.parentElement.id === "plots" && this.textAlign === "right") window.written.push([text, y]);
  fill.call(this, text, x, y);
};
"""  # remembers the heights of the numbers beside the plots, in the order in which they are drawn
NASTY = """</script><img src=x onerror="document.title='pwned'">&amp;'"""


def scene(title: str = "race", group: str = "human") -> DemoScene:
    meta = RunMeta(outcome="success", disturbances=[{"effect": "current", "north": 0.2}])
    runs = {group: [Run(NASTY, circling(), meta)], "ppo": [Run("b", circling(start=1.0), meta)]}
    return demo_scene(title, runs, load_course("camogli"), (1.24, 1.1))


def data_of(text: str) -> dict[str, Any]:
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.DOTALL)
    assert found
    return json.loads(found[1])


def test_the_page_holds_the_tracks_to_the_centimetre() -> None:
    data = data_of(page(scene()))
    columns = circling()
    every = round(STEP * 10)
    run = data["runs"][0]
    assert run["north"] == pytest.approx(columns["north"][::every], abs=0.0051)
    assert run["east"] == pytest.approx(columns["east"][::every], abs=0.0051)
    assert run["panels"]["speed over ground [m/s]"] == pytest.approx(np.full(len(run["north"]), 0.5))
    assert run["flows"]["current"][0] == [0.2] * len(run["north"])
    assert [gate["name"] for gate in data["gates"]] == ["green", "red"]


def test_symbols_grow_with_the_boat_as_its_course_does() -> None:
    course, runs = load_course("camogli"), {"human": [Run("a", circling())]}
    for times in (0.25, 1.0, 16.0):
        size, laid_out = times * SWAMP_LENGTH, fitted(course, times * SWAMP_LENGTH, 10.0)
        data = data_of(page(demo_scene("a", runs, laid_out, (size, size))))
        assert data["scale"] == pytest.approx(times)
        assert data["gates"][0]["radius"] == pytest.approx(times * course.buoy_radius)


def test_the_page_needs_no_other_file_and_may_load_none() -> None:
    course = load_course("camogli")
    text = page(demo_scene("a", {"human": [Run("a", circling())]}, course, (1.0, 1.0)))
    assert not re.search(r"(?:src|href)\s*=|@import|url\(|https?:|fetch\(|XMLHttp|import\(", text)
    assert "default-src 'none'" in text


def test_names_stay_data_whatever_they_hold() -> None:
    text = page(scene(NASTY, NASTY))
    assert "<img" not in text
    data = data_of(text)
    assert data["title"] == NASTY and data["groups"][0]["name"] == NASTY
    assert text.count("</script>") == 2


def test_a_page_that_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "a.html").mkdir()
    with pytest.raises(UserError):
        write_page(tmp_path / "a.html", scene())
    assert [path.name for path in tmp_path.iterdir()] == ["a.html"]


def test_in_a_browser_it_plays_pauses_seeks_and_changes_its_layout(tmp_path: Path, chromium: str) -> None:
    write_page(tmp_path / "a.html", scene(NASTY, NASTY))
    with sync_playwright() as browsers:
        browser = browsers.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        tab = patient(browser.new_page(viewport={"width": 1200, "height": 700}))
        wrong: list[str] = []
        asked: list[str] = []
        tab.on("pageerror", lambda error: wrong.append(str(error)))
        tab.on("console", lambda message: wrong.append(message.text) if message.type == "error" else None)
        tab.on("request", lambda request: asked.append(request.url))
        tab.add_init_script(NUMBERS)
        tab.goto(f"{(tmp_path / 'a.html').as_uri()}#t=1.5")
        assert tab.title() == NASTY and tab.inner_text("h1") == NASTY
        assert tab.inner_text("#now").startswith("1.5 s")
        overlay = tab.screenshot()
        tab.click("#layout")
        assert tab.inner_text("#layout") == "Overlay"
        assert tab.screenshot() != overlay
        tab.keyboard.press("Tab")
        tab.evaluate("document.activeElement.blur()")
        tab.keyboard.press("ArrowRight")
        assert tab.inner_text("#now").startswith("2.5 s")
        tab.click("#play")
        until(  # the page's own policy forbids the evaluation that wait_for_function does in it
            lambda: float(tab.input_value("#slider")) > 2.6 or tab.inner_text("#now").startswith("0."),
            "it plays on",
        )
        tab.click("#play")
        assert tab.inner_text("#play") == "Play"
        tab.set_viewport_size({"width": 390, "height": 760})
        assert tab.evaluate("document.documentElement.scrollWidth") == 390
        assert tab.is_visible("#play")
        tab.screenshot(path=tmp_path / "phone.png")
        tab.evaluate("window.written = []")
        tab.set_viewport_size({"width": 844, "height": 390})
        until(lambda: tab.evaluate("window.written.length") > 0, "it is drawn anew")
        heights = [y for _, y in tab.evaluate("window.written")]
        browser.close()
    assert min(abs(one - other) for one, other in combinations(sorted(set(heights)), 2)) >= 12
    assert wrong == []
    assert len(asked) == 1 and asked[0].startswith("file:")

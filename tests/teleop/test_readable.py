"""The recorder's page can be read, and at a run's end no panel lies over the boat and the gates."""

import io
import re
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Browser, Page

from swamp_rl.course import load_course
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.teleop.lookout import Lookout
from tests.support.patience import patient
from tests.support.recorder import GREAT_HASTE, serving

pytestmark = [pytest.mark.slow, pytest.mark.timed]

SIZES = {"desktop": (1280, 800), "phone across": (844, 390), "phone upright": (390, 844)}
# What canvases write, beside the page's own words.
NOTED = """
window.sizes = [];
const write = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (...words) {
  if (sizes.length < 1000) sizes.push(parseFloat(this.font.match(/([\\d.]+)px/)[1]));
  return write.apply(this, words);
};
"""
COVERED = """(buoys) => {
  const below = document.getElementById("choices").getBoundingClientRect().bottom;
  return [swamp.frame.pose, ...buoys].map((place) => swamp.place(...place)).filter(
    ([x, y]) => y < below + 8 || document.elementFromPoint(x, y)?.id !== "chart");
}"""
UNDER_BANNER = """() => {
  const edges = (id) => document.getElementById(id).getBoundingClientRect();
  const one = edges("banner");
  const beside = (box) => one.left >= box.right || box.left >= one.right;
  return ["chase", "dials", "watch"].filter((id) => !beside(edges(id)) && edges(id).bottom > one.top);
}"""
# Text of the page that can be seen: [words, colour, size, left, top, right, bottom].
WORDS = """() => [...document.querySelectorAll("body *")].flatMap((element) => {
  const empty = element.placeholder && !element.value;
  const text = [...element.childNodes].filter((node) => node.nodeType === 3).map((node) => node.data.trim());
  const own = empty ? element.placeholder : element.localName === "select" ? element.value : text.join("");
  const style = getComputedStyle(element, empty ? "::placeholder" : null);
  const box = element.getBoundingClientRect();
  const size = parseFloat(style.fontSize);
  const shown = element.checkVisibility({ visibilityProperty: true }) && box.width && size;
  if (!own || !shown || element.matches("option, #said, :disabled")) return [];
  return [[own, style.color, size, box.left, box.top, box.right, box.bottom]];
})"""
HIDDEN = "body *, ::placeholder { color: transparent !important; text-shadow: none !important; }"


def luminance(colour: NDArray[np.float64]) -> NDArray[np.float64]:
    """Relative, of sRGB (..., 3) up to 255, as WCAG 2 defines it."""
    part = colour / 255.0
    linear = np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)
    return linear @ np.array([0.2126, 0.7152, 0.0722])


def contrasts(page: Page) -> dict[str, float]:
    """Of every text against the middle one of the pixels that lie behind it, as WCAG 2 defines it."""
    result = page.evaluate(WORDS)
    style = page.add_style_tag(content=HIDDEN)
    picture = np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB"), dtype=float)
    style.evaluate("(element) => element.remove()")
    found = {}
    for words, colour, _, *edges in result:
        left, top, right, bottom = (max(round(edge), 0) for edge in edges)
        behind = np.median(picture[top:bottom, left:right].reshape(-1, 3), axis=0)
        *channels, opaque = [*map(float, re.findall(r"[\d.]+", colour)), 1.0][:4]
        mixed = opaque * np.array(channels) + (1.0 - opaque) * behind
        dark, light = sorted((float(luminance(mixed)), float(luminance(behind))))
        found[words] = (light + 0.05) / (dark + 0.05)
    return found


def settle(page: Page) -> None:
    """Wait until nothing changes its look any more, and that is drawn."""
    page.wait_for_function("document.getAnimations().length === 0")
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


@pytest.mark.parametrize("device", SIZES)
def test_text_is_large_and_clear_and_nothing_lies_over_the_course_when_a_run_has_ended(
    tmp_path: Path, browser: Browser, device: str
) -> None:
    width, height = SIZES[device]
    buoys = [[buoy.north, buoy.east] for gate in load_course("camogli").gates for buoy in gate.buoys]
    pilots, lookout = {"ai": ScriptedPilot(0)}, Lookout()
    with serving(tmp_path, factor=GREAT_HASTE, level="standard", pilots=pilots, lookout=lookout) as (
        where,
        _,
    ):
        page = patient(browser.new_page(viewport={"width": width, "height": height}, bypass_csp=True))
        page.add_init_script(NOTED)
        page.goto(where)
        page.wait_for_function("window.swamp?.frame && swamp.status.driving")
        settle(page)
        seen = contrasts(page)
        page.keyboard.press("t")
        page.wait_for_function("swamp.frame.phase === 'ended'")
        settle(page)
        page.screenshot(path=tmp_path / "ended.png")
        page.wait_for_selector("#watch:not([hidden])")
        settle(page)
        assert page.evaluate(COVERED, buoys) == []
        assert page.evaluate(UNDER_BANNER) == []
        seen |= contrasts(page)
        sizes = [size for _, _, size, *_ in page.evaluate(WORDS)] + page.evaluate("sizes")
        page.close()
    assert {words: value for words, value in seen.items() if value < 4.5} == {}
    assert len(seen) > 15 and min(sizes) >= 12.0

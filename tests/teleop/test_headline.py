"""The page's headline fits the course, and a gamepad of an unknown layout is reported."""

from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from tests.support.patience import patient
from tests.support.recorder import GREAT_HASTE, serving

pytestmark = [pytest.mark.slow, pytest.mark.timed]

GATES = [
    "{name: green, centre: {north: 8.0, east: 0.0}, heading: 0.0, width: 4.0}",
    "{name: red, centre: {north: 16.0, east: 0.0}, heading: 0.0, width: 4.0}",
    "{name: white, centre: {north: 24.0, east: 0.0}, heading: 0.0, width: 4.0}",
]


def opened(browser: Browser, address: str) -> Page:
    page = patient(browser.new_page(viewport={"width": 1280, "height": 800}, bypass_csp=True))
    page.goto(address)
    page.wait_for_function("window.swamp?.frame && swamp.status.driving")
    return page


@pytest.mark.parametrize(
    ("gates", "title", "clock"),
    [
        (1, "Through the gate!", "from the first thrust"),
        (2, "Both gates!", "from gate to gate"),
        (3, "All gates!", "from gate to gate"),
    ],
)
def test_the_headline_of_a_successful_run_has_the_number_of_gates_and_the_start_of_the_clock(
    tmp_path: Path, browser: Browser, gates: int, title: str, clock: str
) -> None:
    course = tmp_path / "straight.yaml"
    course.write_text(f"extends: camogli\nname: straight\ngates: [{', '.join(GATES[:gates])}]\n")
    pilots = {"ai": LineOfSightPilot()}
    with serving(tmp_path / "runs", factor=GREAT_HASTE, course=str(course), pilots=pilots) as (address, _):
        page = opened(browser, address)
        page.keyboard.press("t")
        page.wait_for_function("swamp.frame.phase === 'ended'")
        page.wait_for_function(f"document.querySelector('#banner h1').textContent === '{title}'")
        assert str(page.text_content("#banner p")).endswith(f" s {clock}")
        page.close()


def test_a_gamepad_of_an_unknown_layout_is_reported_and_one_of_the_standard_layout_is_not(
    tmp_path: Path, browser: Browser
) -> None:
    with serving(tmp_path / "runs") as (address, _):
        page = opened(browser, address)
        for mapping, message in (
            ("standard", ""),
            ("", "Gamepad of an unknown layout: axis 2 is the throttle"),
        ):
            event = f"Object.assign(new Event('gamepadconnected'), {{gamepad: {{mapping: '{mapping}'}}}})"
            page.evaluate(f"() => {{ window.dispatchEvent({event}); }}")
            assert str(page.text_content("#said")).startswith(message)
            assert bool(page.text_content("#said")) == bool(message)
        page.close()

"""The recorder's page in a real browser: keys, gamepads and fingers drive, and what they drove is kept.

The boat's clock runs faster than real time, on the same path; a programme is at the levers, so the runs are
`scripted`. Pictures of the page are left in the test's folder.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, ViewportSize
from swamp_rl.envs.single import GatesEnv

from swamp_rl.boat import load_boat
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.runs import inspect_dataset, read_dataset
from swamp_rl.teleop.afloat import Afloat
from swamp_rl.teleop.berth import Berth
from swamp_rl.teleop.recordings import Recordings
from swamp_rl.teleop.rows import largest_difference
from tests.support.driving import BOAT, aim, meta
from tests.support.patience import patient, until
from tests.support.recorder import GREAT_HASTE, serving

pytestmark = [pytest.mark.slow, pytest.mark.timed]

HASTE, MORE_HASTE = 3.0, 6.0  # keys are pressed from outside the browser, which takes time
ATTEMPTS = 4
PHONE: ViewportSize = {"width": 390, "height": 844}
# A standard gamepad that the test moves: axes as the W3C's mapping has them.
PADS = """
window.pads = [0, 1].map((index) => ({ index, connected: true, mapping: "standard", id: "fake",
  axes: [0, 0, 0, 0], buttons: Array.from({ length: 17 }, () => ({ pressed: false, value: 0 })) }));
window.padLooks = 0;
navigator.getGamepads = () => { window.padLooks += 1; return window.pads; };
"""

# Thumbs on its sticks, by the rule of tests.support.driving.aim; they rest when the run has ended.
THUMBS = """
setInterval(() => {
  const f = window.swamp?.frame;
  const under = f && f.phase !== "ended" && f.phase !== "saving" && !window.swamp.status.count;
  if (!under) { window.pads[0].axes.fill(0); return; }
  const [north, east, heading] = f.pose;
  const gate = [[8, 0], [22, 8]][Math.min(f.passed, 1)];
  const ahead = 0.45 * Math.max(gate[0] - north - 1.5, 0);
  const target = ahead > 0 ? gate[0] - ahead : gate[0] + 2;
  const off = Math.atan2(gate[1] - east, target - north) - heading;
  const error = Math.atan2(Math.sin(off), Math.cos(off)) - 0.7 * f.velocity[2];
  window.pads[0].axes[1] = -1;
  window.pads[0].axes[2] = Math.max(-1, Math.min(1, 2 * error));
}, 10);
"""

TAP = """(b) => new Promise((done) => {
  const often = requestAnimationFrame, button = pads[0].buttons[b];
  window.requestAnimationFrame = (f) => setTimeout(() => f(performance.now()), 600);
  setTimeout(() => { button.pressed = true; }, 100);
  setTimeout(() => { button.pressed = false; window.requestAnimationFrame = often; done(); }, 250);
})"""

FREEZE = """
() => { setTimeout(() => { const until = performance.now() + 2000; while (performance.now() < until); }, 0); }
"""


@pytest.fixture
def open_page(browser: Browser) -> Iterator[Callable[..., Page]]:
    """Open an address in a page of its own; afterwards nothing may have gone wrong or come from elsewhere."""
    contexts, wrong = [], []

    def opened(address: str, script: str = "", **options: Any) -> Page:
        # Playwright waits by evaluating text, which the page's own policy forbids.
        context = browser.new_context(bypass_csp=True, viewport={"width": 1280, "height": 800}, **options)
        contexts.append(context)
        page = patient(context.new_page())
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("request", lambda r: None if r.url.startswith(address.split("?")[0]) else wrong.append(r.url))
        if script:
            page.add_init_script(script)
        page.goto(address)
        page.wait_for_function("window.swamp?.frame && window.swamp.status.driving")
        return page

    yield opened
    for context in contexts:
        context.close()
    assert wrong == []


def frame(page: Page) -> dict[str, Any]:
    return page.evaluate("window.swamp.frame")


def wait_for_phase(page: Page, phase: str) -> None:
    page.wait_for_function(f"window.swamp.frame.phase === '{phase}'")


def home(page: Page, steer: Callable[[float], None], again: Callable[[], None], shot: Path) -> None:
    """Drive through both gates, by `steer` with the angle lever that is wanted; try again if that fails."""
    for _ in range(ATTEMPTS):
        pictured = False
        while (seen := frame(page))["phase"] != "ended":
            north, east, heading = seen["pose"]
            steer(aim(north, east, heading, seen["velocity"][2], seen["passed"]))
            if seen["phase"] == "run" and north > 12.0 and not pictured:
                page.screenshot(path=shot)
                pictured = True
        if seen["outcome"] == "success":
            return
        again()
        page.wait_for_function("swamp.frame.phase !== 'ended'")  # keys held down begin the next at once
    raise AssertionError(f"not once home in {ATTEMPTS} attempts")


class Keys:
    """Presses and lets go of real keys, never one that is down already."""

    def __init__(self, page: Page) -> None:
        self.page, self.down = page, set[str]()

    def hold(self, *wanted: str) -> None:
        for key in sorted(self.down - set(wanted)):
            self.page.keyboard.up(key)
        for key in sorted(set(wanted) - self.down):
            self.page.keyboard.down(key)
        self.down = set(wanted)

    def steer(self, angle: float) -> None:
        turn = {"ArrowRight"} if angle > 0.35 else {"ArrowLeft"} if angle < -0.35 else set()
        self.hold("ArrowUp", *turn)


def test_keys_drive_through_both_gates_and_the_kept_run_is_replayed_and_sound(
    tmp_path: Path, open_page: Callable[..., Page]
) -> None:
    folder = tmp_path / "runs"
    with serving(folder, factor=HASTE) as (address, _):
        page = open_page(address)
        page.screenshot(path=tmp_path / "ready.png")
        page.fill("#nickname", "<b>Ada</b>")
        page.keyboard.press("Enter")
        keys = Keys(page)
        home(page, keys.steer, lambda: page.keyboard.press("r"), tmp_path / "run.png")
        keys.hold()
        page.wait_for_selector("#accept:visible")
        page.screenshot(path=tmp_path / "ended.png")
        page.keyboard.press("Enter")
        wait_for_phase(page, "ready")
        page.reload()
        page.wait_for_selector("#board li")
        # The name is shown as it was typed, and made nothing of.
        assert page.text_content("#board li b") == "<b>Ada</b>"
        assert page.text_content("#counter") == "1 run"
        page.click("#board li")
        page.wait_for_selector("#replay:visible")
        assert "exactly the same" in str(page.text_content("#replay-exact"))
        page.evaluate("""() => { const t = document.getElementById("replay-time");
            t.value = t.max * 0.6; t.dispatchEvent(new Event("input")); }""")
        page.wait_for_function("Number(document.getElementById('speed').textContent) > 0.3")
        page.screenshot(path=tmp_path / "replay.png")
        page.evaluate("""() => { const t = document.getElementById("replay-time");
            t.value = t.max; t.dispatchEvent(new Event("input")); }""")
        page.wait_for_function("`${clock.innerText} s` === document.querySelector('#board li i').innerText")
    found = inspect_dataset(folder)
    assert found.faults == []
    run = found.runs[0]
    assert found.meta is not None and found.meta.source == "scripted"
    assert run.meta.outcome == "success" and run.meta.model_dump()["nickname"] == "<b>Ada</b>"
    assert set(run.columns["joy_angle"]) <= {-1.0, 0.0, 1.0}
    assert largest_difference(run, BOAT) == 0.0


def test_a_gamepad_drives_left_stick_up_right_stick_across(
    tmp_path: Path, open_page: Callable[..., Page]
) -> None:
    with serving(tmp_path / "runs", factor=HASTE, level="standard") as (address, _):
        page = open_page(address, PADS + THUMBS)
        home(page, lambda _: None, lambda: press_pad(page, 1), tmp_path / "gamepad.png")  # the thumbs steer
        press_pad(page, 0)
        page.wait_for_function("swamp.status.count === 1")  # the thumbs may have begun another run
    run = read_dataset(tmp_path / "runs").runs[0]
    assert run.meta.outcome == "success"
    assert len(set(run.columns["joy_angle"])) > 3
    assert run.columns["joy_thrust"].max() == 1.0


def press_pad(page: Page, button: int) -> None:
    page.evaluate("(b) => { pads[0].buttons[b].pressed = true; }", button)
    wait_for_a_look_at_the_pads(page)
    page.evaluate("(b) => { pads[0].buttons[b].pressed = false; }", button)
    wait_for_a_look_at_the_pads(page)


def wait_for_a_look_at_the_pads(page: Page) -> None:
    page.wait_for_function("(looks) => padLooks > looks + 1", arg=page.evaluate("padLooks"))


PAD = {"retry": 2, "discard": 1, "accept": 0}
WAYS = {
    "button": {
        name: (lambda page, name=name: page.click(f"#{name}")) for name in ("retry", "discard", "accept")
    },
    "key": {
        name: (lambda page, key=key: page.keyboard.press(key))
        for name, key in {"retry": "r", "discard": "Delete", "accept": "Enter"}.items()
    },
    "gamepad": {name: (lambda page, button=button: press_pad(page, button)) for name, button in PAD.items()},
    "tap between two pictures": {
        name: (lambda page, button=button: page.evaluate(TAP, button)) for name, button in PAD.items()
    },
}


@pytest.mark.parametrize("way", WAYS)
def test_a_run_is_tried_again_discarded_and_accepted_by_button_by_key_and_by_gamepad(
    tmp_path: Path, open_page: Callable[..., Page], way: str
) -> None:
    short = tmp_path / "short.yaml"
    short.write_text("extends: camogli\ntime_limit: 2.0\n")
    pilots: dict[str, Pilot] = {"ai": ScriptedPilot(0)}
    with serving(tmp_path / "runs", factor=GREAT_HASTE, course=str(short), pilots=pilots) as (address, _):
        page = open_page(address, PADS)
        for act, kept in (("retry", 0), ("discard", 0), ("accept", 1)):
            pose = frame(page)["pose"]
            page.keyboard.press("t")
            wait_for_phase(page, "ended")
            page.wait_for_function("swamp.frame.time > 0")
            WAYS[way][act](page)
            wait_for_phase(page, "ready")
            assert (frame(page)["pose"] == pose) == (act == "retry")
            page.wait_for_function(f"swamp.status.count === {kept}")


def test_the_boat_is_chosen_on_the_page_and_its_runs_are_its_own(
    tmp_path: Path, open_page: Callable[..., Page]
) -> None:
    light = load_boat("swamp-light")

    def make_craft(level: str, senses: tuple[str, ...]) -> Afloat:
        return Afloat(GatesEnv(boat="swamp-light", disturbances=level, observation=senses))

    def kept() -> Recordings:
        described = meta(vehicle="swamp-light", mass=light.mass, draught=light.draught)
        return Recordings(tmp_path / "runs" / "swamp-light", described, lambda line: None)

    boats = {"swamp-light": Berth(make_craft, ("calm", "severe"), kept)}
    pilots: dict[str, Pilot] = {"ai": ScriptedPilot(0)}
    with serving(tmp_path / "runs", factor=GREAT_HASTE, pilots=pilots, boats=boats) as (address, _):
        page = open_page(address)
        assert page.locator("#boat option").all_text_contents() == ["swamp", "swamp-light"]
        assert page.locator("#level option").all_text_contents() == ["calm", "standard", "severe"]
        page.select_option("#boat", "swamp-light")
        page.wait_for_function("swamp.status.boat === 'swamp-light'")
        assert page.locator("#level option").all_text_contents() == ["calm", "severe"]
        page.keyboard.press("t")
        home(page, lambda _: None, lambda: page.keyboard.type("rt"), tmp_path / "ended.png")
        assert page.is_disabled("#boat")
        page.keyboard.press("Enter")
        page.wait_for_function("swamp.status.count === 1")
        page.click("#board li")
        page.wait_for_selector("#replay:visible")
        assert "exactly the same" in str(page.text_content("#replay-exact"))
        page.select_option("#boat", "swamp")
        page.wait_for_function("swamp.status.boat === 'swamp' && swamp.status.count === 0")
        assert page.is_hidden("#replay")
    (run,) = read_dataset(tmp_path / "runs" / "swamp-light").runs
    assert largest_difference(run, light) == 0.0


def test_fingers_drive_on_a_phone_and_a_lever_let_go_springs_back(
    tmp_path: Path, open_page: Callable[..., Page]
) -> None:
    with serving(tmp_path / "runs", level="standard") as (address, _):
        page = open_page(address, has_touch=True)
        page.set_viewport_size(PHONE)
        touch = page.context.new_cdp_session(page)

        def fingers(kind: str, *places: tuple[str, float, float]) -> None:
            points = []
            for number, (name, across, up) in enumerate(places):
                box = page.locator(name).bounding_box()
                assert box is not None
                x, y = box["x"] + across * box["width"], box["y"] + (1.0 - up) * box["height"]
                points.append({"x": x, "y": y, "id": number})
            touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

        fingers("touchStart", ("#left-lever", 0.5, 0.99))
        fingers("touchStart", ("#left-lever", 0.5, 0.99), ("#right-lever", 0.97, 0.5))
        page.wait_for_function("swamp.frame.levers[0] === 1 && swamp.frame.levers[1] === 1")
        page.wait_for_function("swamp.frame.velocity[0] > 0.4")
        page.screenshot(path=tmp_path / "phone.png")
        wide = page.evaluate("document.documentElement.scrollWidth")
        assert wide <= PHONE["width"]
        fingers("touchEnd")
        page.wait_for_function("swamp.frame.levers[0] === 0 && swamp.frame.levers[1] === 0")


def test_in_a_small_window_the_chart_is_drawn_behind_the_panels(
    tmp_path: Path, open_page: Callable[..., Page]
) -> None:
    with serving(tmp_path / "runs") as (address, _):
        page = open_page(address)
        page.set_viewport_size({"width": 480, "height": 320})
        page.wait_for_function(
            "((at) => at && 0 < at[0] && at[0] < innerWidth && 0 < at[1] && at[1] < innerHeight)"
            "(swamp.place(swamp.frame.pose[0], swamp.frame.pose[1]))"
        )
        page.screenshot(path=tmp_path / "small.png")


def test_the_pilot_takes_the_helm_and_gives_it_back_and_the_stern_is_kicked(
    tmp_path: Path, open_page: Callable[..., Page]
) -> None:
    with serving(tmp_path / "runs", factor=MORE_HASTE, pilots={"ai": ScriptedPilot(0)}) as (address, _):
        page = open_page(address, PADS)
        keys = Keys(page)
        page.keyboard.press("t")
        page.wait_for_function("swamp.frame.phase === 'run' && swamp.frame.helm === 'pilot'")
        # By key, then by the second joypad.
        keys.hold("q")
        page.wait_for_function("swamp.frame.throttle[2] === 1 && swamp.frame.azimuth[2] < -1")
        keys.hold()
        page.evaluate("pads[1].axes[2] = 0.6")
        page.wait_for_function("swamp.frame.throttle[3] > 0.4 && swamp.frame.azimuth[3] > 1")
        page.evaluate("pads[1].axes[2] = 0")
        page.keyboard.press("t")
        page.wait_for_function("swamp.frame.helm === 'person'")
        page.wait_for_function("(then) => swamp.frame.time > then + 0.3", arg=frame(page)["time"])
        page.screenshot(path=tmp_path / "helm.png")
        page.keyboard.press("t")
        wait_for_phase(page, "ended")
        page.keyboard.press("Enter")
        wait_for_phase(page, "ready")
    run = read_dataset(tmp_path / "runs").runs[0]
    about = run.meta.model_dump()
    assert (about["helm"], about["pilot"], about["corrections"]) == ("both", "ai", 1)
    assert set(run.columns["driver"]) == {0.0, 1.0}
    assert about["kicked_steps"] > 0 and run.columns["throttle_sp"].max() > 0.4
    assert largest_difference(run, BOAT) == 0.0


def test_a_page_that_loses_the_focus_or_freezes_stops_the_thrusters(
    tmp_path: Path, open_page: Callable[..., Page]
) -> None:
    with serving(tmp_path / "runs") as (address, hub):
        page = open_page(address)
        keys = Keys(page)
        keys.hold("ArrowUp")
        page.wait_for_function("swamp.frame.levers[0] === 1")
        page.evaluate("document.hasFocus = () => false; window.dispatchEvent(new Event('blur'))")
        page.wait_for_function("swamp.frame.stopped && swamp.frame.levers[0] === 0")
        page.evaluate("delete document.hasFocus; window.dispatchEvent(new Event('focus'))")
        keys.hold()
        keys.hold("ArrowUp")
        page.wait_for_function("swamp.frame.levers[0] === 1")
        # A script that does not come to its end: no command for longer than the dead-man waits.
        levers, show = list[tuple[float, float]](), hub.show

        def noted() -> None:
            show()
            levers.append(hub.session.levers)

        hub.show = noted  # type: ignore[method-assign]
        page.evaluate(FREEZE)
        until(lambda: (0.0, 0.0) in levers, "the thrusters stop")
        assert hub.session.phase == "run"
        page.wait_for_function("swamp.frame.levers[0] === 1")
        keys.hold()


def test_others_watch_and_the_page_works_under_its_own_policy(tmp_path: Path, browser: Browser) -> None:
    with serving(tmp_path / "runs") as (address, hub):
        errors: list[str] = []
        first, second = patient(browser.new_page()), patient(browser.new_page())
        for page in (first, second):
            page.on(
                "console", lambda message: errors.append(message.text) if message.type == "error" else None
            )
        first.goto(address)
        first.wait_for_selector("#seat:has-text('Leave')")
        second.goto(address)
        second.wait_for_selector("body.watching #seat:has-text('Taken')")
        second.keyboard.press("r")
        text, title = (second.locator(name).bounding_box() for name in ("#said.shown", "#banner h1"))
        assert text and title and text["y"] >= title["y"] + title["height"]
        first.fill("#nickname", "Ada")
        first.press("#nickname", "Enter")
        until(lambda: hub.session.nickname == "Ada", "the name is heard")
        first.click("#seat")
        second.wait_for_selector("#seat:has-text('Drive'):enabled")
        second.click("#seat")
        second.wait_for_selector("#seat:has-text('Leave')")
        first.wait_for_selector("body.watching")
        until(lambda: hub.session.nickname == "anonymous", "the second driver's runs are not the first one's")
        assert errors == []
        for page in (first, second):
            page.close()

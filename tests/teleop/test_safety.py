"""What a recorder refuses: strangers, other pages, floods, nonsense, a second driver, ways out of it."""

import json
import logging
import socket as sockets
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from swamp_rl.errors import UserError
from swamp_rl.teleop import hub
from swamp_rl.teleop.allowance import Allowance
from swamp_rl.teleop.guard import Guard, is_loopback
from swamp_rl.teleop.hub import Hub
from swamp_rl.teleop.messages import LARGEST, clean_nickname, parse
from swamp_rl.teleop.server import bound
from tests.support.patience import PATIENCE
from tests.support.recorder import serving
from tests.support.web import hear

pytestmark = pytest.mark.timed

COMMAND = {"type": "command", "throttle": 0.5, "angle": 0.1}
TOKEN = "harbour7"


@pytest.fixture
def recorder(tmp_path: Path) -> Iterator[tuple[str, Hub]]:
    with serving(tmp_path / "runs") as served:
        yield served


@pytest.fixture(scope="module")
def refusing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a recorder for all that is refused before anybody drives."""
    with serving(tmp_path_factory.mktemp("refusing") / "runs") as (address, _):
        yield address


def page(address: str, **headers: str) -> AbstractContextManager[ClientConnection]:
    """A page's socket."""
    host = address.split("/")[2]
    headers = {"Origin": f"http://{host}"} | headers
    origin = headers.pop("Origin", None)
    return connect(
        f"ws://{host}/socket",
        origin=origin or None,
        additional_headers=headers,
        open_timeout=PATIENCE,
        max_size=None,
    )  # type: ignore[arg-type]


def has_text(part: str) -> Callable[[dict[str, Any]], bool]:
    return lambda message: message["type"] == "say" and part in message["text"]


def status(**wanted: object) -> Callable[[dict[str, Any]], bool]:
    return lambda m: m["type"] == "status" and all(m[key] == value for key, value in wanted.items())


def get(address: str, path: str = "", **headers: str) -> tuple[int, str]:
    """Status and text of an answer; redirections are followed."""
    request = urllib.request.Request(address.split("?")[0].rstrip("/") + "/" + path, headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "", "http://127.0.0.1:1"])
def test_another_pages_origin_is_refused(refusing: str, origin: str) -> None:
    with pytest.raises(InvalidStatus) as refused, page(refusing, Origin=origin):
        pass
    assert refused.value.response.status_code == 403


def test_a_strange_name_for_this_machine_is_refused(refusing: str) -> None:
    assert get(refusing, Host="evil.example")[0] == 403
    assert get(refusing, Host="localhost:80")[0] == 200


def test_another_address_than_this_machines_needs_a_token() -> None:
    with pytest.raises(UserError, match="add --token"):
        Guard("0.0.0.0", None)
    for token in ("short", "with space", "naïve-token", ""):
        with pytest.raises(UserError, match="letters and digits"):
            Guard("0.0.0.0", token)
    assert [
        is_loopback(host) for host in ("127.0.0.1", "localhost", "::1", "0.0.0.0", "192.168.1.2", "x")
    ] == [
        *[True] * 3,
        *[False] * 3,
    ]


def test_without_the_token_nothing_is_served_and_with_it_everything(tmp_path: Path) -> None:
    with serving(tmp_path / "runs", host="0.0.0.0", token=TOKEN) as (address, _):
        assert address.endswith(f"/?token={TOKEN}")
        port = address.split(":")[2].split("/")[0]
        here = f"http://127.0.0.1:{port}/"
        for path in ("", "main.js", "runs/run-0001", "?token=wrong"):
            assert get(here, path)[0] == 403
        for cookie in ({}, {"Cookie": "swamp_token=wrong"}):
            with pytest.raises(InvalidStatus), page(here, **cookie):
                pass
        cookie = {"Cookie": f"swamp_token={TOKEN}"}
        assert get(here, "main.js", **cookie)[0] == 200
        with page(here, **cookie) as socket:
            hear(socket, lambda message: message["type"] == "scene")


def test_the_token_leaves_the_address_for_a_cookie_that_no_script_reads(tmp_path: Path) -> None:
    with serving(tmp_path / "runs", token=TOKEN) as (address, _):

        class Stay(urllib.request.HTTPRedirectHandler):
            def redirect_request(self, *_: Any, **__: Any) -> None:
                return None

        with pytest.raises(urllib.error.HTTPError) as moved:
            urllib.request.build_opener(Stay()).open(address, timeout=PATIENCE)
        assert moved.value.code == 303 and moved.value.headers["location"] == "/"
        cookie = moved.value.headers["set-cookie"].lower()
        assert "httponly" in cookie and "samesite=strict" in cookie


def test_a_malformed_message_is_refused_logged_and_harms_nobody(
    recorder: tuple[str, Hub], caplog: pytest.LogCaptureFixture
) -> None:
    nonsense: list[str | bytes] = [
        "",
        "{",
        "[]",
        "null",
        b"\xff\xfe",
        '{"type": "sink"}',
        '{"type": "\\u001b[31m"}',
        json.dumps(COMMAND | {"throttle": 1.5}),
        json.dumps(COMMAND | {"throttle": "1"}),
        json.dumps(COMMAND | {"angle": None}),
        json.dumps(COMMAND | {"rudder": 1.0}),
        '{"type": "command", "throttle": NaN, "angle": 0}',
        '{"type": "act", "act": "rm -rf"}',
        "x" * (LARGEST + 1),
        "[" * 900,
    ]
    with caplog.at_level(logging.WARNING, "swamp_rl.teleop"), page(recorder[0]) as socket:
        hear(socket, status(driving=True))
        for text in nonsense:
            socket.send(text)
            output = hear(socket, has_text("message"))["text"]
            assert len(output) < 200 and output.isprintable()
        socket.send(json.dumps(COMMAND))
        hear(socket, lambda message: message.get("levers") == [0.5, 0.1])
    refusals = [record for record in caplog.records if "refused" in record.message]
    assert len(refusals) == len(nonsense)


def test_a_huge_message_ends_its_connection_and_no_other(recorder: tuple[str, Hub]) -> None:
    with page(recorder[0]) as good, page(recorder[0]) as bad:
        with pytest.raises(ConnectionClosed):
            bad.send("x" * 1_000_000)
            while True:
                bad.recv(timeout=PATIENCE)
        hear(good, status(watchers=0))
        good.send(json.dumps(COMMAND))
        hear(good, lambda message: message.get("phase") == "run")


def test_a_flood_is_dropped_and_then_cut_off(
    recorder: tuple[str, Hub], caplog: pytest.LogCaptureFixture
) -> None:
    with page(recorder[0]) as good, page(recorder[0]) as bad, pytest.raises(ConnectionClosed):
        hear(good, status(driving=True))
        for _ in range(5000):
            bad.send('{"type": "act", "act": "helm"}')
        while True:
            bad.recv(timeout=PATIENCE)
    assert "sends too much" in caplog.text


def test_an_allowance_refills_steadily() -> None:
    allowance = Allowance(rate=10.0, burst=3.0)
    assert [allowance.spend(0.0) for _ in range(4)] == [True, True, True, False]
    assert [allowance.spend(0.1), allowance.spend(0.1)] == [True, False]
    assert sum(allowance.spend(100.0) for _ in range(9)) == 3


def test_one_drives_the_others_watch_and_the_seat_passes_on(recorder: tuple[str, Hub]) -> None:
    with page(recorder[0]) as second:
        with page(recorder[0]) as third:
            hear(third, status(driving=False, seat_taken=True))
            hear(second, status(driving=True, watchers=1))
            for act in (COMMAND, {"type": "act", "act": "retry"}, {"type": "choose", "nickname": "x"}):
                third.send(json.dumps(act))
                hear(third, has_text("you are watching"))
            third.send('{"type": "act", "act": "seat"}')
            hear(third, has_text("someone is driving"))
            second.send('{"type": "act", "act": "seat"}')
            hear(second, status(driving=False))
            third.send('{"type": "act", "act": "seat"}')
            hear(third, status(driving=True))
            second.send(json.dumps(COMMAND))
            hear(second, has_text("you are watching"))
        hear(second, status(seat_taken=False))


def test_the_seat_of_a_page_that_fell_silent_is_reported_to_be_free(
    recorder: tuple[str, Hub], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hub, "SILENCE", 0.5)
    with page(recorder[0]) as silent, page(recorder[0]) as watcher:
        hear(watcher, status(driving=False, seat_taken=False))
        watcher.send('{"type": "act", "act": "seat"}')
        hear(watcher, status(driving=True))
        hear(silent, status(driving=False))


def test_a_driver_whose_connection_breaks_lets_go_of_the_levers(recorder: tuple[str, Hub]) -> None:
    with page(recorder[0]) as watcher:
        with page(recorder[0]) as driver:
            watcher.send('{"type": "act", "act": "seat"}')
            hear(watcher, status(driving=False))
            driver.send('{"type": "act", "act": "seat"}')
            hear(driver, status(driving=True))
            driver.send(json.dumps(COMMAND))
            hear(watcher, lambda message: message.get("levers") == [0.5, 0.1])
        stopped = hear(watcher, lambda message: message.get("levers") == [0.0, 0.0])
        assert stopped["phase"] == "run"


@pytest.mark.parametrize(
    "path",
    [
        "runs/../dataset.yaml",
        "runs/..%2Fdataset.yaml",
        "runs/%2e%2e%2fdataset",
        "runs/dataset",
        "runs/run-0001%00",
        "../server.py",
        "..%2fserver.py",
        "%2e%2e/server.py",
        "....//server.py",
        "/etc/passwd",
        "%2fetc%2fpasswd",
    ],
)
def test_no_path_leads_out_of_the_page_or_the_dataset(refusing: str, path: str) -> None:
    code, text = get(refusing, path)
    assert code in (400, 404)
    assert "vehicle" not in text and "import" not in text and "root:" not in text


def test_the_page_may_load_nothing_from_elsewhere(recorder: tuple[str, Hub]) -> None:
    with urllib.request.urlopen(recorder[0], timeout=PATIENCE) as answer:
        policy = answer.headers["content-security-policy"]
        text = answer.read().decode()
    assert "default-src 'self'" in policy and "unsafe" not in policy
    assert "//" not in text.replace("<!doctype html>", "")
    assert "<script>" not in text and "onclick" not in text


@given(st.text(max_size=60))
def test_a_nickname_is_one_short_printable_line(name: str) -> None:
    kept = clean_nickname(name)
    assert 0 < len(kept) <= 24 and kept.isprintable() and kept == " ".join(kept.split())


@given(st.one_of(st.text(max_size=300), st.binary(max_size=300)))
def test_whatever_is_sent_is_a_message_or_a_refusal(text: str | bytes) -> None:
    with pytest.raises(UserError, match="malformed"):
        parse(text)


@pytest.mark.parametrize(
    ("message", "fault"),
    [
        ({"type": "command", "throttle": 1.5, "angle": 0.0}, "command.throttle: must be at most 1, not 1.5"),
        ({"type": "command", "angle": 0.0}, "command.throttle: is missing; add it"),
        (
            {"type": "act", "act": "helm", "speed": 1.0},
            "act.speed: unknown key; remove it or correct its name",
        ),
        ({"type": "sink"}, "'type' must be one of 'command', 'act', 'choose'"),
        ([], "must be a mapping of keys to values, not []"),
    ],
)
def test_a_refusal_names_the_key_what_is_allowed_and_the_remedy(message: Any, fault: str) -> None:
    with pytest.raises(UserError) as refused:
        parse(json.dumps(message))
    text = str(refused.value)
    assert text.startswith(f"malformed message ({fault}") and text.endswith("); load the page again")


@given(
    st.fixed_dictionaries(
        {"type": st.sampled_from(["command", "act", "choose"])},
        optional={
            "throttle": st.floats() | st.text(max_size=3),
            "angle": st.floats(-1.0, 1.0),
            "act": st.sampled_from(["accept", "helm"]) | st.text(max_size=3),
            "nickname": st.text(max_size=30),
        },
    )
)
def test_messages_keep_to_their_ranges(message: dict[str, Any]) -> None:
    try:
        kept = parse(json.dumps(message))
    except UserError:
        return
    assert 0.0 <= getattr(kept, "throttle", 0.0) <= 1.0
    assert -1.0 <= getattr(kept, "angle", 0.0) <= 1.0


def test_small_frames_are_sent_at_once() -> None:
    # What asyncio looks at before it turns off the delay that gathers small packets.
    with bound("127.0.0.1", 0) as listening:
        assert listening.proto == sockets.IPPROTO_TCP


def test_a_port_in_use_is_one_line() -> None:
    with bound("127.0.0.1", 0) as taken, pytest.raises(UserError, match="in use"):
        bound("127.0.0.1", taken.getsockname()[1])

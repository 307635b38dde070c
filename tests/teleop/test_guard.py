"""Who is let in: names asked for, tokens right, wrong or no text, and other pages in one's browser."""

import json
from pathlib import Path
from typing import Any

import pytest

from swamp_rl.teleop.guard import LOCKED, WRONG, Guard
from tests.support.recorder import serving
from tests.support.web import answer, driving, hear, status

pytestmark = pytest.mark.timed

TOKEN = "harbour7"
COMMAND = {"type": "command", "throttle": 0.5, "angle": 0.1}


@pytest.mark.parametrize(
    "host",
    [
        "[::1]x",
        "[::1]:80x",
        "127.0.0.1:80@evil.com",
        "127.0.0.1@evil.com",
        "127.0.0.1:x",
        "localhost.evil.com",
        "localhost:80:80",
        "[127.0.0.1]",
        "::1",
        "127.0.0.1, evil.com",
        "localhost/",
        "",
    ],
)
def test_a_host_that_is_not_exactly_this_machines_is_refused(tmp_path: Path, host: str) -> None:
    guard = Guard("127.0.0.1", None)
    refused = guard.objection(scope(host=host.encode()))
    assert refused is not None and refused.status == 403


def test_the_host_is_looked_at_on_a_real_connection(tmp_path: Path) -> None:
    with serving(tmp_path / "runs") as (address, _):
        for host, wanted in {
            "[::1]x": 403,
            "127.0.0.1:80@evil.com": 403,
            "localhost:80": 200,
            "[::1]:80": 200,
            "LOCALHOST": 200,
        }.items():
            assert status(address, host=host) == wanted
        assert " 40" in answer(address, "GET / HTTP/1.1", "Host: 127.0.0.1", "Host: evil.com")[:16]


@pytest.mark.parametrize("token", [None, TOKEN])
def test_a_token_that_is_no_text_is_a_malformed_request(tmp_path: Path, token: str | None) -> None:
    with serving(tmp_path / "runs", token=token) as (address, _):
        for path in (
            "/?token=%ff",
            "/?token=%00",
            "/?token=a%0d%0aSet-Cookie:%20x=y",
            "/?token=%F0%9F%9A%A4",
        ):
            assert status(address, path) == 400


def scope(
    token: str = "",
    address: str = "10.0.0.1",
    host: bytes = b"10.0.0.9:80",
    headers: dict[str, str] | None = None,
) -> dict[str, Any]:
    query = f"token={token}".encode() if token else b""
    return {
        "type": "http",
        "client": (address, 40000),
        "headers": [(b"host", host), *((k.encode(), v.encode()) for k, v in (headers or {}).items())],
        "query_string": query,
    }


def test_an_address_that_tries_tokens_is_locked_out_for_a_while_and_no_other_is() -> None:
    now = [100.0]
    guard = Guard("0.0.0.0", TOKEN, clock=lambda: now[0])

    def answered(token: str, address: str = "10.0.0.1") -> int:
        objection = guard.objection(scope(token, address))
        return 200 if objection is None else objection.status

    assert [answered("") for _ in range(3 * WRONG)] == [403] * (3 * WRONG)
    assert [answered(f"wrong{i}") for i in range(WRONG)] == [403] * WRONG
    assert answered(TOKEN) == 429
    assert answered(TOKEN, "10.0.0.2") == 200
    now[0] += LOCKED - 0.1
    assert answered(TOKEN) == 429
    now[0] += 0.2
    assert answered(TOKEN) == 200
    assert answered("wrong") == 403 and answered(TOKEN) == 200
    # Whoever has one address of IPv6 has its network.
    for i in range(WRONG):
        answered("wrong", f"2001:db8::{i:x}")
    assert answered(TOKEN, "2001:db8::ffff") == 429 and answered(TOKEN, "2001:db8:0:1::1") == 200
    # One of IPv4 has itself alone, however the socket tells it.
    for _ in range(WRONG):
        answered("wrong", "::ffff:10.0.0.7")
    assert answered(TOKEN, "::ffff:10.0.0.7") == 429 and answered(TOKEN, "10.0.0.7") == 429
    assert answered(TOKEN, "::ffff:10.0.0.8") == 200


def test_one_who_has_the_cookie_is_let_in_while_wrong_queries_come_from_its_address(tmp_path: Path) -> None:
    cookie = {"Cookie": f"swamp_token={TOKEN}"}
    with serving(tmp_path / "runs", token=TOKEN) as (address, _), driving(address, **cookie) as driver:
        for number in range(WRONG):
            assert status(address, f"/?token=wrong{number}") == 403
        assert status(address, f"/?token={TOKEN}") == 429
        driver.send(json.dumps(COMMAND))
        hear(driver, lambda message: message.get("levers") == [0.5, 0.1])
        assert status(address, "/", None, f"Cookie: swamp_token={TOKEN}") == 200
        with driving(address, **cookie) as another:
            hear(another, lambda message: message["type"] == "frame")


def test_who_tries_tokens_as_cookies_is_locked_out_with_cookies() -> None:
    guard = Guard("0.0.0.0", TOKEN)
    for number in range(WRONG):
        refused = guard.objection(scope(headers={"cookie": f"swamp_token=wrong{number}"}))
        assert refused is not None and refused.status == 403
    refused = guard.objection(scope(headers={"cookie": f"swamp_token={TOKEN}"}))
    assert refused is not None and refused.status == 429


EMBEDDED = {"sec-fetch-site": "cross-site", "sec-fetch-mode": "no-cors", "sec-fetch-dest": "image"}
FRAMED = {"sec-fetch-site": "same-site", "sec-fetch-mode": "navigate", "sec-fetch-dest": "iframe"}
SENT = {"origin": "http://evil.com"}
SANDBOXED = {"origin": "null"}


@pytest.mark.parametrize("headers", [EMBEDDED, FRAMED, SENT, SANDBOXED])
def test_another_page_can_lock_no_one_out_and_try_no_token(headers: dict[str, str]) -> None:
    guard = Guard("0.0.0.0", TOKEN)
    for number in range(3 * WRONG):
        refused = guard.objection(scope(f"wrong{number}", headers=headers))
        assert refused is not None and refused.reason == "its origin is another page"
    refused = guard.objection(scope(TOKEN, headers=headers))
    assert refused is not None and refused.status == 403
    assert guard.objection(scope(TOKEN)) is None


def test_a_link_on_another_page_leads_in() -> None:
    followed = {"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}
    assert Guard("0.0.0.0", TOKEN).objection(scope(TOKEN, headers=followed)) is None


def test_a_wrong_token_beside_the_right_cookie_does_not_take_its_place(tmp_path: Path) -> None:
    with serving(tmp_path / "runs", token=TOKEN) as (address, _):
        cookie = f"Cookie: swamp_token={TOKEN}"
        host = address.split("/")[2]
        message = answer(address, "GET /?token=wrong99 HTTP/1.1", f"Host: {host}", cookie)
        assert " 303 " in message[:20] and "wrong99" not in message and TOKEN in message

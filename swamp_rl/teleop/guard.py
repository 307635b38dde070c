"""Who may speak to the recorder: the right address, origin and token, and not too much at once."""

import hmac
from collections.abc import MutableMapping
from http.cookies import CookieError, SimpleCookie
from ipaddress import ip_address
from typing import Any
from urllib.parse import parse_qs

from swamp_rl.errors import UserError

COOKIE = "swamp_token"
SHORTEST_TOKEN = 6
LOOPBACK_NAMES = ("localhost", "127.0.0.1", "::1")

Scope = MutableMapping[str, Any]
"An ASGI connection's description."


def is_loopback(host: str) -> bool:
    """Whether only this machine reaches an address bound so."""
    try:
        return host == "localhost" or ip_address(host).is_loopback
    except ValueError:
        return False


def checked_token(host: str, token: str | None) -> str | None:
    """The token if it will do; UserError where others could connect without one."""
    if token is None and not is_loopback(host):
        raise UserError(f"--host {host} lets other machines connect; add --token with a word they must know")
    if token is not None and (len(token) < SHORTEST_TOKEN or not token.isascii() or not token.isalnum()):
        raise UserError(f"--token must be {SHORTEST_TOKEN} or more letters and digits")
    return token


class Guard:
    """The checks of one server, on ASGI scopes."""

    def __init__(self, host: str, token: str | None) -> None:
        """host: the address bound; token: what to ask for, None only on a loopback address."""
        self.token = checked_token(host, token)
        self._loopback = is_loopback(host)

    def objection(self, scope: Scope) -> str | None:
        """Why a connection is not to be served; None if it is."""
        if scope["type"] not in ("http", "websocket"):
            return None
        if not self.known_host(scope):
            return "it asked for a name that is not this machine's"
        if scope["type"] == "websocket" and not self.own_origin(scope):
            return "its origin is another page"
        return None if self.has_token(scope) else "it has no token"

    def known_host(self, scope: Scope) -> bool:
        """Whether the name asked for is ours: else a stranger's name may have been pointed here."""
        return not self._loopback or _without_port(_header(scope, b"host")) in LOOPBACK_NAMES

    def has_token(self, scope: Scope) -> bool:
        """Whether the cookie or the query holds the token, if one is asked for."""
        if self.token is None:
            return True
        given = [self.in_query(scope), _cookie(scope)]
        return any(hmac.compare_digest(word.encode(), self.token.encode()) for word in given)

    def in_query(self, scope: Scope) -> str:
        """The word given as `?token=`."""
        query = parse_qs(scope.get("query_string", b"").decode("latin-1"))
        return query.get("token", [""])[0]

    def own_origin(self, scope: Scope) -> bool:
        """Whether a page that this server sent is asking: its origin is the host it asks."""
        origin = _header(scope, b"origin")
        return origin in {f"{scheme}://{_header(scope, b'host')}" for scheme in ("http", "https")}


def _header(scope: Scope, name: bytes) -> str:
    values = [value for key, value in scope.get("headers", ()) if key == name]
    return values[0].decode("latin-1") if len(values) == 1 else ""


def _cookie(scope: Scope) -> str:
    try:
        found = SimpleCookie(_header(scope, b"cookie")).get(COOKIE)
    except CookieError:
        return ""
    return found.value if found else ""


def _without_port(host: str) -> str:
    if host.startswith("["):
        return host[1:].partition("]")[0]
    return host.partition(":")[0]


class Allowance:
    """How many messages a connection may still send: it refills steadily, up to a burst."""

    def __init__(self, rate: float, burst: float) -> None:
        """rate: messages a second."""
        self.rate, self.burst = rate, burst
        self._left, self._last = burst, 0.0

    def spend(self, now: float) -> bool:
        """Whether one more is allowed at `now` [s]; it then counts."""
        self._left = min(self.burst, self._left + (now - self._last) * self.rate)
        self._last = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True

"""Who may speak to the recorder: the right address, origin and token."""

import hmac
import re
import time
from collections.abc import Callable, MutableMapping
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie
from ipaddress import IPv6Address, ip_address, ip_network
from typing import Any
from urllib.parse import parse_qs

from swamp_rl.errors import UserError

COOKIE = "swamp_token"
SHORTEST_TOKEN = 6
LOOPBACK_NAMES = ("localhost", "127.0.0.1", "[::1]")
HOST = re.compile(r"(\[[0-9a-f:.]+\]|[a-z0-9._-]+)(?::[0-9]{1,5})?", re.ASCII | re.IGNORECASE)
"A name or an address, in brackets where it is one of IPv6, and perhaps a port (RFC 9110, 7.2)."
WRONG, LOCKED = 10, 60.0
"Wrong tokens from an address, and for how long [s] it is then locked out, right ones included."
ADDRESSES = 1024
"Addresses whose wrong tokens are remembered."

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


@dataclass(frozen=True)
class Objection:
    """Why a connection is not served: the status of the answer, and a reason for the log."""

    status: int
    reason: str


class Guard:
    """The checks of one server, on ASGI scopes."""

    def __init__(self, host: str, token: str | None, clock: Callable[[], float] = time.monotonic) -> None:
        """host: the address bound; token: what to ask for, None only on a loopback address; clock: in s."""
        self.token = checked_token(host, token)
        self._loopback, self._clock = is_loopback(host), clock
        self._wrong: dict[str, tuple[int, float]] = {}

    def objection(self, scope: Scope) -> Objection | None:
        """Why a connection is not to be served; None if it is. A wrong token counts against its address."""
        if scope["type"] not in ("http", "websocket"):
            return None
        if not self.known_host(scope):
            return Objection(403, "it asked for a name that is not this machine's")
        if scope["type"] == "websocket" and not self.own_origin(scope):
            return Objection(403, "its origin is another page")
        if self.token is not None and self._locked_out(scope):
            return Objection(429, f"{WRONG} wrong tokens came from its address")
        word = self.in_query(scope)
        if word and not (word.isascii() and word.isalnum()):
            return Objection(400, "its token is not made of letters and digits")
        if self.has_token(scope):
            return None
        if word or _cookie(scope):
            self._count_wrong(scope)
            return Objection(403, "it has a wrong token")
        return Objection(403, "it has no token")

    def known_host(self, scope: Scope) -> bool:
        """Whether the name asked for is ours: else a stranger's name may have been pointed here."""
        host = HOST.fullmatch(_header(scope, b"host"))
        return host is not None and (not self._loopback or host[1].lower() in LOOPBACK_NAMES)

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

    def _locked_out(self, scope: Scope) -> bool:
        count, last = self._wrong.get(_address(scope), (0, 0.0))
        return count >= WRONG and self._clock() - last < LOCKED

    def _count_wrong(self, scope: Scope) -> None:
        address, now = _address(scope), self._clock()
        count, last = self._wrong.pop(address, (0, now))
        self._wrong[address] = (count + 1 if now - last < LOCKED else 1, now)
        if len(self._wrong) > ADDRESSES:
            del self._wrong[next(iter(self._wrong))]


def _address(scope: Scope) -> str:
    """Whose tries count together: an address, of IPv6 the network of 64 bits that one holder has.

    A socket of both kinds tells an address of IPv4 as one of IPv6, and all of them are in one such network.
    """
    host = (scope.get("client") or ("", 0))[0].partition("%")[0]
    if ":" not in host:
        return host
    mapped = IPv6Address(host).ipv4_mapped
    return str(mapped or ip_network(f"{host}/64", strict=False))


def _header(scope: Scope, name: bytes) -> str:
    values = [value for key, value in scope.get("headers", ()) if key == name]
    return values[0].decode("latin-1") if len(values) == 1 else ""


def _cookie(scope: Scope) -> str:
    try:
        found = SimpleCookie(_header(scope, b"cookie")).get(COOKIE)
    except CookieError:
        return ""
    return found.value if found else ""

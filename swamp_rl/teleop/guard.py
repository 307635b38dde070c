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
"""Wrong tokens of an address in one place, query or cookie, and for how long [s] none of its tokens there is
then looked at, right ones included."""
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
        raise UserError(f"--host {host} lets other machines connect; add --token with a password")
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
        self._wrong: dict[tuple[str, str], tuple[int, float]] = {}

    def objection(self, scope: Scope) -> Objection | None:
        """Why a connection is not to be served; None if it is.

        A wrong token counts against its address and its place there. What another page has this browser ask
        for counts nothing; of a browser that does not say so, it can at most be a query, and so lock out no
        one who has the cookie.
        """
        if scope["type"] not in ("http", "websocket"):
            return None
        if not self.known_host(scope):
            return Objection(403, "it asked for a name that is not this machine's")
        if self.of_another_page(scope):
            return Objection(403, "its origin is another page")
        word = self.in_query(scope)
        if word and not (word.isascii() and word.isalnum()):
            return Objection(400, "its token is not made of letters and digits")
        if self.token is None:
            return None
        given = {place: token for place, token in (("query", word), ("cookie", _cookie(scope))) if token}
        looked_at = {place: token for place, token in given.items() if not self._locked_out(scope, place)}
        if any(hmac.compare_digest(token.encode(), self.token.encode()) for token in looked_at.values()):
            return None
        for place in looked_at:
            self._count_wrong(scope, place)
        if len(looked_at) < len(given):
            return Objection(429, f"{WRONG} wrong tokens came from its address")
        return Objection(403, "it has a wrong token" if given else "it has no token")

    def known_host(self, scope: Scope) -> bool:
        """Whether the name asked for is ours: else a stranger's name may have been pointed here."""
        host = HOST.fullmatch(_header(scope, b"host"))
        return host is not None and (not self._loopback or host[1].lower() in LOOPBACK_NAMES)

    def in_query(self, scope: Scope) -> str:
        """The word given as `?token=`."""
        query = parse_qs(scope.get("query_string", b"").decode("latin-1"))
        return query.get("token", [""])[0]

    def of_another_page(self, scope: Scope) -> bool:
        """Whether a page that this server did not send has a browser ask, otherwise than by a link to here.

        A browser tells the page's origin for WebSockets and for all that changes something; for all else it
        tells how that is related to this server (https://www.w3.org/TR/fetch-metadata), if it trusts the
        way here: by https, or on one machine.
        """
        origin, host = _header(scope, b"origin"), _header(scope, b"host")
        if (origin or scope["type"] == "websocket") and origin not in (f"http://{host}", f"https://{host}"):
            return True
        followed = (_header(scope, b"sec-fetch-mode"), _header(scope, b"sec-fetch-dest"))
        related = _header(scope, b"sec-fetch-site")
        return related not in ("", "none", "same-origin") and followed != ("navigate", "document")

    def _locked_out(self, scope: Scope, place: str) -> bool:
        count, last = self._wrong.get((_address(scope), place), (0, 0.0))
        return count >= WRONG and self._clock() - last < LOCKED

    def _count_wrong(self, scope: Scope, place: str) -> None:
        key, now = (_address(scope), place), self._clock()
        count, last = self._wrong.pop(key, (0, now))
        self._wrong[key] = (count + 1 if now - last < LOCKED else 1, now)
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
    """The header's value; of one that is given twice both, as a list (RFC 9110, 5.3)."""
    return b", ".join(value for key, value in scope.get("headers", ()) if key == name).decode("latin-1")


def _cookie(scope: Scope) -> str:
    try:
        found = SimpleCookie(_header(scope, b"cookie")).get(COOKIE)
    except CookieError:
        return ""
    return found.value if found else ""

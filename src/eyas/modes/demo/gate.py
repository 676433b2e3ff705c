"""Who may come in: the token, the host and the origin of a request."""

import hmac
import secrets
from urllib.parse import SplitResult, parse_qs, urlsplit

from websockets.http11 import Request

__all__ = ["Gate", "is_loopback", "path_of", "query_of"]

_LOOPBACK = ("localhost", "127.0.0.1", "::1")


def is_loopback(host: str) -> bool:
    """Return whether an address reaches only this machine."""
    return host in _LOOPBACK


class Gate:
    """Lets in pages that we have served.

    On loopback no token is needed; instead the page must have been asked for by a name of this
    machine, because any page of the web may give its own name our address.

    Attributes:
        token: What the address must hold; None: nothing.

    Args:
        host: The address that is bound.
    """

    def __init__(self, host: str) -> None:
        self.token = None if is_loopback(host) else secrets.token_urlsafe(16)

    def refusal(self, request: Request, *, private: bool) -> str | None:
        """Return why a request is refused; None: it is not.

        Args:
            request: The request.
            private: Whether it needs the token, as all but the page's own files.
        """
        hosts, origins = (request.headers.get_all(name) for name in ("Host", "Origin"))
        host = hosts[0] if len(hosts) == 1 else ""
        if self.token is None and _name_of(f"//{host}").hostname not in _LOOPBACK:
            return "this demo answers only to localhost"
        if origins and (len(origins) > 1 or _name_of(origins[0]).netloc != host):
            return "the page is of another origin"
        if private and self.token is not None:
            given = query_of(request).get("token", [""])[0]
            if not hmac.compare_digest(given.encode(errors="replace"), self.token.encode()):
                return "the address needs ?token=..., as the demo has printed it"
        return None


def path_of(request: Request) -> str:
    """Return the path that is asked for; unlike `urlsplit`, whatever it looks like."""
    return request.path.partition("?")[0]


def query_of(request: Request) -> dict[str, list[str]]:
    """Return what is asked for behind the path."""
    return parse_qs(request.path.partition("?")[2])


def _name_of(address: str) -> SplitResult:
    """Return an address in parts; empty ones if it is none."""
    try:
        parts = urlsplit(address)
        parts.hostname  # noqa: B018  # raises for some
    except ValueError:
        return urlsplit("")
    return parts

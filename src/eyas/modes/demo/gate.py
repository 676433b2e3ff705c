"""Who may come in: the token, the host and the origin of a request."""

import hmac
import secrets
from urllib.parse import parse_qs, urlsplit

from websockets.http11 import Request

__all__ = ["Gate", "is_loopback"]

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
        host = request.headers.get("Host", "")
        if self.token is None and urlsplit(f"//{host}").hostname not in _LOOPBACK:
            return "this demo answers only to localhost"
        origin = request.headers.get("Origin")
        if origin is not None and urlsplit(origin).netloc != host:
            return "the page is of another origin"
        if private and self.token is not None:
            given = parse_qs(urlsplit(request.path).query).get("token", [""])[0]
            if not hmac.compare_digest(given.encode(), self.token.encode()):
                return "the address needs ?token=..., as the demo has printed it"
        return None

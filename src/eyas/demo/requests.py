"""Requests to the demo's server: who may come in, and the files that are given."""

import hmac
import json
import re
import secrets
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any
from urllib.parse import SplitResult, parse_qs, urlsplit

import numpy as np
from websockets.http11 import Request

from eyas.demo.session import Session
from eyas.engine.settings.dialect import spoken

__all__ = ["Gate", "is_loopback", "own_file", "page_file", "path_of", "query_of"]

PAGE = Path(str(files("eyas.demo"))) / "page"

_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}

File = tuple[str, bytes]  # Its type, and its bytes


@cache
def _names() -> dict[str, Path]:
    return {f"/{path.name}": path for path in PAGE.iterdir() if path.suffix in _TYPES}


def page_file(path: str) -> File | None:
    """Return a file of the page; None if there is none with this path."""
    found = _names().get("/index.html" if path == "/" else path)
    return None if found is None else (_TYPES[found.suffix], found.read_bytes())


def own_file(path: str, session: Session) -> File | None:
    """Return what is made on request: `/map.json` and `/env_config.json`.

    Raises:
        ConfigError: The original's keys cannot express the settings.
    """
    if path == "/map.json":
        return "application/json", json.dumps(_streets(session)).encode()
    if path == "/env_config.json":
        text = json.dumps(spoken(path).content_of(session.flight.config), indent=4)
        return "application/json", f"{text}\n".encode()
    return None


def _streets(session: Session) -> dict[str, Any]:
    """Return the middle lines of all lanes [m], and the width of each."""
    network = session.flight.world.assets.scene.network
    lanes = np.split(np.round(network.lane_points, 1), network.lane_first[1:-1])
    return {
        "lanes": [lane.tolist() for lane in lanes],
        "widths": np.round(network.lane_width, 1).tolist(),
    }


_LOOPBACK = ("localhost", "127.0.0.1", "::1")
_OWN_HOST = re.compile(r"(localhost|127\.0\.0\.1|\[::1\])(:[0-9]{1,5})?", re.IGNORECASE)
"""What the header `Host` may be where no token is needed."""


def is_loopback(host: str) -> bool:
    """Return whether an address reaches only this machine."""
    return host in _LOOPBACK


class Gate:
    """Lets in pages that we have served.

    On loopback no token is needed; instead the page must have been asked for by a name of this
    machine, because any page of the web may give its own name our address.

    Attributes:
        token: What the address must hold; None: nothing.
    """

    def __init__(self, host: str) -> None:
        self.token = None if is_loopback(host) else secrets.token_urlsafe(16)

    def refusal(self, request: Request, *, private: bool) -> str | None:
        """Return why a request is refused; None: it is not.

        Args:
            private: Whether it needs the token, as all but the page's own files.
        """
        hosts, origins = (request.headers.get_all(name) for name in ("Host", "Origin"))
        host = hosts[0] if len(hosts) == 1 else ""
        if self.token is None and not _OWN_HOST.fullmatch(host):
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
    """Return an address in parts; empty ones if it is not valid."""
    try:
        parts = urlsplit(address)
        parts.hostname  # noqa: B018  # raises for some
    except ValueError:
        return urlsplit("")
    return parts

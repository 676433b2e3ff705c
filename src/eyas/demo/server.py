"""The server of the demo: the page over HTTP, and one WebSocket for each viewer, on one port."""

import asyncio
import hmac
import json
import re
import secrets
import socket
from collections.abc import Callable, Mapping
from functools import cache
from http import HTTPStatus
from importlib.resources import files
from pathlib import Path
from urllib.parse import SplitResult, parse_qs, urlsplit

from websockets.asyncio.server import Server as WebSocketServer
from websockets.asyncio.server import ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from eyas.demo import messages as said
from eyas.demo.frame import DemoFrame
from eyas.demo.stages import File, Flying, Stage
from eyas.demo.viewers import Viewer, Viewers
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.core.faults import FaultLog

PAGE = Path(str(files("eyas.demo"))) / "page"

_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}


@cache
def _names() -> dict[str, Path]:
    return {f"/{path.name}": path for path in PAGE.iterdir() if path.suffix in _TYPES}


def page_file(path: str) -> File | None:
    """Return a file of the page; None if there is none with this path."""
    found = _names().get(path)
    return None if found is None else (_TYPES[found.suffix], found.read_bytes())


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


SOCKET = "/socket"
ERRORS = 20  # Refused messages after which a connection is closed
MOST_VIEWERS = 16

_SAFE = {
    "Content-Security-Policy": "default-src 'self'; img-src 'self' blob: data:; "
    "frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}


class DemoServer:
    """Serves one stage on a socket of `listen`."""

    _thread: Flying
    _next: Stage | None

    def __init__(self, stage: Stage, host: str, listening: socket.socket) -> None:
        self._stage, self._host, self._listening = stage, host, listening
        self._gate, self._faults = Gate(host), FaultLog()

    async def run(self, begun: Callable[[str], None]) -> None:
        """Serve until this task is cancelled.

        Args:
            begun: Is called with the address, once it answers.
        """
        self.viewers = Viewers(asyncio.get_running_loop())
        self._thread, self._next = self._stage.flying(self.viewers), None
        async with serve(
            self._talk,
            sock=self._listening,
            process_request=self._answer,
            max_size=said.LONGEST,
            compression=None,  # pictures are compressed already
            close_timeout=1,
        ) as server:
            begun(self._address(server))
            while True:
                await self._fly()
                if (after := self._next or self._stage.after()) is None:
                    return
                self._stage, self._next = after, None
                self._thread = after.flying(self.viewers)
                self.viewers.tell({"reload": True})

    async def _fly(self) -> None:
        """Fly until the stage is over or left."""
        flying = asyncio.create_task(asyncio.to_thread(self._thread.run))
        try:
            await asyncio.shield(flying)
        finally:
            self._thread.stop()
            await flying

    def _address(self, server: WebSocketServer) -> str:
        port = next(iter(server.sockets)).getsockname()[1]
        shown = f"[{self._host}]" if ":" in self._host else self._host
        token = "" if self._gate.token is None else f"?token={self._gate.token}"
        return f"http://{shown}:{port}/{token}"

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """Answer a request, or let a WebSocket begin."""
        if getattr(request, "method", "GET") != "GET":  # old websockets let nothing else in
            return _text(HTTPStatus.METHOD_NOT_ALLOWED, "only GET is answered", Allow="GET")
        path = path_of(request)
        page = page_file(self._stage.page if path == "/" else path)
        public = page is not None and path != "/" and not path.endswith(".html")
        refused = self._gate.refusal(request, private=not public)
        if refused is not None:
            return _text(HTTPStatus.FORBIDDEN, refused)
        if path == SOCKET:
            return None
        try:
            found = page or self._stage.file(path)
        except ConfigError as error:
            return _text(HTTPStatus.CONFLICT, str(error))
        if found is None:
            return _text(HTTPStatus.NOT_FOUND, "there is no such page")
        return _response(HTTPStatus.OK, *found)

    async def _talk(self, connection: ServerConnection) -> None:
        """Serve one viewer until it goes."""
        assert connection.request is not None
        asked = query_of(connection.request)
        viewer = Viewer(flies=asked.get("role") != ["tracker"])
        if self.viewers.count >= MOST_VIEWERS:
            await connection.close(1013, "there are too many viewers")
            return
        viewer.tell(self._stage.greeting())
        self.viewers.add(viewer)
        sending = asyncio.create_task(_send(connection, viewer))
        try:
            await self._listen(connection, viewer)
        except ConnectionClosed:
            pass
        finally:
            sending.cancel()
            self.viewers.remove(viewer)

    async def _listen(self, connection: ServerConnection, viewer: Viewer) -> None:
        errors = 0
        async for text in connection:
            with self._faults.guard("message of a page"):
                try:
                    message = said.parsed(text)
                    if isinstance(message, said.StageMessage) and viewer is self.viewers.pilot:
                        # Reading a protocol and its log takes a while.
                        self._next = await asyncio.to_thread(self._stage.other, message.protocol)
                        self._thread.stop()
                    else:
                        self._hear(viewer, message)
                except EyasError as error:
                    errors += 1
                    viewer.tell({"error": str(error)})
            if errors >= ERRORS:
                await connection.close(1008, "too many messages were refused")

    def _hear(self, viewer: Viewer, message: said.Message) -> None:
        """Take a message."""
        if isinstance(message, said.AckMessage):
            viewer.acknowledge(message.frame, 0.001 * message.spent)
            if self._stage.hears_acks and viewer is self.viewers.pilot:
                self._thread.put(message)
        elif isinstance(message, said.PicturesMessage):
            viewer.choose(message.coding)
        elif isinstance(message, said.DoMessage) and message.what == "pilot" and viewer.flies:
            self.viewers.appoint(viewer)
        elif viewer is self.viewers.pilot or isinstance(message, said.BoxMessage):
            self._thread.put(message)
        elif not isinstance(message, said.KeysMessage | said.LookMessage):
            raise ConfigError("message: another page flies; take the controls first")


async def _send(connection: ServerConnection, viewer: Viewer) -> None:
    """Send a viewer its frames and texts."""
    try:
        while True:
            what = await viewer.next()
            if not isinstance(what, DemoFrame):
                await connection.send(json.dumps(what))
                continue
            try:
                data = await asyncio.to_thread(viewer.coded, what)
            except EyasError as error:
                viewer.choose("jpeg")
                viewer.tell({"error": str(error)})
            else:
                viewer.sends(what)
                await connection.send(data)
    except ConnectionClosed:
        return


def _text(status: HTTPStatus, text: str, **more: str) -> Response:
    return _response(status, "text/plain; charset=utf-8", f"{text}\n".encode(), more)


def _response(
    status: HTTPStatus, kind: str, body: bytes, more: Mapping[str, str] = _SAFE
) -> Response:
    length = str(len(body))
    headers = Headers({"Content-Type": kind, "Content-Length": length, **_SAFE, **more})
    return Response(status.value, status.phrase, headers, body)

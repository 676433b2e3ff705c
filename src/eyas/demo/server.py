"""The server of the demo: the page over HTTP, and one WebSocket for each viewer, on one port."""

import asyncio
import json
import socket
from collections.abc import Callable, Mapping
from http import HTTPStatus
from typing import Any

from websockets.asyncio.server import Server as WebSocketServer
from websockets.asyncio.server import ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from eyas import __version__
from eyas.demo import messages as said
from eyas.demo.flight_thread import FlightThread
from eyas.demo.frame import DemoFrame
from eyas.demo.orders import BOXES, reward_of, world_now
from eyas.demo.requests import Gate, own_file, page_file, path_of, query_of
from eyas.demo.session import Session
from eyas.demo.viewers import Viewer, Viewers
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.core.faults import FaultLog
from eyas.engine.targets.config import TargetName
from eyas.engine.world.maps import MAPS

__all__ = ["DemoServer"]

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
    """Serves one session.

    Attributes:
        viewers: Those who watch.

    Args:
        session: What is flown.
        listening: Its socket, see `listen`.
    """

    def __init__(self, session: Session, host: str, listening: socket.socket) -> None:
        self._session, self._host, self._listening = session, host, listening
        self._gate, self._faults = Gate(host), FaultLog()

    async def run(self, begun: Callable[[str], None]) -> None:
        """Serve until this task is cancelled.

        Args:
            begun: Is called with the address, once it answers.
        """
        self.viewers = Viewers(asyncio.get_running_loop())
        self._thread = FlightThread(self._session, self.viewers)
        async with serve(
            self._talk,
            sock=self._listening,
            process_request=self._answer,
            max_size=said.LONGEST,
            compression=None,  # pictures are compressed already
            close_timeout=1,
        ) as server:
            flying = asyncio.create_task(asyncio.to_thread(self._thread.run))
            begun(self._address(server))
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
        page = page_file(path)
        public = page is not None and path not in ("/", "/index.html")
        refused = self._gate.refusal(request, private=not public)
        if refused is not None:
            return _text(HTTPStatus.FORBIDDEN, refused)
        if path == SOCKET:
            return None
        try:
            found = page or own_file(path, self._session)
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
        viewer.tell(self._greeting())
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
                    self._hear(viewer, said.parsed(text))
                except ConfigError as error:
                    errors += 1
                    viewer.tell({"error": str(error)})
            if errors >= ERRORS:
                await connection.close(1008, "too many messages were refused")

    def _hear(self, viewer: Viewer, message: said.Message) -> None:
        """Take a message.

        Raises:
            ConfigError: Only who flies may say this.
        """
        if isinstance(message, said.AckMessage):
            viewer.acknowledge(message.frame, 0.001 * message.spent)
        elif isinstance(message, said.PicturesMessage):
            viewer.choose(message.coding)
        elif isinstance(message, said.DoMessage) and message.what == "pilot" and viewer.flies:
            self.viewers.appoint(viewer)
        elif viewer is self.viewers.pilot or isinstance(message, said.BoxMessage):
            self._thread.put(message)
        elif not isinstance(message, said.KeysMessage | said.LookMessage):
            raise ConfigError("message: another page flies; take the controls first")

    def _greeting(self) -> dict[str, Any]:
        """Return what a page must know to begin."""
        maps = {}
        for name in sorted(MAPS.names()):
            recipe = MAPS.get(name)
            maps[name] = {"title": recipe.title, "weathers": recipe.weathers}
        policies = [*self._session.policies, BOXES]
        most = self._session.flight.config.traffic.max_vehicles
        told = {
            "hello": __version__,
            "maps": maps,
            "policies": policies,
            "most_vehicles": most,
            "targets": [name.value for name in TargetName],
            "lights": list(said.LIGHTS),
        }
        return told | reward_of(self._session) | world_now(self._session)


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

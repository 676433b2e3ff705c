"""Those who watch: each gets the newest frame, and never more than two that it has not shown."""

import asyncio
from collections import deque
from collections.abc import Callable
from typing import Any

from eyas.modes.demo.frame import Frame

__all__ = ["Viewer", "Viewers"]

IN_FLIGHT = 2
"""Largest number of frames that a viewer has not acknowledged."""
TEXTS = 32
"""Largest number of texts that wait for a viewer; older ones are dropped."""


class Viewer:
    """A page, or a tracker outside; used in the server's thread only.

    Attributes:
        flies: Whether it may fly: pages, not trackers.
        sent: Frames that were sent.
    """

    def __init__(self, *, flies: bool) -> None:
        self.flies = flies
        self.sent = 0
        self._unseen: deque[int] = deque()
        self._texts: deque[dict[str, Any]] = deque(maxlen=TEXTS)
        self._frame: Frame | None = None
        self._wake = asyncio.Event()

    @property
    def ready(self) -> bool:
        """Whether a frame could be sent now."""
        return len(self._unseen) < IN_FLIGHT

    def acknowledge(self, number: int) -> None:
        """Take that a frame, and all before it, are shown."""
        while self._unseen and self._unseen[0] <= number:
            self._unseen.popleft()
        self._wake.set()

    def show(self, frame: Frame) -> None:
        """Send a frame, in the place of one that still waits."""
        self._frame = frame
        self._wake.set()

    def tell(self, what: dict[str, Any]) -> None:
        """Send a text."""
        self._texts.append(what)
        self._wake.set()

    async def next(self) -> dict[str, Any] | Frame:
        """Return what to send next; texts come first."""
        while True:
            if self._texts:
                return self._texts.popleft()
            if self._frame is not None and self.ready:
                frame, self._frame = self._frame, None
                self._unseen.append(frame.number)
                self.sent += 1
                return frame
            self._wake.clear()
            await self._wake.wait()


class Viewers:
    """All viewers; an `Audience` for the session's thread.

    Attributes:
        pilot: The viewer who flies.

    Args:
        loop: The server's event loop.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._all: list[Viewer] = []
        self.pilot: Viewer | None = None

    @property
    def count(self) -> int:
        """Number of viewers."""
        return len(self._all)

    def add(self, viewer: Viewer) -> None:
        """Let a viewer in; the first page flies."""
        self._all.append(viewer)
        if self.pilot is None and viewer.flies:
            self.appoint(viewer)
        self._tell_roles()

    def remove(self, viewer: Viewer) -> None:
        """Let a viewer go; if it has flown, the page that came first flies."""
        self._all.remove(viewer)
        if self.pilot is viewer:
            self.pilot = next((other for other in self._all if other.flies), None)
        self._tell_roles()

    def appoint(self, viewer: Viewer) -> None:
        """Let a page fly."""
        self.pilot = viewer
        self._tell_roles()

    def _tell_roles(self) -> None:
        for viewer in self._all:
            viewer.tell({"pilot": viewer is self.pilot, "viewers": len(self._all)})

    def wants_frame(self) -> bool:
        """Return whether anyone can take a frame now."""
        return any(viewer.ready for viewer in tuple(self._all))

    def show(self, frame: Frame) -> None:
        """Send a frame to all who can take one."""

        def show() -> None:
            for viewer in self._all:
                viewer.show(frame)

        self._in_loop(show)

    def tell(self, what: dict[str, Any]) -> None:
        """Tell all something."""

        def tell() -> None:
            for viewer in self._all:
                viewer.tell(what)

        self._in_loop(tell)

    def _in_loop(self, act: Callable[[], None]) -> None:
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(act)

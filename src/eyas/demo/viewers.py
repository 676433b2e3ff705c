"""Those who watch: each gets the newest frame, and never more than two that it has not shown."""

import asyncio
import time
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from eyas.demo.frame import FACTORS, IN_FLIGHT, Coding, CodingChoice, DemoFrame, packed

if TYPE_CHECKING:  # PyAV takes its time to be imported; only H.264 needs it
    from eyas.demo.frame import Stream

TEXTS = 32  # Largest number of texts that wait for a viewer; older ones are dropped


class Viewer:
    """A page, or a tracker outside; used in the server's thread only, but for `coded`.

    Attributes:
        flies: Whether it may fly: pages, not trackers.
    """

    def __init__(self, *, flies: bool) -> None:
        self.flies = flies
        self._coding = CodingChoice(time.monotonic())
        self._stream: Stream | None = None
        self._stream_of: tuple[object, ...] = ()
        self._streams = 0
        self._unseen: deque[int] = deque()
        self._sent: dict[int, float] = {}
        self._texts: deque[dict[str, Any]] = deque(maxlen=TEXTS)
        self._frame: DemoFrame | None = None
        self._wake = asyncio.Event()

    @property
    def ready(self) -> bool:
        """Whether a frame could be sent now."""
        return len(self._unseen) < IN_FLIGHT

    def acknowledge(
        self,
        number: int,  # Of the frame
        spent: float,  # Time from its arrival until then [s]
    ) -> None:
        """Take that a frame, and all before it, are shown."""
        while self._unseen and self._unseen[0] <= number:
            self._unseen.popleft()
        sent, now = self._sent.pop(number, None), time.monotonic()
        if sent is not None:
            self._coding.arrive(now - sent - spent, now)
        self._sent = {other: then for other, then in self._sent.items() if other > number}
        self._wake.set()

    def choose(self, coding: Coding) -> None:
        """Choose how pictures are coded; H.264 begins anew, with a whole picture."""
        self._coding.choose(coding, time.monotonic())
        self._streams += 1

    def show(self, frame: DemoFrame) -> None:
        """Send a frame, in the place of one that still waits."""
        self._frame = frame
        self._wake.set()

    def tell(self, what: dict[str, Any]) -> None:
        """Send a text."""
        self._texts.append(what)
        self._wake.set()

    async def next(self) -> dict[str, Any] | DemoFrame:
        """Return what to send next; texts come first."""
        while True:
            if self._texts:
                return self._texts.popleft()
            if self._frame is not None and self.ready:
                frame, self._frame = self._frame, None
                self._unseen.append(frame.number)
                return frame
            self._wake.clear()
            await self._wake.wait()

    def sends(self, frame: DemoFrame) -> None:
        """Take that a frame is sent now."""
        self._sent[frame.number] = time.monotonic()

    def coded(self, frame: DemoFrame) -> bytes:
        """Return a frame as this viewer takes it; call it in a thread, once for each frame.

        The kind of the picture is `jpeg`, or of an H.264 stream `key`, which begins one, or
        `delta`, which needs all before it. Frames are dropped before they come here, never after.

        Raises:
            EyasError: H.264 cannot be had.
        """
        level = self._coding.level
        if not level:
            self._stream, self._stream_of = None, ()
            return packed(frame, "jpeg", frame.jpeg())
        from eyas.demo.frame import Stream

        of = (*frame.rgb.shape, level, self._streams)
        begins = self._stream is None or of != self._stream_of
        if self._stream is None or begins:
            height, width, _ = frame.rgb.shape
            self._stream = Stream(height, width, FACTORS[level - 1])
            self._stream_of = of
        return packed(frame, "key" if begins else "delta", self._stream.encode(frame.rgb))


class Viewers:
    """All viewers, with the pilot among them; an `Audience` for the session's thread."""

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

    def show(self, frame: DemoFrame) -> None:
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

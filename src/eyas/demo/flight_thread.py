"""The thread of the demo: it hears the pilot, flies by the clock, and draws frames."""

import queue
import time
from collections.abc import Callable
from functools import partial
from typing import Any, Protocol

from eyas.demo.frame import DemoFrame
from eyas.demo.messages import Message, WorldMessage
from eyas.demo.orders import (
    carry_out,
    change_sides,
    end_film,
    end_recording,
    enter_new_world,
    world_now,
)
from eyas.demo.session import FRAME, Session
from eyas.engine.core.errors import EyasError
from eyas.engine.core.faults import FaultLog


class Audience(Protocol):
    """Those who watch; its methods are called in the thread of the session."""

    def wants_frame(self) -> bool:
        """Return whether anyone can take a frame now."""
        ...

    def show(self, frame: DemoFrame) -> None:
        """Send a frame to all who can take one."""
        ...

    def tell(self, what: dict[str, Any]) -> None:
        """Tell all something."""
        ...


class FlightThread:
    """Flies what is in a session, for an audience."""

    def __init__(
        self,
        session: Session,  # What is flown
        audience: Audience,  # Those who watch
    ) -> None:
        self.session = session
        self._audience, self._faults = audience, FaultLog()
        self._inbox: queue.SimpleQueue[Message | None] = queue.SimpleQueue()

    def put(self, message: Message) -> None:
        """Take what the pilot says; may be called in any thread."""
        self._inbox.put(message)

    def stop(self) -> None:
        """End `run`; may be called in any thread."""
        self._inbox.put(None)

    def run(self) -> None:
        """Fly until `stop`; a recording is ended."""
        try:
            due = time.monotonic()
            while self._hear(due):
                now = time.monotonic()
                due = max(due + FRAME, now)
                self._try(lambda: enter_new_world(self.session), self._stay)
                self._try(partial(self._fly, now), self._drop_controller)
                if self._audience.wants_frame():
                    self._audience.show(self.session.frame(now))
        finally:
            self._try(lambda: end_recording(self.session))
            self.session.builder.stop()

    def _fly(self, now: float) -> dict[str, Any] | None:
        """Fly until now, let the other side of a duel begin, and end a film that is over."""
        self.session.advance(now)
        if self.session.sides_change:
            change_sides(self.session)
        return end_film(self.session)

    def _hear(self, due: float) -> bool:
        """Carry out messages until the next frame is due; return whether to go on."""
        while True:
            left = due - time.monotonic()
            try:
                message = self._inbox.get(timeout=left) if left > 0 else self._inbox.get_nowait()
            except queue.Empty:
                return True
            if message is None:
                return False
            self._carry_out(message)

    def _carry_out(self, message: Message) -> None:
        stay = self._stay if isinstance(message, WorldMessage) else None
        with self._faults.guard(f"message {type(message).__name__}"):
            self._try(lambda: carry_out(self.session, message), stay)

    def _try(
        self, act: Callable[[], dict[str, Any] | None], otherwise: Callable[[], None] | None = None
    ) -> None:
        """Do something, and tell the audience what came of it, also if it failed."""
        try:
            told = act()
        except EyasError as error:
            told = {"error": str(error)}
            if otherwise is not None:
                otherwise()
        if told is not None:
            self._audience.tell(told)

    def _stay(self) -> None:
        """Let the menus show the present world, after another could not be built."""
        self.session.duel_later = self.session.film_later = None
        self._audience.tell(world_now(self.session))

    def _drop_controller(self) -> None:
        """Let the keys fly, and record no more, after a failure in flight."""
        self.session.hand_over(None, None)
        self.session.duel = None
        recording, self.session.recording = self.session.recording, None
        if recording is not None:
            recording.abandon()

"""The loop that serves vehicles to programs outside, and what a protocol brings to it: a `Face`.

The loop owns time: by the clock, in lock-step, or as fast as possible. It moves the simulation,
reports faults, and ends. A face only hears, orders and answers.
"""

import logging
import math
import time
from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.errors import EyasError
from eyas.engine.core.faults import FaultLog

if TYPE_CHECKING:  # slow to import, and a server listens before
    import numpy as np
    from numpy.typing import NDArray

    from eyas.engine.sim.simulation import Simulation


_LOG = logging.getLogger("eyas")

_LONGEST = 0.1  # time of one wait, so that a signal is heard and idle peers are noticed [s]
_LATEST = 0.1  # what is behind the clock by more is not caught up: a slow machine flies slower [s]
_BEAT = 1.0  # between two calls of `Face.idle` [s]
_REPORT = 5.0  # over what time it is judged whether the machine is fast enough [s]


class Orders(NamedTuple):
    """What the vehicles do next."""

    commands: "NDArray[np.float64]"
    """As for `Simulation.advance`, shape (N, 4) or (N, 8)."""
    steps: int
    """Physics steps of 2 ms for which they hold; 0: nobody moves, and the answer is given."""


class Face(ABC):
    """A protocol by which programs outside fly vehicles.

    Attributes:
        simulation: The vehicles; needed as soon as there are orders.
        relief: What helps on a machine that is too slow, for the log.
    """

    simulation: "Simulation"
    relief = "smaller pictures help (camera.width, camera.height)"

    @property
    def speed(self) -> float:
        """Most simulated seconds in a second; 0: as many as machine and peers can. May change."""
        return 1.0

    def open(self) -> None:  # noqa: B027  # few need it
        """Begin to listen."""

    @abstractmethod
    def receive(self, wait: float) -> Iterable[tuple[str, Any]]:
        """Return the messages that have come, each with its name for the log.

        Args:
            wait: How long to wait if there is none yet [s].
        """

    @abstractmethod
    def take(self, message: Any) -> None:  # noqa: ANN401  # the protocol's
        """Handle a message; whatever error is raised becomes a line in the log."""

    @abstractmethod
    def orders(self) -> Orders | None:
        """Return what is to be done now; None: time stands still until more has come."""

    @abstractmethod
    def answer(self, *, late: bool) -> None:
        """Tell what has come of the orders.

        Args:
            late: Whether the next step is due already, so that pictures may be left out.
        """

    def idle(self, stood: float) -> None:  # noqa: B027  # few need it
        """Do what must be done while time stands still or is slow; called once a second.

        Args:
            stood: How long time has stood still [s].
        """

    def rewind(self) -> None:
        """Go on where the recorded traffic is too short for the orders: all begin anew."""
        _LOG.info("the traffic has reached its end, and all begins anew")
        self.simulation.rewind()
        self.simulation.reset()

    def fail(self, error: EyasError) -> None:
        """End because of an error, or give up only those whom it concerns, and return."""
        raise error

    def close(self) -> None:  # noqa: B027  # few need it
        """End all that `open` has begun, and what the face itself has."""


def serve(face: Face, *, until_idle: float = math.inf) -> None:
    """Serve until the user stops it, or nothing has come for long.

    Args:
        face: The protocol; it is closed in the end.
        until_idle: Time without a message after which it ends [s].

    Raises:
        EyasError: It cannot be served.
        KeyboardInterrupt: The user stopped it.
    """
    try:
        face.open()
        loop = Loop(face)
        while loop.quiet <= until_idle:
            loop.turn()
        _LOG.info("no client for %g s: ended", until_idle)
    finally:
        face.close()


class Loop:
    """One turn after the other: hear, order, move, answer."""

    def __init__(
        self,
        face: Face,  # The protocol, open
    ) -> None:
        self._face, self._clock, self._faults = face, _Clock(face.relief), FaultLog()
        self._heard = self._beaten = time.monotonic()
        self._stands: float | None = None  # since when time stands still [s, monotonic]

    @property
    def quiet(self) -> float:
        """Time since the last message [s]."""
        return time.monotonic() - self._heard

    def turn(self) -> None:
        """Hear what comes, until the next step is due or for a tenth of a second; then step."""
        face = self._face
        try:
            stands = self._stands is not None
            self.hear(_LONGEST if stands else min(self._clock.left(face.speed), _LONGEST))
            if self._clock.left(face.speed) > 0.0:
                return
            if self.step():
                self._stands = None
                if not self._clock.slow:
                    return
        except EyasError as error:
            face.fail(error)
            return
        self._beat()

    def hear(self, wait: float) -> None:
        """Take the messages that come within a time [s]."""
        for name, message in self._face.receive(wait):
            with self._faults.guard(name):
                self._face.take(message)
            self._heard = time.monotonic()

    def step(self) -> bool:
        """Carry out the orders of now; return whether there were any."""
        face = self._face
        orders = face.orders()
        if orders is None:
            if self._stands is None:
                self._stands = time.monotonic()
            return False
        late = self._clock.late(
            orders.steps * PHYSICS_STEP, face.speed, waited=self._stands is not None
        )
        if orders.steps:
            if face.simulation.steps_left < orders.steps:
                face.rewind()
            face.simulation.advance(orders.commands, orders.steps)
        face.answer(late=late)
        return True

    def _beat(self) -> None:
        now = time.monotonic()
        if now - self._beaten > _BEAT:
            self._beaten = now
            self._face.idle(now - self._stands if self._stands is not None else 0.0)


class _Clock:
    """Keeps simulated time from running ahead of the clock, and tells when it falls behind.

    Attributes:
        slow: Whether the last step has come so late that time was lost.

    Args:
        relief: What helps on a slow machine.
    """

    def __init__(self, relief: str) -> None:
        self.slow = False
        self._relief = relief
        self._due = self._since = time.monotonic()
        self._lost, self._reported = 0.0, False

    def left(self, speed: float) -> float:
        """Return the time until the next step is due [s]."""
        return max(self._due - time.monotonic(), 0.0) if speed else 0.0

    def late(self, seconds: float, speed: float, *, waited: bool) -> bool:
        """Count a step; return whether the one after it is due already.

        Args:
            seconds: Length of the step [s].
            speed: See `Face.speed`.
            waited: Whether time has stood still before it, so that no machine is too slow.
        """
        now = time.monotonic()
        behind = now - self._due
        dropped = speed == 0.0 or behind > _LATEST
        self.slow = dropped and speed != 0.0 and not waited
        if self.slow:
            self._lose(behind, now)
        if dropped:
            self._due = now
        self._due += seconds / speed if speed else 0.0
        return speed != 0.0 and self._due <= now

    def _lose(self, seconds: float, now: float) -> None:
        """Report a machine that is too slow, once."""
        if now - self._since > _REPORT:
            self._since, self._lost = now, 0.0
        self._lost += seconds
        if self._lost > 0.2 * _REPORT and not self._reported:
            self._reported = True
            _LOG.warning(
                "this machine cannot keep up: vehicles fly slower than the clock; %s", self._relief
            )

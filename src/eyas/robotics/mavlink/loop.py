"""Lets a fleet fly by the clock, or in lock-step with those who fly it."""

import logging
import math
import select
import time
from collections.abc import Sequence

from eyas.robotics.mavlink.endpoint import Endpoint
from eyas.robotics.mavlink.fleet import Fleet

__all__ = ["fly"]

_LOG = logging.getLogger("eyas")

_LATEST = 0.1
"""By how much a fleet may be behind [s]; a slower machine flies slower."""
_BEAT = 1.0
"""Between heartbeats while time stands still, or is slow [s]."""
_PATIENCE = 10.0
"""How long time stands still for a vehicle without a set point [s]."""
_REPORT = 5.0
"""Over what time it is judged whether the machine is fast enough [s]."""


def fly(fleet: Fleet, endpoints: Sequence[Endpoint], *, lockstep: bool) -> None:
    """Fly until the user stops it.

    Args:
        fleet: Who flies.
        endpoints: Where messages come from.
        lockstep: Whether time stands still while a vehicle in offboard mode waits for a set point.
    """
    pace = _Pace(fleet)
    while True:
        wait = pace.left()
        if lockstep and fleet.offboard:
            wait = 0.0 if not fleet.waits else 0.05
        _hear(fleet, endpoints, wait)
        if lockstep and fleet.offboard:
            pace.stand_still()
            if not fleet.waits:
                fleet.step()
            continue
        due = pace.due()
        for left in reversed(range(due)):
            fleet.step(look=left == 0)


def _hear(fleet: Fleet, endpoints: Sequence[Endpoint], wait: float) -> None:
    """Take what comes within a time [s]."""
    ready, _, _ = select.select([end.socket for end in endpoints], [], [], wait)
    if ready:
        fleet.take([message for end in endpoints for message in end.received()])


class _Pace:
    """The clock of a fleet.

    Args:
        fleet: Who flies.
    """

    def __init__(self, fleet: Fleet) -> None:
        self._fleet = fleet
        self._next = self._moved = self._beaten = time.monotonic()
        self._since, self._lost, self._told = self._next, 0.0, False

    def left(self) -> float:
        """Return the time until the next step [s]."""
        return max(self._next - time.monotonic(), 0.0)

    def due(self) -> int:
        """Return how many steps are due, and count them: a slow machine draws fewer pictures first,
        then flies slower.
        """
        now, period = time.monotonic(), self._fleet.period
        self._moved = now
        behind = now - self._next - _LATEST
        if behind > 0.0:
            self._next += behind
            self._lose(behind, now)
        count = max(math.floor((now - self._next) / period) + 1, 0)
        self._next += count * period
        return count

    def _lose(self, seconds: float, now: float) -> None:
        """Report a machine that is too slow, once."""
        if now - self._since > _REPORT:
            self._since, self._lost = now, 0.0
        self._lost += seconds
        if now - self._beaten > _BEAT:
            self._beaten = now
            self._fleet.beat()
        if self._lost > 0.2 * _REPORT and not self._told:
            self._told = True
            _LOG.warning(
                "this machine cannot keep up: vehicles fly slower than the clock; smaller or fewer "
                "pictures help (camera.width, camera.height, mavlink.picture_rate)"
            )

    def stand_still(self) -> None:
        """Let no time pass: only heartbeats are sent, and who sends no set point for long is given
        up, whatever else comes: a ground station's heartbeats go on when the program has died.
        """
        now = self._next = time.monotonic()
        if not self._fleet.waits:
            self._moved = now
        if now - self._beaten > _BEAT:
            self._beaten = now
            self._fleet.beat()
        if now - self._moved > _PATIENCE:
            self._fleet.hold("No set points")
            self._moved = now

"""How fast simulated time may go."""

import time

__all__ = ["Pace"]

_LATEST = 0.1
"""What is behind by more is not caught up [s]."""


class Pace:
    """Keeps simulated time from running ahead of the clock.

    Args:
        speed: Most simulated seconds in a second; 0: any number.
    """

    def __init__(self, speed: float) -> None:
        self._speed = speed
        self._simulated, self._clock = 0.0, time.monotonic()

    def keep(self, simulated: float, *, least: float = 0.0) -> None:
        """Wait until the clock has come as far as a simulated time [s].

        Args:
            simulated: The time.
            least: The speed to take if there is none.
        """
        speed = self._speed or least
        if speed == 0.0:
            self._simulated, self._clock = simulated, time.monotonic()
            return
        due = self._clock + (simulated - self._simulated) / speed
        now = time.monotonic()
        if due > now:
            time.sleep(due - now)
        elif now - due < _LATEST:
            return
        self._simulated, self._clock = simulated, max(due, now)

"""How fast the demo goes, and how large its pictures can be."""

from eyas.core.clock import PHYSICS_RATE

__all__ = ["FRAME", "Clock", "Size"]

FRAME = 1.0 / 30.0
"""Between frames [s]."""
LONGEST = 0.1
"""Of a frame, in seconds of the clock: a slower machine flies slower, not farther at a time."""
SMALLEST, FIRST, LARGEST = 480 * 270, 640 * 360, 1280 * 720
"""Pixels of a picture."""


class Clock:
    """Turns time into physics steps.

    Attributes:
        speed: Seconds of the simulation in a second.
    """

    def __init__(self, now: float) -> None:
        self.speed = 1.0
        self._last, self._owed = now, 0.0

    def skip(self, now: float) -> None:
        """Leave out the time since the last steps."""
        self._last = now

    def steps(self, now: float) -> int:
        """Return the steps that are due."""
        self._owed += min(now - self._last, LONGEST) * self.speed * PHYSICS_RATE
        self._last = now
        due = int(self._owed)
        self._owed -= due
        return due


class Size:
    """Chooses the largest picture that the machine can draw in time, in the window's shape."""

    def __init__(self) -> None:
        self._window = (640, 360)
        self._pixels = float(FIRST)
        self._cost = 0.5 * FRAME
        self.now = (640, 360)

    def fit(self, width: int, height: int) -> None:
        """Take the size of the window [pixels]."""
        self._window = width, height
        self._choose()

    def spent(self, seconds: float) -> None:
        """Take the time that a picture took; grow, or shrink, a little."""
        self._cost += 0.1 * (seconds - self._cost)
        if self._cost > 0.8 * FRAME:
            self._pixels = max(self._pixels * 0.97, SMALLEST)
        elif self._cost < 0.45 * FRAME:
            self._pixels = min(self._pixels * 1.02, LARGEST)
        now = self.now[0] * self.now[1]
        if not 0.85 < self._pixels / now < 1.15:
            self._choose()

    def _choose(self) -> None:
        width, height = self._window
        shape = min(max(width / height, 0.4), 3.0)
        pixels = min(self._pixels, max(width * height, SMALLEST))
        across = max(round((pixels * shape) ** 0.5 / 16) * 16, 16)
        self.now = across, max(round(across / shape / 2) * 2, 16)

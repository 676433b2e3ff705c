"""How fast the demo goes, and how large its pictures can be."""

from eyas.engine.core.clock import PHYSICS_RATE

__all__ = ["FRAME", "Clock", "PictureSize"]

FRAME = 1.0 / 30.0  # Between frames [s]
LONGEST = 0.1
"""Of a frame, in seconds of the clock: a slower machine flies slower, not farther at a time."""
SMALLEST, FIRST, LARGEST = 480 * 270, 640 * 360, 1280 * 720  # Pixels of a picture
STEP = 1.3
"""From one number of pixels to the next: seldom, for each change takes a whole picture of H.264."""
PATIENCE, MOST_PATIENCE = 60, 240
"""Frames with time to spare after which pictures grow; doubled each time they shrink."""


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


class PictureSize:
    """Chooses the largest picture that the machine can draw in time, in the window's shape.

    Attributes:
        now: Width and height [pixels].
    """

    def __init__(self) -> None:
        self._window = (640, 360)
        self._pixels = float(FIRST)
        self._cost = 0.5 * FRAME
        self._easy, self._patience = 0, PATIENCE
        self.now = (640, 360)

    def fit(self, width: int, height: int) -> None:
        """Take the size of the window [pixels]."""
        self._window = width, height
        self._choose()

    def spent(self, seconds: float) -> None:
        """Take the time that a picture took; shrink at once, grow after a while."""
        self._cost += 0.1 * (seconds - self._cost)
        self._easy = self._easy + 1 if STEP * self._cost < 0.6 * FRAME else 0
        if self._cost > 0.8 * FRAME and self._pixels > SMALLEST:
            self._patience = min(2 * self._patience, MOST_PATIENCE)
            self._change(1.0 / STEP)
        elif self._easy >= self._patience and self._pixels < LARGEST:
            self._change(STEP)

    def _change(self, factor: float) -> None:
        self._pixels = min(max(self._pixels * factor, SMALLEST), LARGEST)
        self._cost *= factor
        self._easy = 0
        self._choose()

    def _choose(self) -> None:
        width, height = self._window
        shape = min(max(width / height, 0.4), 3.0)
        pixels = min(self._pixels, max(width * height, SMALLEST))
        across = max(round((pixels * shape) ** 0.5 / 16) * 16, 16)
        self.now = across, max(round(across / shape / 2) * 2, 16)

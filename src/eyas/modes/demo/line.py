"""Chooses how the pictures of a viewer are coded, by what its line carries."""

from typing import Literal

__all__ = ["FACTORS", "Coding", "Line"]

Coding = Literal["auto", "jpeg", "h264"]

FACTORS = (23, 28, 33)
"""x264's constant rate factors; flying at 640 x 360 pixels, 15, 6 and 3 kB for each picture."""
_RANGES: dict[Coding, tuple[int, int]] = {
    "auto": (0, len(FACTORS)),
    "jpeg": (0, 0),
    "h264": (1, len(FACTORS)),
}

WANTED = 25.0
"""Frames that should get through in a second."""
PERIOD = 2.0
"""From one decision to the next [s]."""
FULL, EMPTY = 0.25, 0.1
"""Shares of the time with as many frames on their way as allowed: the line is slow; it has room."""
PATIENCE = 5
"""Periods with room on the line after which larger pictures are tried; it doubles each time."""
HELP = 1.1
"""Smaller pictures that do not raise the rate by this factor were not what the line needed."""
SETTLING = 4
"""Frames after a change that do not count: those on their way, and the first, which is whole."""
PAUSE = 60.0
"""After that, for how long smaller pictures are not tried [s]."""


class Line:
    """Measures how many frames get through, and for how long the viewer can take no more.

    Attributes:
        level: 0: JPEG; k: H.264 with the k-th of `FACTORS`.

    Args:
        now: The time [s].
    """

    def __init__(self, now: float) -> None:
        self.level = 0
        self.choose("jpeg", now)

    def choose(self, coding: Coding, now: float) -> None:
        """Let the viewer choose; `auto` begins with JPEG."""
        self._lowest, self._highest = _RANGES[coding]
        self.level = self._lowest
        self._patience, self._easy = PATIENCE, 0
        self._before: float | None = None
        self._paused_until = now
        self._full_since: float | None = None
        self._settling = SETTLING
        self._begin(now)

    def _begin(self, now: float) -> None:
        self._begun, self._full, self._arrived = now, 0.0, 0

    def fill(self, *, full: bool, now: float) -> None:
        """Take whether as many frames as allowed are on their way."""
        if self._full_since is not None:
            self._full += now - max(self._full_since, self._begun)
        self._full_since = now if full else None

    def arrive(self, frames: int, now: float) -> None:
        """Take that frames are shown; decide anew from time to time."""
        if self._settling > 0:
            self._settling -= frames
            self._begin(now)
            return
        self._arrived += frames
        span = now - self._begun
        if span >= PERIOD:
            before = self.level
            self._decide(self._arrived / span, self._full / span, now)
            self._settling = SETTLING if self.level != before else 0
            self._begin(now)

    def _decide(self, rate: float, full: float, now: float) -> None:
        slow = rate < WANTED and full > FULL
        self._easy = self._easy + 1 if full < EMPTY else 0
        if not slow:
            self._before = None
            if self._easy >= self._patience and self.level > self._lowest:
                self.level -= 1
                self._easy, self._patience = 0, 2 * self._patience
        elif self._before is not None and rate < HELP * self._before:
            # The way is long or the page slow, not the line: no size of pictures mends that.
            self.level -= 1
            self._before, self._paused_until = None, now + PAUSE
        elif now >= self._paused_until and self.level < self._highest:
            self.level += 1
            self._before = rate

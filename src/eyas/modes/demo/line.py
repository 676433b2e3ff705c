"""Chooses how the pictures of a viewer are coded, by the time that its line takes for them."""

from typing import Literal

__all__ = ["FACTORS", "IN_FLIGHT", "Coding", "Line"]

Coding = Literal["auto", "jpeg", "h264"]

IN_FLIGHT = 2
"""Largest number of frames that a viewer has not acknowledged."""

FACTORS = (23, 28, 33)
"""x264's constant rate factors; flying at 640 x 360 pixels, 15, 6 and 3 kB for each picture."""
_RANGES: dict[Coding, tuple[int, int]] = {
    "auto": (0, len(FACTORS)),
    "jpeg": (0, 0),
    "h264": (1, len(FACTORS)),
}

WANTED = 25.0
"""Frames that should get through in a second. If fewer do, the line is to blame if it takes longer
for each than the time between them."""
EASY = 0.024
"""A line that takes less time for a frame may have room for larger pictures [s]."""
PERIOD = 2.0
"""From one decision to the next [s]."""
PATIENCE = 5
"""Easy periods after which larger pictures are tried; it doubles each time."""
HELP = 1.3
"""If smaller pictures do not shorten the time by this factor, no smaller ones will."""
PAUSE = 60.0
"""After that, for how long smaller pictures are not tried [s]."""
SETTLING = 4
"""Frames after a change that do not count: those on their way, and the first, which is whole."""


class Line:
    """Measures the line of one viewer.

    Attributes:
        level: 0: JPEG; k: H.264 with the k-th of `FACTORS`.

    Args:
        now: The time [s].
    """

    def __init__(self, now: float) -> None:
        self.choose("jpeg", now)

    def choose(self, coding: Coding, now: float) -> None:
        """Let the viewer choose; `auto` begins with JPEG."""
        self._lowest, self._highest = _RANGES[coding]
        self.level = self._lowest
        self._patience, self._easy = PATIENCE, 0
        self._before: float | None = None
        self._paused_until = now
        self._settling = SETTLING
        self._begin(now)

    def _begin(self, now: float) -> None:
        self._begun, self._taken, self._count = now, 0.0, 0

    def arrive(self, taken: float, now: float) -> None:
        """Take an answer to a frame; decide anew from time to time.

        Args:
            taken: Time from sending the frame, without what the page has taken for it [s].
            now: The time [s].
        """
        if self._settling > 0:
            self._settling -= 1
            self._begin(now)
            return
        self._taken, self._count = self._taken + taken, self._count + 1
        if now >= self._begun + PERIOD:
            before = self.level
            rate = self._count / (now - self._begun)
            self._decide(self._taken / self._count, rate, now)
            self._settling = SETTLING if self.level != before else 0
            self._begin(now)

    def _decide(self, taken: float, rate: float, now: float) -> None:
        self._easy = self._easy + 1 if taken < EASY else 0
        if rate >= WANTED or taken <= 1.0 / WANTED:
            self._before = None
            if self._easy >= self._patience and self.level > self._lowest:
                self.level -= 1
                self._easy, self._patience = 0, 2 * self._patience
        elif self._before is not None and HELP * taken > self._before:
            # The way is long: no size of pictures mends that.
            self.level -= 1
            self._before, self._paused_until = None, now + PAUSE
        elif now >= self._paused_until and self.level < self._highest:
            self.level += 1
            self._before = taken

"""Waiting for files that another process writes or deletes."""

import time

__all__ = ["RARE", "Pause"]

_SHORTEST, _LONGEST = 0.0002, 0.02
"""Limits of a sleep [s]. Clients of the original look once in a millisecond themselves."""

RARE = 0.05
"""Time without an event after which to look for what happens rarely, too [s]."""


class Pause:
    """Sleeps between two looks at something: a tenth of the time waited so far.

    So waiting for long costs next to nothing, and what comes is seen at most a tenth (and 20 ms)
    too late. Notifications of the file system are not used, as network folders have none.
    """

    def __init__(self) -> None:
        self._since = time.monotonic()

    @property
    def long(self) -> bool:
        """Whether nothing has happened for so long that rare things may have."""
        return time.monotonic() - self._since > RARE

    def restart(self) -> None:
        """Begin to wait anew, because something happened."""
        self._since = time.monotonic()

    def sleep(self) -> None:
        """Sleep once."""
        waited = time.monotonic() - self._since
        time.sleep(min(max(0.1 * waited, _SHORTEST), _LONGEST))

"""Lines on stderr."""

import contextlib
import errno
import sys

from eyas.engine.core.errors import one_line


def say(line: str) -> None:
    """Print a line on stderr, unless its terminal is gone or its disk full."""
    with contextlib.suppress(OSError):
        print(f"eyas: {one_line(line)}", file=sys.stderr, flush=True)


_SIGNS = (
    "cannot allocate memory",
    "failed to map segment",
    "can't start new thread",
    "error return without exception set",  # Python itself, where it cannot even make the error
)
"""Messages of libraries and of Python where memory is too little for a library or a thread."""


def lacks_memory(error: BaseException | None) -> bool:
    """Return whether an error comes of too little memory."""
    while error is not None:
        if isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM:
            return True
        if any(sign in str(error).lower() for sign in _SIGNS):
            return True
        error = error.__cause__ or error.__context__
    return False

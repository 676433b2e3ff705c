"""Lines on stderr."""

import contextlib
import sys

__all__ = ["say"]


def say(line: str) -> None:
    """Print a line on stderr, unless its terminal is gone or its disk full."""
    with contextlib.suppress(OSError):
        print(f"eyas: {line}", file=sys.stderr, flush=True)

"""Lines on stderr."""

import contextlib
import sys

__all__ = ["say"]


def say(line: str) -> None:
    """Print a line on stderr, unless it is closed or its terminal is gone."""
    if sys.stderr is not None:  # or `print` would use stdout
        with contextlib.suppress(OSError, ValueError):
            print(f"eyas: {line}", file=sys.stderr, flush=True)

"""The cluster of Ray that a run spreads over; Ray is imported here only."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from eyas.core.errors import EyasError, MissingExtraError

__all__ = ["connected", "one_line"]


@contextmanager
def connected() -> Iterator[Any]:
    """Yield the module `ray`, connected to the cluster that `ray.init()` finds, or to a local one
    that lasts as long as the block.

    Raises:
        MissingExtraError: Ray is not installed.
        EyasError: There is no cluster at the address that the environment tells.
    """
    try:
        import ray
    except ImportError as error:
        raise MissingExtraError("--ray", "cluster") from error
    begun = not ray.is_initialized()
    if begun:
        _begin(ray)
    try:
        yield ray
    finally:
        if begun:
            ray.shutdown()


def _begin(ray: Any) -> None:  # noqa: ANN401  # a module
    main = threading.current_thread() is threading.main_thread()
    handler = signal.getsignal(signal.SIGTERM)
    try:
        ray.init()
    except Exception as error:  # Ray has no base for what can go wrong here
        raise EyasError(f"--ray: {one_line(error)}") from error
    if main:  # Ray's handler ends the process without a word
        signal.signal(signal.SIGTERM, handler)


def one_line(error: Exception) -> str:
    """Return the text of an error of Ray, which can have many lines."""
    return " ".join(str(error).split())[:500]

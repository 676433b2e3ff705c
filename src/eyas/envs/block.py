"""A process that holds a block of environments, for `eyas.envs.worker_fleet`."""

import signal
import traceback
from multiprocessing.connection import Connection
from typing import Any, NamedTuple

from eyas.core.errors import EyasError
from eyas.envs.fleet import Fleet
from eyas.envs.shared import SharedObservations
from eyas.lanes import limit_threads
from eyas.settings.config import EyasConfig

__all__ = ["Answer", "Block", "Calls", "serve"]

Calls = list[tuple[str, tuple[Any, ...]]]
"""Names of methods of a `Fleet`, and their arguments."""


class Block(NamedTuple):
    """What a process holds."""

    config: EyasConfig
    """Settings of all environments."""
    rows: slice
    """Indices of its own."""
    threads: int
    """Number of threads that draw."""
    observations: SharedObservations
    """Those of all environments."""


class Answer(NamedTuple):
    """What calls have led to."""

    result: Any = None
    """Of the last call."""
    error: str = ""
    """The first error, as a line; no call is made after it."""
    trace: str = ""
    """Its traceback, unless it is one that users can cause."""


def serve(block: Block, pipe: Connection) -> None:
    """Answer calls until the pipe is closed; the first answer is that the block is made."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that calls
    limit_threads(block.threads)
    fleet: Fleet | None = None
    calls: Calls = []
    while True:
        try:
            fleet = fleet or Fleet(
                block.config, block.rows.stop - block.rows.start, first=block.rows.start
            )
            answer = Answer(_done(fleet, calls, block))
        except EyasError as error:
            answer = Answer(error=str(error))
        except Exception as error:  # a user's reward term can raise anything
            line = " ".join(f"{type(error).__name__}: {error}".split())
            answer = Answer(error=line, trace=traceback.format_exc())
        try:
            pipe.send(answer)
            calls = pipe.recv()
        except (EOFError, OSError):  # closed, or the process that calls was killed
            return


def _done(fleet: Fleet, calls: Calls, block: Block) -> Any:  # noqa: ANN401  # of any method
    """Make calls; return the result of the last."""
    result = None
    for name, arguments in calls:
        result = getattr(fleet, name)(*arguments)
        if name == "look":
            fleet.copy_to(block.observations.of(block.rows))
    return result

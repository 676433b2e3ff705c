"""How an event loop ends by Ctrl-C: in its main task, and nowhere else."""

import asyncio
from collections.abc import Coroutine
from typing import Any

from eyas.lanes.interrupts import let_in, shielded

__all__ = ["run_until_signal"]

_LOOK = 0.05
"""Time from one look for signals to the next [s]."""


def run_until_signal(serving: Coroutine[Any, Any, None]) -> None:
    """Run a coroutine; a signal that asks the program to end cancels it.

    The interrupt is raised when the loop has ended. Raised in the loop, wherever that happens to
    be, it would be the failure of a task that nobody awaits, such as of one page's.

    Raises:
        KeyboardInterrupt: There was such a signal.
    """
    with shielded():
        interrupt = asyncio.run(_ended(serving))
    if interrupt is not None:
        raise interrupt


async def _ended(serving: Coroutine[Any, Any, None]) -> KeyboardInterrupt | None:
    """Await a coroutine; return the interrupt that has cancelled it, if any."""
    task, interrupt = asyncio.create_task(serving), None
    while not task.done():
        await asyncio.wait([task], timeout=_LOOK)
        try:
            let_in()
        except KeyboardInterrupt as raised:
            interrupt = interrupt or raised
            task.cancel()
    if not task.cancelled():
        task.result()
    return interrupt

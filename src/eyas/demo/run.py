"""Runs the demo in the browser, or as lines in a terminal."""

import asyncio
import socket
import time
import webbrowser
from collections.abc import Callable, Coroutine
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eyas.demo.live import LiveDemo
from eyas.demo.offer import Offer
from eyas.demo.orders import open_with_a_chase
from eyas.demo.session import Session
from eyas.engine.core.errors import OutputError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.task.step_line import step_line
from eyas.engine.terminal.screen import has_screen
from eyas.lanes.interrupts import let_in, shielded

if TYPE_CHECKING:
    from eyas.demo.stages import Stage
    from eyas.engine.recordings.rerun import LiveView

_LOOK = 0.05  # Time from one look for signals to the next [s]


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


RECORDINGS = Path("runs/demo")
LINES = 10  # Lines per second in a terminal


def session_of(
    config: EyasConfig, policy: str | None = None, live: "LiveView | None" = None
) -> Session:
    """Return what is flown in a demo.

    Args:
        policy: A policy that may fly, beside those that come with Eyas.
        live: Shows what the drone's camera sees.

    Raises:
        EyasError: The world cannot be built.
    """
    session = Session(config, partial(Offer.of, config, policy), RECORDINGS)
    session.live = None if live is None else LiveDemo(live)
    return session


def listen(host: str, port: int) -> socket.socket:
    """Return a socket that listens, before a world is built for nothing.

    Args:
        port: The port; 0: any that is free.

    Raises:
        OutputError: The port cannot be had.
    """
    try:
        family, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        return socket.create_server(address[:2], family=family)
    except OSError as error:
        raise OutputError(
            f"port {port} of {host}: cannot be used: {error.strerror or error}; "
            "name another with --port, or 0 for any"
        ) from None


def run_browser(
    stage: "Stage",  # What is flown
    host: str,
    listening: socket.socket,  # Its socket, see `listen`
    *,
    browser: bool,  # Whether to open a browser, where there is one
    say: Callable[[str], None],  # Prints the line with the address
) -> None:
    """Serve the demo's page until it is interrupted."""
    from eyas.demo.server import DemoServer

    def begun(address: str) -> None:
        say(address)
        if browser and has_screen():  # else one that runs in the terminal would start
            webbrowser.open(address)

    run_until_signal(DemoServer(stage, host, listening).run(begun))


def free_flight(session: Session) -> "Stage":
    """Return the stage of a session, which opens with a chase."""
    from eyas.demo.stages import FreeStage

    open_with_a_chase(session)
    return FreeStage(session)


def run_headless(
    session: Session,  # What is flown
    seconds: float,  # How long
    say: Callable[[str], None],  # Prints a line
) -> None:
    """Hover, and print the reward in real time as the original's console does."""
    begun = time.monotonic()
    session.clock.skip(begun)
    for line in range(1, round(seconds * LINES) + 1):
        time.sleep(max(begun + line / LINES - time.monotonic(), 0.0))
        session.advance(time.monotonic())
        say(step_line(session.flight.simulation.snapshot, 0, "DRONE0"))

"""Runs the demo in the browser, or as lines in a terminal."""

import os
import socket
import sys
import time
import webbrowser
from collections.abc import Callable
from pathlib import Path

from eyas.core.errors import OutputError
from eyas.evaluation.policies.shipped import shipped_names
from eyas.modes.demo.cockpit import Cockpit
from eyas.modes.demo.ending import run_until_signal
from eyas.modes.demo.orders import open_with_a_chase
from eyas.settings.config import EyasConfig
from eyas.task.step_line import step_line

__all__ = ["RECORDINGS", "cockpit_of", "listen", "run_browser", "run_headless"]

RECORDINGS = Path("runs/demo")
BUILT_IN = ("follow", "servo")
LINES = 10
"""Lines per second in a terminal."""


def cockpit_of(config: EyasConfig, policy: str | None = None) -> Cockpit:
    """Return what is flown in a demo.

    Args:
        config: The settings.
        policy: A policy that may fly, beside those that come with Eyas.

    Raises:
        EyasError: The world cannot be built.
    """
    names = (*BUILT_IN, *shipped_names(), *((policy,) if policy else ()))
    return Cockpit(config, tuple(dict.fromkeys(names)), RECORDINGS)


def listen(host: str, port: int) -> socket.socket:
    """Return a socket that listens, before a world is built for nothing.

    Args:
        host: The address to bind.
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
    cockpit: Cockpit,
    host: str,
    listening: socket.socket,
    *,
    browser: bool,
    say: Callable[[str], None],
) -> None:
    """Serve the demo's page until it is interrupted.

    Args:
        cockpit: What is flown.
        host: The address that is bound.
        listening: Its socket, see `listen`.
        browser: Whether to open a browser, where there is one.
        say: Prints the line with the address.
    """
    from eyas.modes.demo.server import Server

    open_with_a_chase(cockpit)

    def begun(address: str) -> None:
        say(address)
        if browser and _has_screen():
            webbrowser.open(address)

    run_until_signal(Server(cockpit, host, listening).run(begun))


def _has_screen() -> bool:
    """Return whether a browser could show up: else one that runs in the terminal would start."""
    if sys.platform != "linux":
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def run_headless(cockpit: Cockpit, seconds: float, say: Callable[[str], None]) -> None:
    """Hover, and print the reward in real time as the original's console does.

    Args:
        cockpit: What is flown.
        seconds: How long.
        say: Prints a line.
    """
    begun = time.monotonic()
    cockpit.clock.skip(begun)
    for line in range(1, round(seconds * LINES) + 1):
        time.sleep(max(begun + line / LINES - time.monotonic(), 0.0))
        cockpit.advance(time.monotonic())
        say(step_line(cockpit.flight.simulation.snapshot, 0, "DRONE0"))

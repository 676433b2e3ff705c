"""UDP messages by which clients announce how many agents there will be."""

import logging
import math
import socket
import time
from contextlib import suppress

from eyas.engine.core.errors import ConfigError, EyasError, OutputError

MOST_AGENTS = 1024  # Largest number of agents, as of the channels of a recording

_LONGEST = 256  # Largest message that is read whole, as by the original [bytes]

_LOG = logging.getLogger("eyas")


_early: dict[tuple[str, int], tuple[socket.socket, float]] = {}
"""The socket that listens already, and since when."""


def listen_early(address: str, port: int) -> None:
    """Listen before all else is imported, so that no announcement is lost meanwhile.

    `Announcements` of the same place take over; where it is not possible, they give the reason.
    """
    with suppress(EyasError):
        _early[address, port] = _listening(address, port), time.time()


class Announcements:
    """A UDP socket on which each client sends the number of all clients, in digits.

    Attributes:
        since: When it began to listen, if that was early [s, as `time.time`]; else infinity.

    Args:
        address: Address to listen on.
        port: Port to listen on.

    Raises:
        ConfigError: No such address on this machine.
        OutputError: The port is not free.
    """

    def __init__(self, address: str, port: int) -> None:
        early = _early.pop((address, port), None)
        for unused, _ in _early.values():
            unused.close()
        _early.clear()
        self._socket, self.since = early or (_listening(address, port), math.inf)
        self._place = address, port
        self._told = -1.0

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    def move(self, address: str, port: int) -> None:
        """Listen elsewhere from now on; where that is not possible, in a line, as before."""
        if (address, port) == self._place:
            return
        self._place = address, port  # tried once
        try:
            new = _listening(address, port)
        except EyasError as error:
            _LOG.warning("%s", error)
            return
        self._socket.close()
        self._socket = new
        _LOG.info("now waiting for clients on UDP port %d of %s", port, address)

    def wait(self, seconds: float) -> int | None:
        """Wait for an announcement; return the number of agents, None if none has come [s]."""
        self._socket.settimeout(seconds)
        try:
            return self._next()
        except (BlockingIOError, TimeoutError):
            return None

    def poll(self) -> int | None:
        """Return the number of agents in the last announcement; None if there is none."""
        self._socket.settimeout(0.0)
        last = None
        for _ in range(MOST_AGENTS):  # not for ever, should someone send without end
            try:
                last = self._next() or last
            except BlockingIOError:
                break
        return last

    def _next(self) -> int | None:
        """Return the number in the next message; None if it has none."""
        try:
            message, sender = self._socket.recvfrom(_LONGEST)
        except ConnectionError:  # some systems tell so that an earlier message was not heard
            return None
        text = message.strip()
        if text.isdigit() and len(text) <= 4 and 1 <= int(text) <= MOST_AGENTS:
            return int(text)
        self._tell(message, sender[0])
        return None

    def _tell(self, message: bytes, sender: str) -> None:
        """Report a message that is not a number of agents, one of many in a second."""
        now = time.monotonic()
        if self._told < 0.0 or now - self._told > 1.0:
            self._told = now
            _LOG.warning(
                "message %r from %s ignored: not a number of agents, 1 to %d",
                message[:40],
                sender,
                MOST_AGENTS,
            )


def _listening(address: str, port: int) -> socket.socket:
    """Return a socket that listens."""
    try:
        family, kind, _, _, place = socket.getaddrinfo(
            address, port, type=socket.SOCK_DGRAM, flags=socket.AI_PASSIVE
        )[0]
    except (OSError, UnicodeError) as error:
        raise ConfigError(f"wire.address: {address!r} is not a network address: {error}") from None
    made = socket.socket(family, kind)
    try:
        made.bind(place)
    except OSError as error:
        made.close()
        raise OutputError(
            f"wire.port: cannot listen on UDP port {port} of {address}: {error.strerror}; "
            "another server may use it: choose another, in the clients' port_process too"
        ) from None
    return made

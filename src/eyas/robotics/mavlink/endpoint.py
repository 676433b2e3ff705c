"""Where packets go and come from: addresses, and one UDP socket for each."""

import logging
import re
import socket
import time
from ipaddress import ip_address
from typing import Any

from eyas.engine.core.errors import ConfigError, OutputError
from eyas.robotics.mavlink.dialect import Parser

_LOG = logging.getLogger("eyas")

_FORMS = "udp:HOST:PORT (send to it, and hear answers) or udpin:HOST:PORT (listen on it)"
_LARGEST = 65_535
_MOST = 256  # Largest number of datagrams that are read at once
_FORGET = 10.0  # Time after which one who has said nothing is no longer sent anything [s]
_MOST_PEERS = 16

Address = tuple[str, int]


def parsed_address(text: str, path: str) -> Address:
    """Return host and port of `HOST:PORT`.

    Raises:
        ConfigError: It is of another form; `path` names it.
    """
    found = re.fullmatch(r"\[?([^\[\]]*?)\]?:(\d{1,5})", text)
    if found is None or not found[1] or not 1 <= int(found[2]) <= 65_535:
        raise ConfigError(f"{path}: {text!r} is not of the form HOST:PORT, such as 127.0.0.1:5600")
    return found[1], int(found[2])


class Endpoint:
    """One socket: sends packets to an address, and to all from whom messages have come.

    Args:
        text: `udp:HOST:PORT` or `udpin:HOST:PORT`.

    Raises:
        ConfigError: It is of another form, or there is no such host.
        OutputError: The port is not free.
    """

    def __init__(self, text: str) -> None:
        kind, _, rest = text.partition(":")
        if kind not in ("udp", "udpin"):
            raise ConfigError(f"--mavlink: {text!r} is not allowed; allowed: {_FORMS}")
        host, port = parsed_address(rest.removeprefix("//"), "--mavlink")
        family, place = _resolved(host, port, listens=kind == "udpin")
        self._text = text
        self.socket = socket.socket(family, socket.SOCK_DGRAM)
        self.socket.settimeout(0.0)
        self._always: tuple[Any, ...] = () if kind == "udpin" else (place,)
        self._heard: dict[Any, float] = {}
        if kind == "udpin":
            try:
                self.socket.bind(place)
            except OSError as error:
                self.socket.close()
                raise OutputError(f"--mavlink {text}: cannot listen: {error.strerror}") from None
        elif ip_address(place[0]).is_loopback:
            self.socket.bind((place[0], 0))  # else other machines are heard, too
        self._parser = Parser()

    def close(self) -> None:
        """Close the socket."""
        self.socket.close()

    def send(self, packets: bytes) -> None:
        """Send packets to all."""
        now = time.monotonic()
        for peer in (*self._always, *(p for p, at in self._heard.items() if at > now - _FORGET)):
            try:
                self.socket.sendto(packets, peer)
            except OSError:  # nobody is there, or its buffer is full: later ones may get through
                continue

    def received(self) -> list[Any]:
        """Return the messages that have come; those who sent some are answered from now on."""
        found: list[Any] = []
        for _ in range(_MOST):  # not for ever, should someone send without end
            try:
                datagram, peer = self.socket.recvfrom(_LARGEST)
            except BlockingIOError:
                break
            except OSError:  # some systems tell so that nobody hears what was sent
                continue
            messages = self._parser.messages(datagram)
            if messages:
                self._remember(peer)
                found += messages
        return found

    def _remember(self, peer: Any) -> None:  # noqa: ANN401  # an address of any family
        if peer in self._always:
            return
        now = time.monotonic()
        if peer not in self._heard:
            self._heard = {p: at for p, at in self._heard.items() if at > now - _FORGET}
            if len(self._heard) >= _MOST_PEERS:
                return
            _LOG.info("%s: heard from %s port %d", self._text, *peer[:2])
        self._heard[peer] = now


def _resolved(host: str, port: int, *, listens: bool) -> tuple[socket.AddressFamily, Any]:
    flags = socket.AI_PASSIVE if listens else 0
    try:
        family, _, _, _, place = socket.getaddrinfo(
            host, port, type=socket.SOCK_DGRAM, flags=flags
        )[0]
    except (OSError, UnicodeError) as error:
        raise ConfigError(f"--mavlink: {host!r} is not a network address: {error}") from None
    return family, place

"""Packets of MAVLink 2, by pymavlink, which is imported here only, and the sockets they pass."""

import logging
import re
import socket
import struct
import time
from importlib import import_module
from ipaddress import ip_address
from types import ModuleType
from typing import Any

import numpy as np

from eyas.engine.core.addresses import parsed_address
from eyas.engine.core.errors import ConfigError, MissingExtraError, OutputError


def dialect() -> ModuleType:
    """Return the messages and constants of the dialect `common`.

    Raises:
        MissingExtraError: pymavlink is not installed.
    """
    try:
        return import_module("pymavlink.dialects.v20.common")
    except ImportError as error:
        raise MissingExtraError("MAVLink", "mavlink") from error


class Packer:
    """Makes the packets of one component of one system, numbered one after the other."""

    def __init__(
        self,
        system: int,  # System id
        component: int,  # Component id
    ) -> None:
        self._dialect = dialect()
        self._maker = self._dialect.MAVLink(None, system, component)

    def pack(self, name: str, /, **fields: Any) -> bytes:  # noqa: ANN401  # numbers, texts and lists
        """Return the packet of a message, such as `heartbeat`, with these fields.

        Numbers that its types cannot hold are the nearest that they can.
        """
        make = getattr(self._dialect, f"MAVLink_{name}_message")
        try:
            packet: bytes = make(**fields).pack(self._maker)
        except (struct.error, OverflowError):
            kinds = dict(zip(make.fieldnames, make.fieldtypes, strict=True))
            held = {field: _nearest(value, kinds[field]) for field, value in fields.items()}
            packet = make(**held).pack(self._maker)
        self._maker.seq = (self._maker.seq + 1) % 256
        return packet


def _nearest(value: Any, kind: str) -> Any:  # noqa: ANN401  # of a field
    """Return the nearest value that a field of a type can hold; lists item by item."""
    if isinstance(value, list | tuple):
        return [_nearest(item, kind) for item in value]
    whole = re.match(r"(u?)int(\d+)_t", kind)
    if whole:
        span = 1 << int(whole[2])
        least = 0 if whole[1] else -span // 2
        return min(max(value, least), least + span - 1)
    most = np.finfo(np.float32).max.item()
    return min(max(value, -most), most) if kind == "float" else value


class Parser:
    """Finds messages in datagrams, each of which holds whole packets."""

    def __init__(self) -> None:
        self._dialect = dialect()

    def messages(self, datagram: bytes) -> list[Any]:
        """Return the messages of a datagram; what is no valid packet is left out.

        A new reader for each datagram: what one leaves unfinished must not take in the next.
        """
        reader = self._dialect.MAVLink(None)
        reader.robust_parsing = True
        found: list[Any] = reader.parse_buffer(datagram) or []
        return [message for message in found if message.get_type() != "BAD_DATA"]


class StreamParser:
    """Finds messages in a stream, whose pieces end anywhere."""

    def __init__(self) -> None:
        self._reader = dialect().MAVLink(None)
        self._reader.robust_parsing = True

    def messages(self, piece: bytes) -> list[Any]:
        """Return the messages that end in the next piece; what is no valid packet is left out."""
        found: list[Any] = self._reader.parse_buffer(piece) or []
        return [message for message in found if message.get_type() != "BAD_DATA"]


_LOG = logging.getLogger("eyas")

_FORMS = "udp:HOST:PORT (send to it, and hear answers) or udpin:HOST:PORT (listen on it)"
_LARGEST = 65_535
_MOST = 256  # Largest number of datagrams that are read at once
_FORGET = 10.0  # Time after which one who has said nothing is no longer sent anything [s]
_MOST_PEERS = 16


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

"""The messages of MAVLink 2, by pymavlink, which is imported here only."""

from importlib import import_module
from types import ModuleType
from typing import Any

from eyas.core.errors import MissingExtraError

__all__ = ["Packer", "Parser", "StreamParser", "dialect"]


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
    """Makes the packets of one component of one system, numbered one after the other.

    Args:
        system: System id.
        component: Component id.
    """

    def __init__(self, system: int, component: int) -> None:
        self._dialect = dialect()
        self._maker = self._dialect.MAVLink(None, system, component)

    def pack(self, name: str, /, **fields: Any) -> bytes:  # noqa: ANN401  # numbers, texts and lists
        """Return the packet of a message, such as `heartbeat`, with these fields."""
        message = getattr(self._dialect, f"MAVLink_{name}_message")(**fields)
        packet: bytes = message.pack(self._maker)
        self._maker.seq = (self._maker.seq + 1) % 256
        return packet


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

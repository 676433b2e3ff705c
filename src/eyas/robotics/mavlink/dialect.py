"""The messages of MAVLink 2, by pymavlink, which is imported here only."""

import re
import struct
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np

from eyas.engine.core.errors import MissingExtraError


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

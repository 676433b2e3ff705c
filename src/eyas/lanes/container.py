"""Files that hold pieces of bytes and a header, and that are whole or not read at all.

A file begins with the CRC-32 of all bytes after it and the length of the header; then come the
header, in JSON, and the pieces, each at a multiple of 64 bytes, so that arrays can be used where
they lie in a file that is mapped into memory.
"""

import json
import struct
import zlib
from collections.abc import Iterable
from typing import Any, NamedTuple

_ALIGNMENT = 64
_HEAD = struct.Struct("<II")
_SUM = struct.Struct("<I")

Bytes = bytes | memoryview


class Contents(NamedTuple):
    """What a file holds."""

    header: Any  # Anything that JSON can tell
    pieces: list[memoryview]


def packed(header: object, pieces: Iterable[Bytes]) -> list[Bytes]:
    """Return the content of a file, in parts to be written one after the other."""
    kept = [memoryview(piece).cast("B") for piece in pieces]
    text = json.dumps([header, [piece.nbytes for piece in kept]], separators=(",", ":")).encode()
    text += b" " * _padding(_HEAD.size + len(text))
    parts: list[Bytes] = [text]
    for piece in kept:
        parts += [piece, bytes(_padding(piece.nbytes))]
    checksum = zlib.crc32(len(text).to_bytes(4, "little"))
    for part in parts:
        checksum = zlib.crc32(part, checksum)
    return [_HEAD.pack(checksum, len(text)), *parts]


def unpacked(content: Bytes, *, checked: bool = True) -> Contents:
    """Return what a file holds; the pieces are views of its content.

    Unless it is `checked`, nobody looks whether its checksum is right.

    Raises:
        ValueError: It is damaged, cut off, or no such file.
    """
    whole = memoryview(content)
    if len(whole) < _HEAD.size:
        raise ValueError("cut off")
    checksum, length = _HEAD.unpack_from(whole)
    if checked and zlib.crc32(whole[_SUM.size :]) != checksum:
        raise ValueError("damaged")
    try:
        header, sizes = json.loads(bytes(whole[_HEAD.size : _HEAD.size + length]))
        pieces, at = [], _HEAD.size + length
        for size in sizes:
            pieces.append(whole[at : at + size])
            at += size + _padding(size)
    except (TypeError, ValueError) as error:
        raise ValueError(f"no file of pieces: {error}") from None
    if at != len(whole):
        raise ValueError(f"{len(whole)} bytes instead of {at}")
    return Contents(header, pieces)


def _padding(size: int) -> int:
    return -size % _ALIGNMENT

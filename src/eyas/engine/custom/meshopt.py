"""The bitstreams of `EXT_meshopt_compression` (version 0), in which gltfpack writes meshes.

After the extension's text (github.com/KhronosGroup/glTF, Vendor/EXT_meshopt_compression): vertices
are bytes, each coded by its difference to that of the vertex before, in groups of 16; triangles are
coded by the edges and corners of those before.
"""

from collections import deque
from typing import Any

import numpy as np
from numpy.typing import NDArray

_ATTRIBUTES, _TRIANGLES, _INDICES = 0xA0, 0xE1, 0xD1  # First bytes of the three bitstreams
_GROUP = 16  # Number of bytes that are coded together
_TAIL = 32  # Smallest length of what ends attributes [bytes]
_CHANGED = 16  # Code of a corner that is coded by a difference
_BLOCK, _MOST = 8192, 256  # Largest block of attributes [bytes], and its largest number of vertices


def decoded(data: bytes, packed: dict[str, Any]) -> bytes:
    """Return the bytes of a buffer view.

    Args:
        data: The bitstream.
        packed: The extension: `mode`, `count`, `byteStride` and perhaps `filter`.

    Raises:
        ValueError: The bitstream is damaged, or of a kind that is not read.
    """
    mode, count, stride = packed["mode"], int(packed["count"]), int(packed["byteStride"])
    begins = {"ATTRIBUTES": _ATTRIBUTES, "TRIANGLES": _TRIANGLES, "INDICES": _INDICES}.get(mode)
    if begins is None or data[:1] != bytes([begins]) or count < 0:
        raise ValueError(f"its meshopt data are no {mode!r:.20} of version 0")
    if mode == "ATTRIBUTES":
        if not 4 <= stride <= 256 or stride % 4:
            raise ValueError(f"meshopt: a vertex of {stride} bytes")
        values = _attributes(data, count, stride)
        if packed.get("filter") == "EXPONENTIAL":
            return _exponential(values)
        return values.tobytes()  # other filters are of normals and turns, which are not used
    if stride not in (2, 4) or count > 3 * len(data) * 8:
        raise ValueError(f"meshopt: indices of {stride} bytes")
    numbers = _triangles(data, count) if mode == "TRIANGLES" else _indices(data, count)
    return np.array(numbers, np.int64).astype("<u2" if stride == 2 else "<u4").tobytes()


def _attributes(data: bytes, count: int, stride: int) -> NDArray[np.uint8]:
    """Return the bytes of vertices, shape (count, stride)."""
    last = np.frombuffer(data[len(data) - stride :], np.uint8)
    block = min(_BLOCK // stride // _GROUP * _GROUP, _MOST)
    if len(data) < 1 + max(stride, _TAIL) or count > 4 * _GROUP * len(data):
        raise ValueError("meshopt: cut off")
    made, at = [], 1
    for first in range(0, count, block):
        size = min(block, count - first)
        groups = -(-size // _GROUP)
        changes = np.zeros((stride, groups * _GROUP), np.uint8)
        for row in changes:
            head, at = data[at : at + -(-groups // 4)], at + -(-groups // 4)
            for group in range(groups):
                bits = head[group // 4] >> (group % 4 * 2) & 3
                if bits:
                    part = row[group * _GROUP : (group + 1) * _GROUP]
                    at = _group(data, at, 1 << bits, part)
        zigzag = changes[:, :size].T
        steps = (zigzag >> 1) ^ np.negative(zigzag & 1)  # of both signs
        values = np.cumsum(np.concatenate([last[None], steps]), axis=0, dtype=np.uint8)[1:]
        made.append(values)
        last = values[-1]
    return np.concatenate(made) if made else np.zeros((0, stride), np.uint8)


def _group(data: bytes, at: int, bits: int, out: NDArray[np.uint8]) -> int:
    """Read 16 bytes of 2, 4 or 8 bits, the largest of which stands for a byte behind them all."""
    end = at + 2 * bits
    codes = np.frombuffer(data[at:end], np.uint8)
    if len(codes) < 2 * bits:
        raise ValueError("meshopt: cut off")
    if bits == 8:
        out[:] = codes
        return end
    shifts = np.arange(8 - bits, -1, -bits)
    out[:] = (codes[:, None] >> shifts & ((1 << bits) - 1)).ravel()
    (long,) = np.nonzero(out == (1 << bits) - 1)
    rest = np.frombuffer(data[end : end + len(long)], np.uint8)
    if len(rest) < len(long):
        raise ValueError("meshopt: cut off")
    out[long] = rest
    return end + len(long)


def _exponential(packed: NDArray[np.uint8]) -> bytes:
    """Return floats of whole numbers of 24 bits and exponents of 8 bits."""
    whole = np.ascontiguousarray(packed).view("<i4")
    mantissa = (whole << 8) >> 8
    values = np.ldexp(mantissa.astype(np.float64), whole >> 24).astype("<f4")
    return bytes(values.tobytes())


class _Numbers:
    """Whole numbers of 7 bits a byte, the lowest first, and differences."""

    def __init__(self, data: bytes, at: int) -> None:
        self.data, self.at = data, at

    def byte(self) -> int:
        """Return the next byte."""
        self.at += 1
        return self.data[self.at - 1]

    def whole(self) -> int:
        """Return the next number."""
        value = 0
        for shift in range(0, 35, 7):
            byte = self.byte()
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                return value
        raise ValueError("meshopt: damaged")

    def change(self) -> int:
        """Return the next difference."""
        return _signed(self.whole())


def _signed(value: int) -> int:
    return (value >> 1) ^ -(value & 1)


def _indices(data: bytes, count: int) -> list[int]:
    rest, last, made = _Numbers(data, 1), [0, 0], []
    for _ in range(count):
        value = rest.whole()
        last[value & 1] += _signed(value >> 1)
        made.append(last[value & 1] & 0xFFFFFFFF)
    return made


def _triangles(data: bytes, count: int) -> list[int]:
    if count % 3 or len(data) < 17 + count // 3:
        raise ValueError("meshopt: cut off")
    table = data[-16:]
    rest = _Numbers(data, 1 + count // 3)
    edges: deque[tuple[int, int]] = deque([(0, 0)] * 16, 16)  # The latest is the first
    corners = deque([0] * 16, 16)
    following, last = 0, 0
    made, recent = list[int](), list[int]()

    def corner(code: int) -> int:
        """Return a corner that is new, coded by a difference, or one of the latest."""
        nonlocal following, last
        if code == 0:
            following += 1
            return following - 1
        if code == _CHANGED:
            last += rest.change()
            return last
        return recent[code - 1]

    for code in data[1 : 1 + count // 3]:
        edge, other = code >> 4, code & 15
        recent = list(corners)
        if edge < 15:
            a, b = edges[edge]
            if other in (13, 14):
                last += 1 if other == 14 else -1
                c = last
            else:
                c = recent[other] if 0 < other < 13 else corner(other and _CHANGED)
            if other == 0 or other > 12:
                corners.appendleft(c)
            edges.extendleft([(c, b), (a, c)])
        else:
            both = table[other] if other < 14 else rest.byte()
            if other >= 14 and both == 0:
                following = 0
            a = corner(0 if other < 15 else _CHANGED)
            # In the table 15 is one of the latest, behind the triangles a difference.
            how = [_CHANGED if k == 15 and other >= 14 else k for k in (both >> 4, both & 15)]
            b, c = corner(how[0]), corner(how[1])
            corners.appendleft(a)
            corners.extendleft(
                one for one, k in zip((b, c), how, strict=True) if k in (0, _CHANGED)
            )
            edges.extendleft([(b, a), (c, b), (a, c)])
        made += (a, b, c)
    return [one & 0xFFFFFFFF for one in made]

"""Checks and repairs of glTF and GLB files before trimesh reads them.

trimesh reads numbers as they are stored: it does not divide normalised integers, leaves sparse
accessors at zero, and warns where an extension holds the geometry.
"""

import base64
import json
import re
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.decoding import decoded_json
from eyas.engine.core.files import read_limited

_READ = re.compile(
    "KHR_mesh_quantization|KHR_lights_punctual|KHR_materials_.*|KHR_xmp.*|EXT_texture_webp"
)
"""Extensions that are read, or whose absence changes neither shape nor colour."""

_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_FLOAT = 5126  # Component type of glTF for float32
_GLB = struct.Struct("<4sIIII")
_CHUNK = struct.Struct("<II")
_JSON = 0x4E4F534A  # Kind of a chunk: "JSON"
_MODES = (4, 5)  # Modes of primitives that are read: triangles, and strips of them


def mended_gltf(
    path: Path,  # The file, `.gltf` or `.glb`
    largest: int,  # Largest size of it, of a file beside it, and of all numbers [bytes]
) -> tuple[bytes, str]:
    """Return the content of a file whose accessors are plain, and a line about what is left out.

    Raises:
        ValueError: It is damaged, or needs an extension that is not read; the line names it.
        DataFileError: It, or a file of numbers beside it, cannot be read.
    """
    content = read_limited(path, largest)
    binary = content[:4] == b"glTF"
    text, rest = _split(content) if binary else (content, b"")
    header = decoded_json(text)
    if not isinstance(header, dict):
        raise ValueError("its JSON is not an object")
    try:
        left_out = _left_out(header)
        changed = _Mender(path, header, rest[8:], largest).mend()
    except (TypeError, KeyError, IndexError, AttributeError) as error:
        raise ValueError(f"its JSON is not that of glTF: {error!r}") from None
    return (_joined(header, rest) if binary else _text(header)) if changed else content, left_out


def beside(path: Path, name: str) -> Path:
    """Return the file that another one names, never one outside of its folder."""
    folder = path.parent.resolve()
    named = (folder / name).resolve()
    return named if named.is_relative_to(folder) else folder / Path(name).name


def _split(content: bytes) -> tuple[bytes, bytes]:
    """Return the JSON of a GLB, and the chunks after it."""
    try:
        _, version, _, length, kind = _GLB.unpack_from(content)
    except struct.error:
        raise ValueError("cut off") from None
    if version != 2 or kind != _JSON:
        raise ValueError(f"GLB version {version}; allowed: 2")
    end = _GLB.size + length
    return content[_GLB.size : end], content[end:]


def _text(header: dict[str, Any]) -> bytes:
    return json.dumps(header).encode()


def _joined(header: dict[str, Any], rest: bytes) -> bytes:
    text = _text(header)
    text += b" " * (-len(text) % 4)
    return _GLB.pack(b"glTF", 2, _GLB.size + len(text) + len(rest), len(text), _JSON) + text + rest


def _left_out(header: dict[str, Any]) -> str:
    """Return what is not read, in words; `ValueError` if the shape cannot do without it."""
    primitives = [one for mesh in header.get("meshes", ()) for one in mesh["primitives"]]
    needed = {*header.get("extensionsRequired", ())}
    for part in (*primitives, *header.get("bufferViews", ())):
        if "attributes" not in part or _lacks_data(header, part):
            needed |= {*part.get("extensions", ())}
    unread = sorted(name for name in needed if not _READ.fullmatch(name))
    if unread:
        raise ValueError(f"it needs {', '.join(unread):.200}, which is not read; save it without")
    used = [name for name in header.get("extensionsUsed", ()) if not _READ.fullmatch(name)]
    others = sum(one.get("mode", 4) not in _MODES for one in primitives)
    unread_parts = sorted(used) + [f"{others} primitives of points, lines or fans"] * bool(others)
    return f"left out, as not read: {', '.join(unread_parts):.300}" if unread_parts else ""


def _lacks_data(header: dict[str, Any], primitive: dict[str, Any]) -> bool:
    numbers = [*primitive["attributes"].values()]
    return any("bufferView" not in header["accessors"][number] for number in numbers)


class _Mender:
    """Makes plain accessors of those that trimesh would misread."""

    def __init__(self, path: Path, header: dict[str, Any], binary: bytes, largest: int) -> None:
        self._path, self._header, self._largest = path, header, largest
        self._binary, self._files = binary, dict[int, bytes]()

    def mend(self) -> bool:
        """Mend all; return whether anything was changed."""
        accessors, size = self._header.get("accessors", ()), 0
        for accessor in accessors:
            if not isinstance(accessor["count"], int) or accessor["count"] < 0:
                raise ValueError(f"an accessor of {accessor['count']!r:.30} elements")
            size += accessor["count"] * _width(accessor)
        if size > self._largest:
            raise ValueError(f"its accessors have {size:.3g} bytes; allowed: {self._largest}")
        coordinates = {
            number
            for mesh in self._header.get("meshes", ())
            for one in mesh["primitives"]
            for name, number in one["attributes"].items()
            if name == "POSITION" or name.startswith("TEXCOORD")
        }
        changed = False
        for number, accessor in enumerate(accessors):
            divided = accessor.get("normalized") is True and number in coordinates
            if "sparse" in accessor or (divided and accessor["componentType"] != _FLOAT):
                self._replace(accessor, self._values(accessor), divided=divided)
                changed = True
        return changed

    def _replace(self, accessor: dict[str, Any], values: NDArray[Any], *, divided: bool) -> None:
        if divided and values.dtype.kind in "iu":
            values = np.maximum(values / np.float64(np.iinfo(values.dtype).max), -1.0)
            values, accessor["componentType"] = values.astype("<f4"), _FLOAT
            for key in ("normalized", "min", "max"):
                accessor.pop(key, None)
        accessor.pop("sparse", None)
        data = values.tobytes()
        address = f"data:application/octet-stream;base64,{base64.b64encode(data).decode()}"
        buffers, views = (self._header.setdefault(key, []) for key in ("buffers", "bufferViews"))
        buffers.append({"byteLength": len(data), "uri": address})
        views.append({"buffer": len(buffers) - 1, "byteLength": len(data)})
        accessor.update(bufferView=len(views) - 1, byteOffset=0)

    def _values(self, accessor: dict[str, Any]) -> NDArray[Any]:
        """Return the numbers of an accessor as they are stored, shape (N, width)."""
        width, count = _WIDTHS[accessor["type"]], accessor["count"]
        values = self._stored(accessor, accessor["componentType"], count, width)
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            few, where = sparse["count"], sparse["indices"]
            rows = self._stored(where, where["componentType"], few, 1).astype(np.int64).ravel()
            new = self._stored(sparse["values"], accessor["componentType"], few, width)
            if len(rows) and rows.max() >= count:
                raise ValueError("a sparse accessor has a row that is not there")
            values = values.copy()
            values[rows] = new
        return values

    def _stored(self, where: dict[str, Any], kind: int, count: int, width: int) -> NDArray[Any]:
        dtype = np.dtype(_TYPES[kind])
        if "bufferView" not in where:
            return np.zeros((count, width), dtype)
        view = self._header["bufferViews"][where["bufferView"]]
        data = self._buffer(view["buffer"])[view.get("byteOffset", 0) :][: view["byteLength"]]
        row = dtype.itemsize * width
        stride, first = view.get("byteStride", row), where.get("byteOffset", 0)
        if not 0 <= first <= len(data) or stride < row or not 0 <= count <= len(data):
            raise ValueError("an accessor outside of its buffer")
        if count and first + (count - 1) * stride + row > len(data):
            raise ValueError("an accessor outside of its buffer")
        flat = np.frombuffer(data, np.uint8)
        at = first + stride * np.arange(count)[:, None] + np.arange(row)
        values: NDArray[Any] = flat[at].view(dtype).reshape(count, width)
        return values

    def _buffer(self, number: int) -> bytes:
        if number not in self._files:
            uri = self._header["buffers"][number].get("uri")
            if uri is None:
                self._files[number] = self._binary
            elif uri.startswith("data:"):
                self._files[number] = base64.b64decode(uri.partition(",")[2])
            else:
                self._files[number] = read_limited(beside(self._path, uri), self._largest)
        return self._files[number]


def _width(accessor: dict[str, Any]) -> int:
    """Return the bytes of an element."""
    return _WIDTHS[accessor["type"]] * np.dtype(_TYPES[accessor["componentType"]]).itemsize

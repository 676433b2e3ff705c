"""Checks and repairs of glTF and GLB files before trimesh reads them.

trimesh reads numbers as they are stored: it does not divide normalised integers, leaves sparse
accessors at zero, knows no transforms of textures, and warns where an extension holds the geometry.
Draco is decoded by DracoPy, `EXT_meshopt_compression` by `eyas.engine.custom.meshopt`.
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
from eyas.engine.core.errors import MissingExtraError
from eyas.engine.core.files import read_limited
from eyas.engine.custom import meshopt
from eyas.lanes import exact

_READ = re.compile(
    "KHR_mesh_quantization|KHR_lights_punctual|KHR_materials_.*|KHR_xmp.*|EXT_texture_webp"
    "|KHR_texture_transform|KHR_draco_mesh_compression|EXT_meshopt_compression"
)
"""Extensions that are read, or whose absence changes neither shape nor colour."""

_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_FLOAT = 5126  # Component type of glTF for float32
_KINDS = {name.strip("<"): kind for kind, name in _TYPES.items()}
_DRACO, _MESHOPT = "KHR_draco_mesh_compression", "EXT_meshopt_compression"
_DRACO_HEADER = 11  # [bytes]
_MOST_OF_DRACO = 4_000_000  # Largest number of triangles, or vertices
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
        primitives = [one for mesh in self._header.get("meshes", ()) for one in mesh["primitives"]]
        coordinates = {
            number
            for one in primitives
            for name, number in one["attributes"].items()
            if name == "POSITION" or name.startswith("TEXCOORD")
        }
        for key in ("extensionsUsed", "extensionsRequired"):
            if key in self._header:
                self._header[key] = [
                    name for name in self._header[key] if name not in (_DRACO, _MESHOPT)
                ]
        changed = self._unpack_views()
        changed |= any([*map(self._unpack, primitives), *map(self._transform, primitives)])
        for number, accessor in enumerate(accessors):
            divided = accessor.get("normalized") is True and number in coordinates
            if "sparse" in accessor or (divided and accessor["componentType"] != _FLOAT):
                self._replace(accessor, self._values(accessor), divided=divided)
                changed = True
        for node in self._header.get("nodes", ()):  # trimesh loses what hangs on a camera
            changed |= node.pop("camera", None) is not None
        return changed

    def _replace(self, accessor: dict[str, Any], values: NDArray[Any], *, divided: bool) -> None:
        if divided and values.dtype.kind in "iu":
            values, accessor["componentType"] = _divided(values).astype("<f4"), _FLOAT
            for key in ("normalized", "min", "max"):
                accessor.pop(key, None)
        self._store(accessor, values)

    def _unpack_views(self) -> bool:
        """Replace the views that meshopt has packed; return whether there are any."""
        views, size, changed = self._header.get("bufferViews", ()), 0, False
        for view in views:
            packed = view.get("extensions", {}).pop(_MESHOPT, None)
            if packed is None:
                continue
            size += packed["count"] * packed["byteStride"]
            if size > self._largest:
                raise ValueError(f"its meshopt data have {size:.3g} bytes")
            first = packed.get("byteOffset", 0)
            data = self._buffer(packed["buffer"])[first : first + packed["byteLength"]]
            view.update(self._new_buffer(meshopt.decoded(data, packed)), byteOffset=0)
            changed = True
        for number, buffer in enumerate(self._header.get("buffers", ())):
            if number and changed and "uri" not in buffer:  # what was in place of the packed
                buffer.update(uri="data:;base64,", byteLength=0)
        return changed

    def _new_buffer(self, data: bytes) -> dict[str, int]:
        """Return a view of a new buffer."""
        address = f"data:application/octet-stream;base64,{base64.b64encode(data).decode()}"
        buffers = self._header.setdefault("buffers", [])
        buffers.append({"byteLength": len(data), "uri": address})
        return {"buffer": len(buffers) - 1, "byteLength": len(data)}

    def _unpack(self, primitive: dict[str, Any]) -> bool:
        """Replace what Draco has packed; return whether there is any."""
        packed = primitive.get("extensions", {}).pop(_DRACO, None)
        if packed is None:
            return False
        accessors = self._header["accessors"]
        faces, attributes = _draco(self._view(packed["bufferView"]))
        corners = accessors[primitive["indices"]]
        corners["componentType"] = 5125
        self._store(corners, faces.astype("<u4").reshape(-1, 1))
        for name, unique in packed["attributes"].items():
            accessor, values = accessors[primitive["attributes"][name]], attributes[unique]
            if values.shape[1] != _WIDTHS[accessor["type"]]:
                raise ValueError(f"Draco's {name:.30} has another width than its accessor")
            accessor["componentType"] = _KINDS[values.dtype.str[1:]]
            self._store(accessor, values)
        return True

    def _transform(self, primitive: dict[str, Any]) -> bool:
        """Apply the transform of a texture (KHR_texture_transform) to a primitive's coordinates."""
        material = (
            self._header["materials"][primitive["material"]] if "material" in primitive else {}
        )
        texture = material.get("pbrMetallicRoughness", {}).get("baseColorTexture", {})
        moved = texture.get("extensions", {}).get("KHR_texture_transform")
        if moved is None:
            return False
        name = f"TEXCOORD_{moved.get('texCoord', texture.get('texCoord', 0))}"
        if name not in primitive["attributes"]:
            return False
        old = self._header["accessors"][primitive["attributes"][name]]
        uv = _divided(self._values(old)) if old.get("normalized") else self._values(old)
        uv = uv.astype(np.float64) * np.array(moved.get("scale", (1.0, 1.0)), np.float64)
        angle = float(moved.get("rotation", 0.0))
        cosine, sine = exact.cos(angle), exact.sin(angle)  # counter-clockwise, where v is down
        turned = exact.product(uv, np.array([[cosine, -sine], [sine, cosine]]))
        turned = turned + np.array(moved.get("offset", (0.0, 0.0)), np.float64)
        accessor = {"componentType": _FLOAT, "type": "VEC2"}
        self._store(accessor, turned.astype("<f4"))
        self._header["accessors"].append(accessor)
        primitive["attributes"]["TEXCOORD_0"] = len(self._header["accessors"]) - 1
        return True

    def _store(self, accessor: dict[str, Any], values: NDArray[Any]) -> None:
        accessor.pop("sparse", None)
        accessor["count"] = len(values)
        views = self._header.setdefault("bufferViews", [])
        views.append(self._new_buffer(values.tobytes()))
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
        data = self._view(where["bufferView"])
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

    def _view(self, number: int) -> bytes:
        view = self._header["bufferViews"][number]
        return self._buffer(view["buffer"])[view.get("byteOffset", 0) :][: view["byteLength"]]

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


def _divided(values: NDArray[Any]) -> NDArray[np.float64]:
    """Return normalised integers as numbers from -1 to 1."""
    return np.maximum(values / np.float64(np.iinfo(values.dtype).max), -1.0)


def _draco(data: bytes) -> tuple[NDArray[Any], dict[int, NDArray[Any]]]:
    """Return the triangles, and the attributes by their numbers, of a mesh that Draco has packed.

    Its header says how large it is before anything of that size is made (Draco's bitstream 2.2).
    """
    if len(data) < _DRACO_HEADER + 10 or data[:5] != b"DRACO":
        raise ValueError("Draco's data are not those of a mesh")
    version, kind, method, flags = (data[5], data[6]), data[7], data[8], data[10]
    if version != (2, 2) or kind != 1 or method > 1 or flags & 0x80:
        raise ValueError("Draco's data are of a version, or hold metadata, which is not read")
    first, at = _varint(data, _DRACO_HEADER + method)
    second, _ = _varint(data, at)
    if max(first, second) > _MOST_OF_DRACO:
        raise ValueError(f"Draco's mesh has more than {_MOST_OF_DRACO} triangles or vertices")
    try:
        import DracoPy
    except ImportError:
        raise MissingExtraError("a file compressed by Draco", "mesh") from None
    mesh = DracoPy.decode(data)
    return mesh.faces, {one["unique_id"]: np.asarray(one["data"]) for one in mesh.attributes}


def _varint(data: bytes, at: int) -> tuple[int, int]:
    """Return a number of 7 bits a byte, the lowest first, and where it ends."""
    value = 0
    for k in range(5):
        value |= (data[at + k] & 0x7F) << (7 * k)
        if data[at + k] < 0x80:
            return value, at + k + 1
    raise ValueError("Draco's data are damaged")

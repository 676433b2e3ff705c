"""A binary glTF file under construction: its meshes with their materials, its nodes and lights."""

import io
import json
import math
import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.lanes import exact

_FLOAT, _UINT = 5126, 5125
_ARRAYS, _INDICES = 34962, 34963
_MAGIC, _JSON, _BIN = 0x46546C67, 0x4E4F534A, 0x004E4942

UPRIGHT = [-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]
"""glTF's y points up, ours is z: a quarter turn about x."""

LIGHTS = "KHR_lights_punctual"

PLAIN = "plain"  # Name of the texture of what has none

_ROUGH = {Surface.WATER: 0.1, Surface.GLASS: 0.1, Surface.PAINT: 0.35}
"""Roughness of what shines; everything else is matt."""

Node = dict[str, Any]


def light_factors(material: Material) -> list[float]:
    """Return the tint of a material, a factor on sRGB colours, as factors on light."""
    return [min(round(float(exact.power(each, 2.2)), 5), 1.0) for each in material.tint]


@dataclass(slots=True)
class GltfFile:
    """The parts of a glTF file. Node 0 is the root, in whose frame z points up."""

    name: str  # Name of the scene and of its root
    textures: dict[str, NDArray[np.uint8]]  # Rows from the top; sRGB and alpha
    notice: str = ""  # Notice of whose data the map is made of
    extras: dict[str, Any] = field(default_factory=dict)  # What else is told about the file
    lights: list[dict[str, Any]] = field(default_factory=list)
    meshes: list[dict[str, Any]] = field(default_factory=list)
    nodes: list[Node] = field(default_factory=list)
    _cameras: list[dict[str, Any]] = field(default_factory=list)
    _channels: list[dict[str, Any]] = field(default_factory=list)
    _samplers: list[dict[str, Any]] = field(default_factory=list)
    _parts: list[bytes] = field(default_factory=list)
    _length: int = 0
    _views: list[dict[str, int]] = field(default_factory=list)
    _accessors: list[dict[str, Any]] = field(default_factory=list)
    _images: list[dict[str, Any]] = field(default_factory=list)
    _materials: list[dict[str, Any]] = field(default_factory=list)
    _of_material: dict[Material, int] = field(default_factory=dict)
    _of_image: dict[tuple[str, bool], int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.nodes.append({"name": self.name, "rotation": UPRIGHT, "children": []})

    def node(self, node: Node, parent: int = 0) -> int:
        """Add a node below another one; return its index."""
        self.nodes.append(node)
        self.nodes[parent].setdefault("children", []).append(len(self.nodes) - 1)
        return len(self.nodes) - 1

    def mesh(self, mesh: Mesh, name: str) -> int:
        """Add a mesh, one primitive for each material; return its index."""
        # Row 0 of our textures is v = 1, row 0 of glTF's is v = 0.
        uvs = np.ascontiguousarray(mesh.uvs * [1.0, -1.0], np.float32)
        primitives = []
        for index in np.unique(mesh.materials).tolist():
            triangles = mesh.triangles[mesh.materials == index]
            used, corners = np.unique(triangles, return_inverse=True)
            attributes = {
                "POSITION": self._array(mesh.positions[used], "VEC3"),
                "NORMAL": self._array(mesh.normals[used], "VEC3"),
            }
            if mesh.palette[index].texture != PLAIN:
                attributes["TEXCOORD_0"] = self._array(uvs[used], "VEC2")
            primitives.append(
                {
                    "attributes": attributes,
                    "indices": self._array(corners.ravel().astype(np.uint32), "SCALAR"),
                    "material": self._material(mesh.palette[index]),
                }
            )
        self.meshes.append({"name": name, "primitives": primitives})
        return len(self.meshes) - 1

    def camera(self, perspective: dict[str, float]) -> int:
        """Add a camera; return its index."""
        self._cameras.append({"type": "perspective", "perspective": perspective})
        return len(self._cameras) - 1

    def keys(self, values: NDArray[np.float64], kind: str) -> int:
        """Add values of an animation, shape (K, numbers of the kind); return their index."""
        flat = np.ascontiguousarray(values, np.float32)
        ends = {"min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist()}
        accessor = {"bufferView": self._view(flat.tobytes()), "componentType": _FLOAT}
        self._accessors.append({**accessor, "count": len(flat), "type": kind, **ends})
        return len(self._accessors) - 1

    def animate(
        self, node: int, path: str, times: int, values: int, between: str = "LINEAR"
    ) -> None:
        """Let a property of a node take values at times.

        Args:
            path: The property: translation, rotation or scale.
            between: How values between these are found: LINEAR or STEP.
        """
        self._samplers.append({"input": times, "output": values, "interpolation": between})
        target = {"node": node, "path": path}
        self._channels.append({"sampler": len(self._samplers) - 1, "target": target})

    def _view(self, data: bytes, target: int | None = None) -> int:
        """Add bytes; return the index of their view."""
        padded = data + bytes(-len(data) % 4)
        view = {"buffer": 0, "byteOffset": self._length, "byteLength": len(data)}
        self._views.append(view if target is None else {**view, "target": target})
        self._parts.append(padded)
        self._length += len(padded)
        return len(self._views) - 1

    def _array(self, values: NDArray[np.generic], kind: str) -> int:
        """Add an array of vertices or indices; return the index of its accessor."""
        whole = values.dtype.kind == "u"
        accessor: dict[str, Any] = {
            "bufferView": self._view(values.tobytes(), _INDICES if whole else _ARRAYS),
            "componentType": _UINT if whole else _FLOAT,
            "count": len(values),
            "type": kind,
        }
        if kind == "VEC3":
            flat = np.asarray(values, np.float32)
            accessor |= {"min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist()}
        self._accessors.append(accessor)
        return len(self._accessors) - 1

    def _image(self, name: str, *, holes: bool) -> int:
        """Return the index of a texture, added when it is first used."""
        key = name, holes
        if key not in self._of_image:
            pixels = self.textures[name]
            kept = pixels if holes else pixels[..., :3]
            png = io.BytesIO()
            Image.fromarray(np.ascontiguousarray(kept)).save(png, format="PNG")
            view = self._view(png.getvalue())
            self._images.append({"bufferView": view, "mimeType": "image/png", "name": name})
            self._of_image[key] = len(self._images) - 1
        return self._of_image[key]

    def _material(self, material: Material) -> int:
        """Return the index of a material, added when it is first used."""
        if material not in self._of_material:
            holes = material.surface is Surface.FOLIAGE
            factor = light_factors(material)
            look: dict[str, Any] = {
                "baseColorFactor": [*factor, 1.0],
                "metallicFactor": 0.0,
                "roughnessFactor": _ROUGH.get(material.surface, 1.0),
            }
            if material.texture != PLAIN:
                look["baseColorTexture"] = {"index": self._image(material.texture, holes=holes)}
            made: dict[str, Any] = {"name": material.texture, "pbrMetallicRoughness": look}
            if holes:
                made |= {"alphaMode": "MASK", "alphaCutoff": 0.5, "doubleSided": True}
            if material.surface is Surface.SIGNAL:
                made["emissiveFactor"] = factor
            self._materials.append(made)
            self._of_material[material] = len(self._materials) - 1
        return self._of_material[material]

    def encoded(self) -> bytes:
        """Return the file."""
        told = {key: value for key, value in self._told().items() if value not in ([], {})}
        text = json.dumps(told).encode()
        text += b" " * (-len(text) % 4)
        body = b"".join(self._parts)
        whole = 12 + 8 + len(text) + 8 + len(body)
        return b"".join(
            [
                struct.pack("<III", _MAGIC, 2, whole),
                struct.pack("<II", len(text), _JSON),
                text,
                struct.pack("<II", len(body), _BIN),
                body,
            ]
        )

    def _told(self) -> dict[str, Any]:
        asset: dict[str, Any] = {"version": "2.0", "generator": "Eyas"}
        if self.extras:
            asset["extras"] = self.extras
        if self.notice:
            asset["copyright"] = self.notice.splitlines()[0]
        textures = [{"source": k, "sampler": 0} for k in range(len(self._images))]
        sampler = {"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497}
        told: dict[str, Any] = {
            "asset": asset,
            "extensionsUsed": [LIGHTS] if self.lights else [],
            "extensions": {LIGHTS: {"lights": self.lights}} if self.lights else {},
            "scene": 0,
            "scenes": [{"nodes": [0], "name": self.name}],
            "nodes": self.nodes,
            "cameras": self._cameras,
            "animations": self._animations(),
            "meshes": self.meshes,
            "materials": self._materials,
            "textures": textures,
            "images": self._images,
            "samplers": [sampler] if textures else [],
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": self._length}] if self._length else [],
        }
        return told

    def _animations(self) -> list[dict[str, Any]]:
        told = {"name": "flight", "channels": self._channels, "samplers": self._samplers}
        return [told] if self._channels else []

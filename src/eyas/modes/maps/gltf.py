"""A map as one file that any viewer opens: binary glTF 2.0 with its textures."""

import io
import json
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from eyas.core.files import write_atomic
from eyas.sim.scenes import load_scene, load_textures
from eyas.state.mesh import Material, Mesh, Surface
from eyas.state.scene import Scene
from eyas.world.maps import MAPS

__all__ = ["run"]

_FLOAT, _UINT = 5126, 5125
_ARRAYS, _INDICES = 34962, 34963
_MAGIC, _JSON, _BIN = 0x46546C67, 0x4E4F534A, 0x004E4942

# glTF's y points up, ours is z: a quarter turn about x.
_UPRIGHT = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]

_ROUGH = {Surface.WATER: 0.1, Surface.GLASS: 0.1, Surface.PAINT: 0.35}
"""Roughness of what shines; everything else is matt."""


@dataclass(slots=True)
class _File:
    """The parts of a glTF file under construction."""

    textures: dict[str, NDArray[np.uint8]]
    """Rows from the top; sRGB and alpha."""
    parts: list[bytes] = field(default_factory=list)
    length: int = 0
    views: list[dict[str, int]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)
    images: list[dict[str, Any]] = field(default_factory=list)
    materials: list[dict[str, Any]] = field(default_factory=list)
    of_material: dict[Material, int] = field(default_factory=dict)
    of_image: dict[tuple[str, bool], int] = field(default_factory=dict)
    meshes: list[dict[str, Any]] = field(default_factory=list)

    def view(self, data: bytes, target: int | None = None) -> int:
        """Add bytes; return the index of their view."""
        padded = data + bytes(-len(data) % 4)
        view = {"buffer": 0, "byteOffset": self.length, "byteLength": len(data)}
        self.views.append(view if target is None else {**view, "target": target})
        self.parts.append(padded)
        self.length += len(padded)
        return len(self.views) - 1

    def array(self, values: NDArray[np.generic], kind: str) -> int:
        """Add an array of vertices or indices; return the index of its accessor."""
        whole = values.dtype.kind == "u"
        accessor: dict[str, Any] = {
            "bufferView": self.view(values.tobytes(), _INDICES if whole else _ARRAYS),
            "componentType": _UINT if whole else _FLOAT,
            "count": len(values),
            "type": kind,
        }
        if kind == "VEC3":
            flat = np.asarray(values, np.float32)
            accessor |= {"min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def image(self, name: str, *, holes: bool) -> int:
        """Return the index of a texture, added when it is first used."""
        key = name, holes
        if key not in self.of_image:
            pixels = self.textures[name]
            kept = pixels if holes else pixels[..., :3]
            png = io.BytesIO()
            Image.fromarray(np.ascontiguousarray(kept)).save(png, format="PNG")
            view = self.view(png.getvalue())
            self.images.append({"bufferView": view, "mimeType": "image/png", "name": name})
            self.of_image[key] = len(self.images) - 1
        return self.of_image[key]

    def material(self, material: Material) -> int:
        """Return the index of a material, added when it is first used."""
        if material not in self.of_material:
            holes = material.surface is Surface.FOLIAGE
            # Tints are factors on sRGB colours, those of glTF on light.
            factor = [min(round(channel**2.2, 5), 1.0) for channel in material.tint]
            look: dict[str, Any] = {
                "baseColorFactor": [*factor, 1.0],
                "metallicFactor": 0.0,
                "roughnessFactor": _ROUGH.get(material.surface, 1.0),
            }
            if material.texture != "plain":
                look["baseColorTexture"] = {"index": self.image(material.texture, holes=holes)}
            made: dict[str, Any] = {"name": material.texture, "pbrMetallicRoughness": look}
            if holes:
                made |= {"alphaMode": "MASK", "alphaCutoff": 0.5, "doubleSided": True}
            if material.surface is Surface.SIGNAL:
                made["emissiveFactor"] = factor
            self.materials.append(made)
            self.of_material[material] = len(self.materials) - 1
        return self.of_material[material]

    def mesh(self, mesh: Mesh, name: str) -> int:
        """Add a mesh, one primitive for each material; return its index."""
        # Row 0 of our textures is v = 1, row 0 of glTF's is v = 0.
        uvs = np.ascontiguousarray(mesh.uvs * [1.0, -1.0], np.float32)
        primitives = []
        for index, material in enumerate(mesh.palette):
            triangles = mesh.triangles[mesh.materials == index]
            if not len(triangles):
                continue
            used, corners = np.unique(triangles, return_inverse=True)
            primitives.append(
                {
                    "attributes": {
                        "POSITION": self.array(mesh.positions[used], "VEC3"),
                        "NORMAL": self.array(mesh.normals[used], "VEC3"),
                        "TEXCOORD_0": self.array(uvs[used], "VEC2"),
                    },
                    "indices": self.array(corners.ravel().astype(np.uint32), "SCALAR"),
                    "material": self.material(material),
                }
            )
        self.meshes.append({"name": name, "primitives": primitives})
        return len(self.meshes) - 1


def run(name: str, seed: int, path: Path, detail: int) -> int:
    """Write a map as a `.glb` file; return its number of triangles.

    Args:
        name: Name of the map.
        seed: Seed of the map.
        path: The file.
        detail: Level of detail of trees and furniture; 0 is the finest.

    Raises:
        EyasError: The map cannot be built, or the file not written.
    """
    scene = load_scene(name, seed)
    file = _File(load_textures())
    nodes: list[dict[str, Any]] = [{"name": "static", "mesh": file.mesh(scene.static, "static")}]
    triangles = len(scene.static.triangles)
    fixtures = scene.fixtures
    drawn: dict[int, tuple[int, int]] = {}
    for kind, pose in zip(fixtures.prototype.tolist(), fixtures.pose, strict=True):
        if kind not in drawn:
            levels = fixtures.levels[kind]
            chosen = levels[min(detail, len(levels) - 1)]
            label = fixtures.names[kind] if fixtures.names else f"prototype {kind}"
            drawn[kind] = file.mesh(chosen, label), len(chosen.triangles)
        index, count = drawn[kind]
        columns = np.vstack([pose, [0.0, 0.0, 0.0, 1.0]]).T.ravel()
        nodes.append({"mesh": index, "matrix": [round(float(v), 6) for v in columns]})
        triangles += count
    write_atomic(path, _glb(file, nodes, scene, MAPS.get(name).attribution()))
    return triangles


def _glb(file: _File, nodes: list[dict[str, Any]], scene: Scene, notice: str) -> bytes:
    root = {"name": scene.name, "rotation": _UPRIGHT, "children": list(range(1, len(nodes) + 1))}
    asset = {"version": "2.0", "generator": "Eyas"}
    if notice:
        asset["copyright"] = notice.splitlines()[0]
    told = {
        "asset": asset,
        "scene": 0,
        "scenes": [{"nodes": [0], "name": scene.name}],
        "nodes": [root, *nodes],
        "meshes": file.meshes,
        "materials": file.materials,
        "textures": [{"source": k, "sampler": 0} for k in range(len(file.images))],
        "images": file.images,
        "samplers": [{"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497}],
        "accessors": file.accessors,
        "bufferViews": file.views,
        "buffers": [{"byteLength": file.length}],
    }
    text = json.dumps({key: value for key, value in told.items() if value != []}).encode()
    text += b" " * (-len(text) % 4)
    body = b"".join(file.parts)
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

"""A map in a glTF file: a node for each class, below it one for each object."""

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.files import write_atomic
from eyas.engine.sim.scenes import load_scene, load_textures
from eyas.engine.state.scene import Lamps, ObjectClass, Scene
from eyas.engine.world.maps import MAPS
from eyas.lanes import exact
from eyas.maps.formats.gltf.file import LIGHTS, GltfFile
from eyas.maps.formats.meshes import copies_of, parts_of, prototypes_of

CANDELAS = 1500.0  # Intensity of a street lamp along its axis: some 10,000 lm in its cone [cd]


def add_world(file: GltfFile, scene: Scene, detail: int) -> int:
    """Add all that stands on a map; return its number of triangles."""
    groups: dict[ObjectClass, int] = {}
    triangles = 0
    for part in parts_of(scene):
        mesh = file.mesh(part.mesh, part.name)
        node = {"name": part.name, "mesh": mesh, "extras": {"class": _name(part.object_class)}}
        file.node(node, _group(file, groups, part.object_class))
        triangles += len(part.mesh.triangles)
    prototypes = prototypes_of(scene.fixtures, detail)
    drawn: dict[int, int] = {}
    for copies in copies_of(scene):
        shape, group = prototypes[copies.prototype], _group(file, groups, copies.object_class)
        if not len(shape.triangles):
            continue
        if copies.prototype not in drawn:
            drawn[copies.prototype] = file.mesh(shape, copies.name)
        for number, pose in enumerate(copies.pose):
            node = {"name": f"{copies.name}-{number}", "mesh": drawn[copies.prototype]}
            extras = {"class": _name(copies.object_class)}
            file.node({**node, "matrix": _columns(pose), "extras": extras}, group)
        triangles += len(shape.triangles) * len(copies.pose)
    return triangles


def add_lamps(file: GltfFile, lamps: Lamps) -> None:
    """Add the street lamps, as spotlights."""
    if not len(lamps.position):
        return
    cone = {"innerConeAngle": 0.0, "outerConeAngle": min(lamps.cut_off, math.pi / 2)}
    file.lights.append(
        {"name": "street lamp", "type": "spot", "intensity": CANDELAS, "color": [1.0, 0.87, 0.7],
         "spot": cone}
    )  # fmt: skip
    group = file.node({"name": "lamps"})
    light = {LIGHTS: {"light": len(file.lights) - 1}}
    for number, (place, axis) in enumerate(zip(lamps.position, lamps.axis, strict=True)):
        node: dict[str, Any] = {"name": f"lamp-{number}", "translation": _rounded(place)}
        file.node({**node, "rotation": _rounded(towards(axis)), "extensions": light}, group)


def _group(file: GltfFile, groups: dict[ObjectClass, int], kind: ObjectClass) -> int:
    if kind not in groups:
        groups[kind] = file.node({"name": _name(kind), "extras": {"class_id": int(kind)}})
    return groups[kind]


def _name(kind: ObjectClass) -> str:
    return kind.name.lower()


def _columns(pose: NDArray[np.float32]) -> list[float]:
    """Return a pose as glTF has it, column by column."""
    return _rounded(np.vstack([pose, [0.0, 0.0, 0.0, 1.0]]).T.ravel())


def _rounded(values: NDArray[np.generic]) -> list[float]:
    return [round(float(value), 6) for value in values]


def towards(axis: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the shortest turn from -z, where lights shine, to a unit vector, as x, y, z, w."""
    x, y, z = axis.astype(np.float64).tolist()
    if z > 1.0 - 1e-9:
        return np.array([1.0, 0.0, 0.0, 0.0])
    turn = np.array([y, -x, 0.0, 1.0 - z])
    found: NDArray[np.float64] = turn / exact.length(turn)
    return found


def write_gltf(name: str, seed: int, path: Path, detail: int, *, lamps: bool = True) -> int:
    """Write a map as a `.glb` file; return its number of triangles.

    Args:
        lamps: Whether its street lamps are lights.

    Raises:
        EyasError: The map cannot be built, or the file not written.
    """
    scene = load_scene(name, seed)
    file = GltfFile(scene.name, load_textures(), MAPS.get(name).attribution())
    triangles = add_world(file, scene, detail)
    if lamps:
        add_lamps(file, scene.lamps)
    write_atomic(path, file.encoded())
    return triangles

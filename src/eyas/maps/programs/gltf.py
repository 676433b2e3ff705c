"""A map as one file that any viewer opens: binary glTF 2.0 with its textures."""

from pathlib import Path

from eyas.engine.core.files import write_atomic
from eyas.engine.sim.scenes import load_scene, load_textures
from eyas.engine.world.maps import MAPS
from eyas.maps.exports.gltf.file import GltfFile
from eyas.maps.exports.gltf.world import add_lamps, add_world

__all__ = ["run"]


def run(name: str, seed: int, path: Path, detail: int, *, lamps: bool = True) -> int:
    """Write a map as a `.glb` file; return its number of triangles.

    Args:
        name: Name of the map.
        seed: Seed of the map.
        path: The file.
        detail: Level of detail of trees and furniture; 0 is the finest.
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

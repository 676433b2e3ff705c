"""A map as GeoJSON of its streets and buildings, and as rasters of occupancy and height."""

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from PIL import Image

from eyas.engine.core.files import atomic_path, refusals, write_atomic
from eyas.engine.mesh.assembly import transformed
from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.place import projection_of
from eyas.engine.world.maps.recipe import ATTRIBUTION_FILE, MapRecipe
from eyas.maps.commands.info import street_lines

CLASSES = {
    0: "ground", 1: "road", 2: "pavement", 3: "building", 4: "tree", 5: "structure", 6: "water",
}  # fmt: skip
"""Values of the raster of occupancy."""

_VALUES = {
    ObjectClass.GROUND: 0, ObjectClass.ROAD: 1, ObjectClass.MARKING: 1, ObjectClass.PAVEMENT: 2,
    ObjectClass.BUILDING: 3, ObjectClass.TREE: 4, ObjectClass.STRUCTURE: 5, ObjectClass.POLE: 5,
    ObjectClass.WATER: 6,
}  # fmt: skip

_FEW = 12  # Number of cells up to which numbers one by one are quicker than arrays

_FINE, _COARSE = 0.5, 1.0  # Side of a cell unless another is asked for [m]
_MOST = 40_000_000  # Number of fine cells of a map from which on they are coarse

Points = NDArray[np.float64]


def write_layers(name: str, seed: int, folder: Path, cell: float | None) -> list[Path]:
    """Write streets, buildings and rasters of a map into a folder; return the files.

    Args:
        folder: The folder; made if it does not exist.
        cell: Side of a raster cell [m]; None: 0.5, or 1 on a large map.

    Raises:
        EyasError: The map cannot be built, or a file not written.
    """
    recipe, scene = MAPS.get(name), load_scene(name, seed)
    cell = cell or _cell_of(scene)
    with refusals(folder):
        folder.mkdir(parents=True, exist_ok=True)
    layers = {"roads": _roads(scene), "buildings": _buildings(scene)}
    made = [
        _write(folder / f"{what}.geojson", _collection(recipe, rows))
        for what, rows in layers.items()
    ]
    occupancy, height = rasters_of(scene, cell)
    west, south = -scene.size[0] / 2, -scene.size[1] / 2
    raster = folder / "raster.npz"
    with atomic_path(raster) as part, part.open("wb") as file:
        np.savez_compressed(
            file, occupancy=occupancy, height=height, cell=cell, west=west, south=south
        )
    made.append(raster)
    # From north to south, as pictures are; the arrays go from south to north.
    centimetres = np.clip(np.rint(100 * height[::-1]), 0, 65535).astype(np.uint16)
    for label, pixels in (("occupancy", occupancy[::-1]), ("height", centimetres)):
        path = folder / f"{label}.png"
        with atomic_path(path) as part:
            Image.fromarray(np.ascontiguousarray(pixels)).save(part, format="PNG")
        made.append(path)
    about = {
        "map": recipe.name, "seed": seed, "cell": cell, "west": west, "south": south,
        "north": scene.size[1] / 2, "classes": CLASSES, "height.png": "centimetres above z = 0",
        "attribution": recipe.attribution(),
    }  # fmt: skip
    made.append(_write(folder / "raster.json", about))
    if recipe.attribution():
        write_atomic(folder / ATTRIBUTION_FILE, recipe.attribution().encode())
        made.append(folder / ATTRIBUTION_FILE)
    return made


def _cell_of(scene: Scene) -> float:
    """Return the side of a cell where none is asked for [m]."""
    fine = scene.size[0] * scene.size[1] / (_FINE * _FINE)
    return _FINE if fine <= _MOST else _COARSE


def _write(path: Path, content: dict[str, Any]) -> Path:
    write_atomic(path, (json.dumps(content) + "\n").encode())
    return path


def _roads(scene: Scene) -> list[tuple[shapely.Geometry, dict[str, Any]]]:
    return [(line, {"length": round(line.length, 2)}) for line in street_lines(scene.network)]


def _buildings(scene: Scene) -> list[tuple[shapely.Geometry, dict[str, Any]]]:
    """Return the footprint of each building; what is solid of it may be several pieces."""
    solids = scene.colliders
    pieces: dict[int, list[tuple[shapely.Polygon, tuple[float, float]]]] = {}
    for solid, (low, high) in enumerate(pairwise(solids.prism_first)):
        owner = int(solids.prism_object[solid])
        if scene.object_class[owner] == ObjectClass.BUILDING:
            outline = shapely.Polygon(solids.prism_points[low:high])
            span = float(solids.prism_bottom[solid]), float(solids.prism_top[solid])
            pieces.setdefault(owner, []).append((outline, span))
    rows: list[tuple[shapely.Geometry, dict[str, Any]]] = []
    for owner, parts in pieces.items():
        bottom = min(span[0] for _, span in parts) - scene.terrain.floor
        top = max(span[1] for _, span in parts) - scene.terrain.floor
        told = {"object": owner, "min_height": round(bottom, 2), "height": round(top, 2)}
        rows.append((shapely.union_all([outline for outline, _ in parts]), told))
    return rows


def _collection(
    recipe: MapRecipe, rows: list[tuple[shapely.Geometry, dict[str, Any]]]
) -> dict[str, Any]:
    """Return GeoJSON: in degrees where the map lies somewhere, otherwise in its own metres."""
    shapes = [shape for shape, _ in rows]
    projection = projection_of(recipe)
    if projection is not None:
        shapes = [shapely.transform(shape, projection.degrees) for shape in shapes]
    told: dict[str, Any] = {
        "type": "FeatureCollection",
        "coordinates": "WGS 84" if projection else "metres east and north of the map's middle",
    }
    if recipe.attribution():
        told["attribution"] = recipe.attribution().splitlines()[0]
    told["features"] = [
        {"type": "Feature", "geometry": json.loads(shapely.to_geojson(shape)), "properties": row}
        for shape, (_, row) in zip(shapes, rows, strict=True)
    ]
    return told


def rasters_of(scene: Scene, cell: float) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Return what is seen from straight above, from south to north.

    Args:
        cell: Side of a cell [m].

    Returns:
        `CLASSES` of the highest surface, and its z [m], both of shape (rows, columns).
    """
    columns, rows = (int(np.ceil(side / cell)) for side in scene.size)
    occupancy = np.zeros((rows, columns), np.uint8)
    height = np.full((rows, columns), scene.terrain.floor, np.float32)
    low = -np.array(scene.size) / 2
    values = np.array([_VALUES.get(ObjectClass(int(kind)), 5) for kind in scene.object_class])
    _lay(scene.static, values[scene.static_object], (low, cell), occupancy, height)
    fixtures = scene.fixtures
    for kind, pose, owner in zip(
        fixtures.prototype, fixtures.pose, fixtures.object_id, strict=True
    ):
        coarse = transformed(fixtures.levels[kind][-1], pose)
        owners = np.full(len(coarse.triangles), values[owner])
        _lay(coarse, owners, (low, cell), occupancy, height)
    return occupancy, height


def _lay(
    mesh: Mesh,
    values: NDArray[np.integer],
    frame: tuple[Points, float],
    occupancy: NDArray[np.uint8],
    height: NDArray[np.float32],
) -> None:
    """Lay the triangles of a mesh over a raster wherever they are the highest."""
    low, cell = frame
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    flat = (corners[..., :2] - low) / cell - 0.5
    edge, other = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    twice = edge[:, 0] * other[:, 1] - edge[:, 1] * other[:, 0]
    first = np.maximum(np.ceil(flat.min(axis=1)), 0).astype(int)
    last = np.minimum(np.floor(flat.max(axis=1)), np.array(height.shape)[::-1] - 1).astype(int)
    seen = (np.abs(twice) > 1e-9) & (last >= first).all(axis=1)
    small = seen & ((last - first + 1).prod(axis=1) <= _FEW)
    told = np.concatenate(
        [flat[:, 0], edge, other, twice[:, None], corners[..., 2]], axis=1
    ).tolist()
    for k in np.flatnonzero(seen):
        (x0, y0), (x1, y1) = first[k], last[k]
        if small[k]:
            _lay_small(told[k], (int(x0), int(y0), int(x1), int(y1)), values[k], occupancy, height)
            continue
        dx = np.arange(x0, x1 + 1) - flat[k, 0, 0]
        dy = (np.arange(y0, y1 + 1) - flat[k, 0, 1])[:, None]
        s = (dx * other[k, 1] - dy * other[k, 0]) / twice[k]
        t = (dy * edge[k, 0] - dx * edge[k, 1]) / twice[k]
        a, b, c = corners[k, :, 2]
        z = a + s * (b - a) + t * (c - a)
        window = height[y0 : y1 + 1, x0 : x1 + 1]
        above = (s >= 0) & (t >= 0) & (s + t <= 1) & (z > window)
        window[above] = z[above]
        occupancy[y0 : y1 + 1, x0 : x1 + 1][above] = values[k]


def _lay_small(
    told: list[float],
    window: tuple[int, int, int, int],
    value: np.integer,
    occupancy: NDArray[np.uint8],
    height: NDArray[np.float32],
) -> None:
    """Lay a triangle over few cells, where numpy takes ten times as long for the same sums."""
    x, y, ex, ey, ox, oy, twice, a, b, c = told
    x0, y0, x1, y1 = window
    for row in range(y0, y1 + 1):
        dy = row - y
        for column in range(x0, x1 + 1):
            dx = column - x
            s = (dx * oy - dy * ox) / twice
            t = (dy * ex - dx * ey) / twice
            if s >= 0 and t >= 0 and s + t <= 1:
                z = a + s * (b - a) + t * (c - a)
                if z > height[row, column]:
                    height[row, column] = z
                    occupancy[row, column] = value

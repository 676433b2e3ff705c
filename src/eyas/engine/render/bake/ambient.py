"""Share of the sky seen from ground and roofs: less beside walls, under trees and bridges."""

import math
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.render.bake.tracks import blurred
from eyas.engine.render.kernels.light.ambient import (
    DIRECTIONS,
    DISTANCES,
    EVEN,
    OpennessBake,
    bake_openness,
)
from eyas.engine.render.textures.fields import SIZE, fractal, source
from eyas.engine.state.mesh import Surface
from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.state.terrain import reliefs
from eyas.lanes import PackedBundle, exact, thread_count

if TYPE_CHECKING:
    from PIL import Image, ImageDraw


TEXEL = 1.0  # Side of a texel [m]

LARGEST = 2048  # Largest number of texels along a side

_LOWEST = 1.5  # Things less high than this above the ground hide no sky [m]

_DECK = 3.0  # Elevated roads less high than this are taken for the ground [m]


@dataclass(frozen=True, slots=True)
class AmbientMap:
    """Share of the sky seen from the ground, or from the roof of a building."""

    openness: NDArray[np.uint32]
    """First byte: share of the sky's light that arrives there, 0 to 255; second: where row + column
    is even, height of what hides the rest, else height of the roof, 0 on the ground [m above the
    ground]; fourth: wear, see `WEAR`, `EVEN` for none; shape (rows, columns)."""
    frame: NDArray[np.float64]  # West and south edge [m], texels per metre, z of the ground [m]


def bake_ambient(
    scene: Scene,  # The static scene. Structures lower than `_DECK` hide little and are left out
    folder: Path | None = None,  # Folder of the cache; None: the user's
) -> AmbientMap:
    """Return the map of a scene; computed only if the cache lacks it."""
    extent = np.array(scene.size)
    texel = max(TEXEL, float(extent.max()) / LARGEST)
    columns, rows = np.ceil(extent / texel).astype(int)
    terrain = scene.terrain
    frame = np.array([*(-0.5 * extent), 1.0 / texel, terrain.floor])
    inputs = (
        (rows, columns),
        frame,
        np.array([terrain.west, terrain.south, terrain.spacing]),
        terrain.relief,
        scene.static.positions,
        scene.static.triangles,
        scene.object_class[scene.static_object],
        scene.fixtures.prototype,
        scene.fixtures.pose,
    )
    make = partial(_bake, scene, frame, (rows, columns), texel)
    openness = cached(EntryKind.AMBIENT, make, inputs, of=NDArray[np.uint32], folder=folder)
    return AmbientMap(openness, frame)


def _bake(
    scene: Scene, frame: NDArray[np.float64], shape: tuple[int, int], texel: float
) -> NDArray[np.uint32]:
    solid = height_map(scene, frame, shape)
    crowns = canopy_map(scene, frame, shape)
    decks = height_map(scene, frame, shape, structures=True)
    openness = openness_of(solid, crowns, decks, texel, thread_count())
    return np.asarray(openness | (_wear(scene, frame, solid, crowns) << 24), np.uint32)


def _wear(
    scene: Scene,
    frame: NDArray[np.float64],
    solid: NDArray[np.float32],
    crowns: NDArray[np.float32],
) -> NDArray[np.uint32]:
    """Return how much lighter the ground is than its texture, see `WEAR`, shape of `crowns`.

    Lawns and fields vary most, by as much at 2 m as at 60 m; roads and roofs less, and so does
    sand, which has waves of its own. Roads have dust along their edges, where feet and wheels thin
    the grass. Below trees it is damp. Where no road is, nothing is worn.
    """
    mesh, kind = scene.static, scene.object_class[scene.static_object]
    roads = mesh.positions[mesh.triangles[kind == ObjectClass.ROAD], :2]
    if not len(roads):
        return np.full(crowns.shape, EVEN, np.uint32)
    picture, pen = _canvas(crowns.shape)
    for corners in (roads - frame[:2]) * frame[2]:
        pen.polygon(corners.ravel().tolist(), fill=1.0)
    road = np.array(picture, np.float32)
    near = blurred(blurred(road, 2), 1)
    verge = 4.0 * near * (1.0 - near)  # 1 where a road ends
    repeats = [-(-size // SIZE) for size in crowns.shape]
    noise = np.tile(fractal(source("wear"), 0.85, longest=90.0), repeats)
    noise = noise[: crowns.shape[0], : crowns.shape[1]]
    # Hollows, where it is damp or dark gravel lies, are fewer and darker than what is dry.
    noise -= 1.3 * np.maximum(-0.7 - noise, 0.0)
    most = 38.0 if any(one.surface == Surface.DESERT for one in mesh.palette) else 44.0
    light = most * (1.0 - 0.62 * np.maximum(road, solid > 0)) * noise
    light += 14.0 * verge * (1.0 + 0.6 * noise) - 16.0 * (crowns > 0)
    light[0, 0] = 0.0  # stands for all that lies beyond the map
    return np.round(np.clip(EVEN + light, 0.0, 255.0)).astype(np.uint32)


def openness_of(
    solid: NDArray[np.float32],  # Height of buildings above the ground [m], shape (rows, columns)
    crowns: NDArray[np.float32],  # The same of trees
    decks: NDArray[np.float32],  # The same of elevated roads
    texel: float,  # Side of a texel [m]
    workers: int,  # Number of threads
) -> NDArray[np.uint16]:
    """Return `AmbientMap.openness`."""
    openness = np.empty(solid.shape, np.uint16)
    way, distance = _ways(texel), np.array(DISTANCES)
    square = math.ceil(DISTANCES[-1] / texel) + 1
    near = _near(decks, square)
    bake = OpennessBake(way, distance, solid, crowns, decks, square, near, openness)
    bake_openness(workers, PackedBundle(bake))
    return openness


def _ways(texel: float) -> NDArray[np.float64]:
    """Return `OpennessBake.way`; numpy's sines differ between processors, those of C do not."""
    angles = [(k + 0.5) * (2.0 * math.pi / DIRECTIONS) for k in range(DIRECTIONS)]
    return np.array(
        [
            [(exact.sin(angle) / texel * far, exact.cos(angle) / texel * far) for far in DISTANCES]
            for angle in angles
        ]
    )


def _near(decks: NDArray[np.float32], square: int) -> NDArray[np.bool_]:
    """Return whether there are decks in each square of texels or in one of the eight around it."""
    rows, columns = (-(-size // square) for size in decks.shape)
    near = np.zeros((rows + 2, columns + 2), np.bool_)
    for row, column in {*map(tuple, (np.argwhere(decks > 0.0) // square).tolist())}:
        near[row : row + 3, column : column + 3] = True
    return np.ascontiguousarray(near[1:-1, 1:-1])


def height_map(
    scene: Scene, frame: NDArray[np.float64], shape: tuple[int, int], *, structures: bool = False
) -> NDArray[np.float32]:
    """Return the height of the highest solid above the ground in each texel [m], or that of the
    highest elevated road.

    The ground itself does not count, however steep it is: hills are not walls.
    """
    mesh = scene.static
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    kind = scene.object_class[scene.static_object]
    ground = frame[3] + reliefs(scene.terrain, corners[:, :, :2])
    rise = (corners[:, :, 2] - ground).max(axis=1)
    level = mesh.normals[mesh.triangles, 2].mean(axis=1) > 0.2
    of_kind = np.isin(kind, (ObjectClass.STRUCTURE, ObjectClass.ROAD)) == structures
    chosen = np.flatnonzero(level & of_kind & (rise > (_DECK if structures else _LOWEST)))
    flat = (corners[:, :, :2] - frame[:2]) * frame[2]
    picture, pen = _canvas(shape)
    for index in chosen[np.argsort(rise[chosen], kind="stable")]:
        pen.polygon(flat[index].ravel().tolist(), fill=float(rise[index]))
    return np.array(picture, np.float32)


def canopy_map(
    scene: Scene, frame: NDArray[np.float64], shape: tuple[int, int]
) -> NDArray[np.float32]:
    """Return the height above the ground of the crown's top over each texel, 0 for none [m]."""
    fixtures = scene.fixtures
    picture, pen = _canvas(shape)
    for index in np.flatnonzero(scene.object_class[fixtures.object_id] == ObjectClass.TREE):
        points = fixtures.levels[fixtures.prototype[index]][0].positions
        pose = fixtures.pose[index].astype(np.float64)
        scale = float(exact.cbrt(exact.determinant(pose[:, :3])))
        # The outermost leaves are few: the crown is a disc of the mean radius.
        reach = 0.9 * scale * float(np.abs(points[:, :2]).max())
        x, y = (pose[:2, 3] - frame[:2]) * frame[2]
        r = reach * frame[2]
        ground = frame[3] + float(reliefs(scene.terrain, pose[:2, 3]))
        top = scale * float(points[:, 2].max()) + pose[2, 3] - ground
        pen.ellipse((x - r, y - r, x + r, y + r), fill=float(top))
    return np.array(picture, np.float32)


def _canvas(shape: tuple[int, int]) -> "tuple[Image.Image, ImageDraw.ImageDraw]":
    """Return a picture of heights, and a pen for it."""
    from PIL import Image, ImageDraw  # not needed where the map is in the cache

    picture = Image.new("F", (shape[1], shape[0]), 0.0)
    return picture, ImageDraw.Draw(picture)

"""Map of the land for mist and fallen leaves: what is open, and what lies under trees."""

from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.render.bake.ambient import AmbientMap, canopy_map, height_map
from eyas.engine.render.bake.tracks import blurred
from eyas.engine.state.scene import ObjectClass, Scene

_BUILT = 1.5  # Height from which a building keeps mist away [m]

_OPEN = 0.72  # How open to mist fields are, where water is 1

_AROUND, _SHORE, _LITTER = 70.0, 16.0, 5.0
"""Lengths over which buildings, water and crowns are blurred [m]: mist flows from the open into
streets, over banks, and leaves are blown from under their trees."""


def no_land() -> NDArray[np.uint16]:
    """Return the map where nothing needs one."""
    return np.zeros((2, 2), np.uint16)


def land_map(
    scene: Scene,  # The static scene
    ambient: AmbientMap,  # Its map of the sky's light
    folder: Path | None = None,  # Folder of the cache; None: the user's
) -> NDArray[np.uint16]:
    """Return the map of a scene in the frame of its `AmbientMap`; kept in the cache.

    Low byte: how much of a place lies under crowns; high byte: how open to mist it is, 0 to 255
    each. Mist forms where the ground loses its heat to the sky (radiation fog) and over water
    that is warmer than the air; between buildings there is less of both.
    """
    shape = ambient.openness.shape
    water = _water(scene)
    inputs = (
        shape,
        ambient.frame,
        scene.static.positions,
        scene.static.triangles,
        scene.object_class[scene.static_object],
        scene.fixtures.prototype,
        scene.fixtures.pose,
    )
    make = partial(_map, scene, ambient.frame, shape, water)
    return cached(EntryKind.AMBIENT, make, inputs, of=NDArray[np.uint16], folder=folder)


def _water(scene: Scene) -> NDArray[np.float64]:
    """Return the triangles of water in plan view [m], shape (., 3, 2)."""
    wet = scene.object_class[scene.static_object] == ObjectClass.WATER
    corners = scene.static.positions[scene.static.triangles[wet]]
    return np.asarray(corners[:, :, :2], np.float64)


def _map(
    scene: Scene, frame: NDArray[np.float64], shape: tuple[int, int], water: NDArray[np.float64]
) -> NDArray[np.uint16]:
    from PIL import Image, ImageDraw  # only where mist or leaves lie

    west, south, per_metre, _ = frame
    built = (height_map(scene, frame, shape) > _BUILT).astype(np.float32)
    lakes = Image.new("F", (shape[1], shape[0]))
    pen = ImageDraw.Draw(lakes)
    for triangle in (water - (west, south)) * per_metre:
        pen.polygon(triangle.ravel().tolist(), fill=1.0)
    crowns = (canopy_map(scene, frame, shape) > 0.0).astype(np.float32)

    def spread(values: NDArray[np.float32], length: float) -> NDArray[np.float32]:
        texels = max(round(length * per_metre), 1)
        return blurred(blurred(values, texels), texels)

    land = np.clip(1.0 - 2.2 * spread(built, _AROUND), 0.0, 1.0)
    shore = np.clip(1.6 * spread(np.array(lakes, np.float32), _SHORE), 0.0, 1.0)
    open_ = np.maximum(_OPEN * land, shore) * (1.0 - built)
    under = np.clip(1.5 * spread(crowns, _LITTER), 0.0, 1.0)
    low, high = np.round(255.0 * under), np.round(255.0 * open_)
    return np.asarray(low.astype(np.uint16) | (high.astype(np.uint16) << 8), np.uint16)

"""Stones as fixtures: scatters of gravel and stones, boulders. Origins on the ground, in metres."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate, of_one_material
from eyas.engine.mesh.solids import sphere
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.scene_builder import Levels
from eyas.lanes import exact

STONES = 1.5  # Radius of a scatter of stones [m]
BOULDER = 0.8  # Height of the highest boulder [m]

_LOOKS = (
    material("stone", (0.80, 0.66, 0.47)),
    material("stone", (0.70, 0.55, 0.39)),
    material("stone", (0.62, 0.60, 0.56)),
    material("stone", (0.52, 0.50, 0.46)),
)
"""Sandstone, pale and dark, and granite."""
_COUNT, _SIZES = 13, (0.05, 0.3)
"""Number of stones in a scatter; their least and largest radius [m]. In between there are as many
as of a power law: mostly small ones."""
_CUTS = 6  # Planes at which a stone has broken

Array = NDArray[np.float64]


def stone_levels(
    rng: np.random.Generator,
    look: int,  # Kind of rock
) -> Levels:
    """Return a scatter of stones, the finest level of detail first; the last one is empty."""
    share = rng.uniform(0.0, 1.0, _COUNT)
    least, most = _SIZES
    radii = np.sort(least / (1.0 - share * (1.0 - least / most)))[::-1]
    away = STONES * np.sqrt(rng.uniform(0.0, 1.0, _COUNT))
    angle = rng.uniform(0.0, 2 * np.pi, _COUNT)
    spots = np.column_stack([away * exact.cos(angle), away * exact.sin(angle)])
    cover = _LOOKS[look % len(_LOOKS)]
    shapes = [_breaks(rng) for _ in range(_COUNT)]

    def first(count: int, fine: int) -> Mesh:
        return concatenate(
            [
                _stone(radii[k], spots[k], shapes[k], 1 if k < fine else 0, cover)
                for k in range(count)
            ]
        )

    return first(_COUNT, 3), first(5, 0), Mesh.none()


def boulder_levels(
    rng: np.random.Generator,
    look: int,  # Kind of rock
) -> Levels:
    """Return a boulder with a few stones at its foot, the finest level of detail first."""
    cover, radius = _LOOKS[look % len(_LOOKS)], 0.62 * BOULDER
    spots, sizes = rng.uniform(-1.1, 1.1, (5, 2)), rng.uniform(0.08, 0.24, 5)
    shapes = [_breaks(rng) for _ in range(6)]
    small = [_stone(sizes[k], spots[k], shapes[k], 0, cover) for k in range(5)]
    fine, rough = (_stone(radius, np.zeros(2), shapes[5], k, cover) for k in (2, 1))
    return concatenate([fine, *small]), concatenate([rough, *small[:2]]), rough


def _breaks(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Return how a stone has broken: normals and distances of planes, and its stretch."""
    way = exact.normal(rng, size=(_CUTS, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    return way, rng.uniform(0.52, 0.85, _CUTS), rng.uniform((0.8, 0.8, 0.6), (1.3, 1.3, 0.95))


def _stone(
    radius: float,
    spot: Array,
    shape: tuple[Array, Array, Array],
    subdivisions: int,
    cover: Material,
) -> Mesh:
    """Return a stone that sticks in the ground: a ball, flat where it has broken."""
    ball = sphere(subdivisions, cover)
    points = ball.positions.astype(np.float64)
    for way, limit in zip(*shape[:2], strict=True):
        over = np.maximum(exact.product(points, way) - limit, 0.0)
        points -= over[:, None] * way
    points = radius * shape[2] * points + np.array([*spot, 0.25 * radius])
    corners = points[ball.triangles]
    corners = corners[corners[..., 2].max(axis=1) > 0.0]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    flat = corners.reshape(-1, 3)
    return of_one_material(
        flat,
        np.repeat(normals, 3, axis=0),
        (flat[:, :2] + flat[:, 2:]) / 2.0,
        np.arange(len(flat)).reshape(-1, 3),
        cover,
    )

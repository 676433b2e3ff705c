"""Land beyond the streets: fields up to the horizon, and the end of an elevated road."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.flat import quads
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.materials import TEXTURES, material
from eyas.engine.world.build.millimetres import rounded, snapped, unit
from eyas.engine.world.roads.curves import TURN, arc
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.roads.overpass import DECK_WIDTH, path

_LINES = (450.0, 620.0, 860.0, 1200.0, 1700.0, 2300.0, 3000.0, 4200.0, 6500.0, 10000.0)
"""Borders of the fields from the centre of a floor of 900 m; scaled with the floor [m]."""
CROPS = (
    (material("lawn", (0.99, 0.99, 0.97)), 0.26),
    (material("lawn", (0.92, 0.95, 0.86)), 0.22),
    (material("lawn", (0.84, 0.91, 0.80)), 0.2),
    (material("crops", (0.98, 1.0, 0.92)), 0.14),
    (material("crops_ripe", (0.90, 0.92, 0.82)), 0.12),
    (material("soil", (0.98, 0.94, 0.88)), 0.06),
)
"""What grows on the fields, and the share of each."""
_BELOW = 0.05
"""Depth of the fields below the floor, so that rounding never makes them show through [m]."""

_LAND_LINES = (1000.0, 1400.0, 2100.0, 3200.0, 5000.0, 10000.0)
"""Borders of the land around a city, from the middle of its floor [m]."""

_BACK = 26.0  # From the foot of a ramp back to the bend of its access road towards the street [m]
_BEND = 19.0  # Radius of that bend [m]
_TAIL = 621.0  # Length of an elevated road's descent, a slope of 9 % on average [m]

Points = NDArray[np.float64]


def fields(
    size: tuple[float, float],  # Extent of the floor [m]
    floor: float,  # z of the floor [m]
    rng: np.random.Generator,
    # What grows on them, and the share of each; the shares add up to 1
    crops: Sequence[tuple[Material, float]],
) -> Mesh:
    """Return the land around the floor up to the horizon, a patchwork of large fields."""
    half = np.array([*(-np.array(_LINES[::-1])), -150.0, 150.0, *_LINES])
    steps = len(half) - 1
    x, y = np.meshgrid(half * size[0] / 900.0, half * size[1] / 900.0, indexing="ij")
    corner = np.stack([x, y, np.full_like(x, floor - _BELOW)], axis=-1)
    loose = np.maximum(np.abs(half)[:, None], np.abs(half)[None]) > _LINES[0]
    loose[[0, -1]], loose[:, [0, -1]] = False, False
    corner[..., :2] *= 1.0 + loose[..., None] * rng.uniform(-0.08, 0.08, (*x.shape, 2))
    cells = np.stack(
        [corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]], axis=2
    ).reshape(-1, 4, 3)
    inner = np.abs(half[:-1] + half[1:]) / 2 < _LINES[0]
    outside = ~(inner[:, None] & inner[None]).ravel()
    kind = rng.choice(len(crops), size=steps * steps, p=[share for _, share in crops])
    made = []
    for index, (crop, _) in enumerate(crops):
        some = cells[outside & (kind == index)]
        made.append(quads(some, some[..., :2] / TEXTURES[crop.texture], crop))
    return concatenate(made)


def access_road(
    foot: Points,  # Middle of the lower end of the ramp [m], shape (2,)
    onwards: Points,  # Unit vector up the ramp, shape (2,)
    roads: shapely.Geometry,  # Asphalt of the streets [m]
) -> shapely.Geometry:
    """Return the asphalt from a street to the foot of a ramp, in plan view."""
    corner = rounded(foot - _BACK * onwards)
    street = shapely.get_coordinates(shapely.shortest_line(shapely.Point(corner), roads))[-1]
    bend = arc(foot, corner, street, _BEND)
    beyond = rounded(street + unit(street - corner))
    line = shapely.LineString(np.concatenate([foot[None], bend, beyond[None]]))
    strip = snapped(shapely.buffer(line, DECK_WIDTH / 2, cap_style="flat", quad_segs=24))
    near = shapely.intersection(roads, shapely.buffer(strip, 40.0))
    both = shapely.union(near, strip)
    closed = snapped(shapely.buffer(shapely.buffer(both, TURN), -TURN))
    mouth = shapely.intersection(closed, shapely.Point(street).buffer(2.0 * DECK_WIDTH))
    # Rounding leaves slivers along the edge of the street.
    parts = shapely.get_parts(shapely.difference(shapely.union(strip, mouth), roads))
    return max(parts, key=shapely.area)


def descent(
    middle: Points,  # Centre line of the road so far, shape (K, 3) [m]
    floor: float,  # z of the ground [m]
) -> Points:
    """Return the continuation of an elevated road from its end, straight and down to the ground.

    Returns:
        Centre line of the descent, shape (K, 3) [m].
    """
    onwards = unit(middle[-1, :2] - middle[-2, :2])
    line = [middle[-1, :2], middle[-1, :2] + _TAIL * onwards]
    profile = ((0.0, middle[-1, 2]), (0.96, floor + 0.1), (1.0, floor))
    # Far away every third cross-section is enough.
    return path(line, (), profile)[::3]


def city_land(
    size: tuple[float, float],  # Extent of the floor [m]
    rng: np.random.Generator,
    covers: Sequence[Material],  # What covers them
    shares: Sequence[float],  # The share of each; they add up to 1
) -> Mesh:
    """Return the land around the floor of a city up to the horizon, in large patches."""
    x = np.array([*(-np.array(_LAND_LINES[::-1])), -330.0, 330.0, *_LAND_LINES])
    y = np.where(np.abs(x) == _LAND_LINES[0], np.sign(x) * 0.5 * size[1], x)
    east, north = np.meshgrid(x, y, indexing="ij")
    corner = np.stack([east, north, np.full_like(east, FLOOR_HEIGHT - _BELOW)], axis=-1)
    cells = np.stack(
        [corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]], axis=2
    ).reshape(-1, 4, 3)
    middle = np.abs(cells[..., :2].mean(axis=1))
    cells = cells[(middle[:, 0] > 0.5 * size[0]) | (middle[:, 1] > 0.5 * size[1])]
    kind = rng.choice(len(covers), size=len(cells), p=tuple(shares))
    made = []
    for index, cover in enumerate(covers):
        some = cells[kind == index]
        made.append(quads(some, some[..., :2] / TEXTURES[cover.texture], cover))
    return concatenate(made)

"""Buildings: their positions in city blocks, and their appearance."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.world.build.materials import FACADES
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.buildings.looks import roof_cover, wall_tint
from eyas.maps.buildings.lots import divide, footprint_in, frame_angle, largest, turned
from eyas.maps.buildings.skyline import FLOOR, TOWER_SHARE, evenly, ground_areas, storeys
from eyas.maps.plan.plan import BuildingPart

SETBACK = 4.4  # Least distance between a kerb and a building [m]

_YARD = 0.8  # Part of the set-back that `footprint_in` itself keeps from the edge of every lot [m]

_SMALL = 200.0
"""Larger parts of the kept-free area shape the lots, smaller ones only the footprints [m^2]."""


def place_buildings(
    # Ground between streets, bounded by the kerbs, world frame [m]
    blocks: Sequence[shapely.Polygon],
    count: int,  # Number of buildings, towers included; a few fewer are placed if there is no room
    rng: np.random.Generator,
    keep_free: shapely.Geometry,  # Area where nothing may stand
) -> list[BuildingPart]:
    """Fill city blocks with buildings whose sizes are spread as in the original's street city.

    About a fifth are towers that stand on other buildings. No two share space.
    """
    towers = round(TOWER_SHARE * count)
    areas = np.sort(ground_areas(count - towers, rng))[::-1]
    # Every third of the larger ones carries a tower; the very largest are halls and malls.
    large = np.flatnonzero((areas > 700) & (np.arange(len(areas)) >= 2))
    carriers = set(rng.permutation(large)[:towers].tolist())
    shapes: list[shapely.Polygon] = []
    base: list[int] = []
    for ground, angle, members in _shared(blocks, areas, keep_free):
        wanted = [(float(areas[i]), i in carriers) for i in members]
        keep = [turned(part, -angle) for part in shapely.get_parts(keep_free)]
        for lot, carrier in divide(ground, wanted):
            shape = _clear(footprint_in(lot, rng, plain=carrier), keep)
            if shape.area >= 6.0:
                shapes.append(turned(shape, angle))
                base.append(-1)
                if carrier and shape.area > 500:
                    shapes.append(turned(_shaft(shape, rng), angle))
                    base.append(len(shapes) - 2)
    return _furnished(shapes, np.array(base, np.int64), rng)


def _shared(
    blocks: Sequence[shapely.Polygon], areas: NDArray[np.float64], keep_free: shapely.Geometry
) -> list[tuple[shapely.Polygon, float, list[int]]]:
    """Return for each block its free ground in its own frame, its angle and its buildings."""
    wide = [part for part in shapely.get_parts(keep_free) if part.area > _SMALL]
    grounds, angles = [], []
    for block in blocks:
        inner = shapely.buffer(block, _YARD - SETBACK, join_style="mitre")
        inner = largest(shapely.difference(inner, shapely.union_all(wide)))
        if inner.area > 200:
            angles.append(frame_angle(inner))
            grounds.append(turned(inner, -angles[-1]))
    room = np.array([ground.area for ground in grounds])
    members: list[list[int]] = [[] for _ in grounds]
    for i, area in enumerate(areas) if grounds else ():
        block_index = int(np.argmax(room))
        members[block_index].append(i)
        room[block_index] -= 1.6 * area + 400.0
    return [entry for entry in zip(grounds, angles, members, strict=True) if entry[2]]


def _clear(shape: shapely.Polygon, keep_free: Sequence[shapely.Polygon]) -> shapely.Polygon:
    """Return a footprint without the boxes around the kept-free areas in it."""
    for part in keep_free:
        if part.intersects(shape):
            taken = shapely.box(*part.bounds) if part.area <= _SMALL else part
            shape = largest(shapely.difference(shape, taken))
    return _without_courts(shape)


def _without_courts(shape: shapely.Polygon) -> shapely.Polygon:
    """Return a footprint whose holes are opened towards the nearest side: an outline has none."""
    for hole in shape.interiors:
        west, south, east, north = shape.bounds
        left, low, right, high = hole.bounds
        slots = {
            left - west: (west - 1, low, right, high),
            east - right: (left, low, east + 1, high),
            low - south: (left, south - 1, right, high),
            north - high: (left, low, right, north + 1),
        }
        shape = largest(shapely.difference(shape, shapely.box(*slots[min(slots)])))
    return shape


def _shaft(podium: shapely.Polygon, rng: np.random.Generator) -> shapely.Polygon:
    """Return the footprint of a tower on a podium, both in the block's frame."""
    west, south, east, north = podium.bounds
    size = np.array([east - west, north - south]) * rng.uniform(0.5, 0.78, 2)
    size = np.maximum(9.0, 3.0 * np.round(size / 3.0))
    corner = (
        np.array([west, south])
        + 2
        + rng.random(2) * (np.array([east - west, north - south]) - 4 - size)
    )
    shape = shapely.box(*corner, *(corner + size))
    if rng.random() < 0.3:
        bevel = 0.25 * size.min()
        octagon = shapely.buffer(
            shapely.buffer(shape, -bevel), bevel, join_style="bevel", quad_segs=1
        )
        shape = octagon
    return largest(shapely.intersection(shape, shapely.buffer(podium, -1.5, join_style="mitre")))


def _furnished(
    shapes: Sequence[shapely.Polygon], base: NDArray[np.int64], rng: np.random.Generator
) -> list[BuildingPart]:
    """Give footprints their heights, facades and roofs."""
    area = np.array([shape.area for shape in shapes])
    top = FLOOR * storeys(np.sqrt(area), base, rng)
    kinds = evenly(FACADES, len(shapes), rng)
    carries = set(base.tolist())
    made = []
    for i, shape in enumerate(shapes):
        foot = top[base[i]] if base[i] >= 0 else 0.0
        compact = (
            area[i] > 0.97 * shapely.convex_hull(shape).area and len(shape.exterior.coords) < 8
        )
        eligible = compact and area[i] < 1600 and top[i] <= 36 and i not in carries
        pyramid = bool(eligible and base[i] < 0 and rng.random() < 0.55)
        made.append(
            BuildingPart(
                outline=shapely.geometry.polygon.orient(shape),
                bottom=float(FLOOR_HEIGHT + foot),
                height=float(top[i] - foot),
                facade=kinds[i],
                tint=wall_tint(rng),
                roof="pyramid" if pyramid else "flat",
                cover=roof_cover(float(top[i]), rng, pyramid=pyramid),
            )
        )
    return made

"""Car parks: light asphalt with painted bays and a driveway to the street."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.world.build.millimetres import rounded
from eyas.lanes import exact
from eyas.maps.buildings.lots import frame_angle, turned
from eyas.maps.land.ground import PAVEMENT_WIDTH

_MODULE = 17.0  # Depth of two rows of bays and the aisle between them [m]
_BAY_LENGTH, _BAY_WIDTH = 5.2, 2.6
_DRIVEWAY = 6.5
_LAWN = 2.5  # Width of the lawn between the pavement and the car park [m]
_SPOTS = ((0.12, 0), (0.88, 0), (0.5, 0), (0.12, 1), (0.88, 1), (0.5, 1))
"""Positions to try: share of the free length along the block, and which of its long sides."""


@dataclass(frozen=True, slots=True)
class CarPark:
    """A car park in plan view."""

    area: shapely.Polygon
    """Asphalt for the cars and the driveway, which ends slightly beyond the kerb [m]."""
    lines: list[shapely.Polygon]  # Paint between the bays [m]
    bays: NDArray[np.float64]
    """Centre of each bay [m] and heading of a car in it [rad], shape (K, 3)."""


def place_car_parks(
    blocks: Sequence[shapely.Polygon],  # Ground between kerbs [m]
    # Length along the street and depth of each; those that fit nowhere are left out [m]
    sizes: Sequence[tuple[float, float]],
    rng: np.random.Generator,
    keep_free: shapely.Geometry,  # Area where none may be
) -> list[CarPark]:
    """Return car parks beside streets, at most one in a block."""
    order = [blocks[int(index)] for index in rng.permutation(len(blocks))]
    made = []
    for size in sizes:
        for block in order:
            placed = _placed(block, size, rng, keep_free)
            if placed:
                made.append(placed)
                order.remove(block)
                break
    return made


def place_rectangle(
    block: shapely.Polygon,  # Ground between kerbs [m]
    size: tuple[float, float],  # Lengths along the side and away from it [m]
    rng: np.random.Generator,
    keep_free: shapely.Geometry,  # Area that it may not touch
) -> tuple[shapely.Polygon, float, int] | None:
    """Return a rectangle beside a long side of a block, in the block's frame.

    Returns:
        The rectangle, the direction of the block's frame [rad], and the side: 0 south, 1 north;
        None if nothing fits.
    """
    angle = frame_angle(block)
    margin = PAVEMENT_WIDTH + _LAWN
    room = turned(shapely.buffer(block, -margin + 0.05, join_style="mitre"), -angle)
    taken = turned(keep_free, -angle)
    west, south, east, north = room.bounds
    for index in rng.permutation(len(_SPOTS)):
        share, side = _SPOTS[int(index)]
        x = west + share * (east - west - size[0])
        # A block's side may bend: move inwards until the whole rectangle is inside.
        for inset in (0.1, 1.0, 2.0, 4.0, 6.0, 9.0):
            y = south + inset if side == 0 else north - inset - size[1]
            rectangle = shapely.box(x, y, x + size[0], y + size[1])
            if room.contains(rectangle) and not taken.intersects(rectangle):
                return rectangle, angle, side
    return None


def _placed(
    block: shapely.Polygon,
    size: tuple[float, float],
    rng: np.random.Generator,
    keep_free: shapely.Geometry,
) -> CarPark | None:
    found = place_rectangle(block, size, rng, keep_free)
    if not found:
        return None
    rectangle, angle, side = found
    west, south, east, north = rectangle.bounds
    middle = (west + east) / 2
    street = (south - 25.0, south + 0.5) if side == 0 else (north - 0.5, north + 25.0)
    drive = shapely.box(middle - _DRIVEWAY / 2, street[0], middle + _DRIVEWAY / 2, street[1])
    # Slightly beyond the kerb, so that rounding leaves no gap to the road.
    way = shapely.intersection(
        drive, shapely.buffer(turned(block, -angle), 0.05, join_style="mitre")
    )
    entrance = shapely.buffer(way, _BAY_LENGTH + 0.3, join_style="mitre")
    lines = [line for line in _bays(rectangle) if not line.intersects(entrance)]
    area = turned(shapely.union(rectangle, way), angle)
    bays = _between(lines)
    cosine, sine = exact.cos(angle), exact.sin(angle)
    bays[:, :2] = rounded(exact.product(bays[:, :2], np.array([[cosine, sine], [-sine, cosine]])))
    bays[:, 2] += angle
    return CarPark(area, [turned(line, angle) for line in lines], bays)


def _between(lines: Sequence[shapely.Polygon]) -> NDArray[np.float64]:
    """Return the bays between each line and the next of the same row, in the block's frame."""
    middles = shapely.get_coordinates([line.centroid for line in lines]).reshape(-1, 2)
    step = np.diff(middles, axis=0)
    together = exact.hypot(step[:, 0] - _BAY_WIDTH, step[:, 1]) < 0.01
    middle = (middles[:-1] + step / 2)[together]
    return np.column_stack([middle, np.full(len(middle), np.pi / 2)])


def _bays(rectangle: shapely.Polygon) -> list[shapely.Polygon]:
    west, south, east, north = rectangle.bounds
    count = int((east - west - 1.0) // _BAY_WIDTH)
    first = (west + east - count * _BAY_WIDTH) / 2
    lines = []
    for module in range(int(round(north - south, 3) // _MODULE)):
        low = south + module * _MODULE
        for y in (low + 0.3, low + _MODULE - 0.3 - _BAY_LENGTH):
            lines += [
                shapely.box(x - 0.06, y, x + 0.06, y + _BAY_LENGTH)
                for x in first + _BAY_WIDTH * np.arange(count + 1)
            ]
    return lines


_ROW_MODULE = 16.4  # Depth of two rows of bays and the aisle between them [m]
_ROW_BAY_LENGTH, _ROW_BAY_WIDTH = 5.1, 2.6
_EDGE = 0.4  # Distance from the edge of the car park to the bays [m]
_PAINT = 0.12  # Width of a line between bays [m]

Bays = NDArray[np.float64]


def bays_in(
    area: shapely.Geometry,  # The car park in plan view [m]
) -> tuple[Bays, list[shapely.Polygon]]:
    """Return bays that lie within a car park, and the paint between them.

    Returns:
        Centre of each bay [m] and heading of a car in it [rad], shape (K, 3); lines [m].
    """
    if area.is_empty:
        return np.zeros((0, 3)), []
    hull = shapely.convex_hull(area)
    angle = frame_angle(hull) if hull.geom_type == "Polygon" else 0.0
    room = shapely.buffer(turned(area, -angle), -_EDGE, join_style="mitre")
    if room.is_empty:
        return np.zeros((0, 3)), []
    west, south, east, north = room.bounds
    columns = west + _ROW_BAY_WIDTH * np.arange(int((east - west) // _ROW_BAY_WIDTH))
    modules = south + _ROW_MODULE * np.arange(int((north - south) // _ROW_MODULE) + 1)
    rows = np.concatenate([modules, modules + _ROW_MODULE - _ROW_BAY_LENGTH - _EDGE])
    x, y = (axis.ravel() for axis in np.meshgrid(columns, np.sort(rows), indexing="ij"))
    boxes = shapely.box(x, y, x + _ROW_BAY_WIDTH, y + _ROW_BAY_LENGTH)
    inside = shapely.contains_properly(room, boxes)
    x, y = x[inside], y[inside]
    sides = np.unique(
        np.round(np.concatenate([np.c_[x, y], np.c_[x + _ROW_BAY_WIDTH, y]]), 2), axis=0
    )
    paint = shapely.box(sides[:, 0] - _PAINT / 2, sides[:, 1], sides[:, 0] + _PAINT / 2,
                        sides[:, 1] + _ROW_BAY_LENGTH)  # fmt: skip
    middles = np.stack([x + _ROW_BAY_WIDTH / 2, y + _ROW_BAY_LENGTH / 2], axis=1)
    cosine, sine = exact.cos(angle), exact.sin(angle)
    places = rounded(exact.product(middles, np.array([[cosine, sine], [-sine, cosine]])))
    heading = np.full((len(places), 1), angle + np.pi / 2)
    return np.concatenate([places, heading], axis=1), [turned(line, angle) for line in paint]

"""City blocks cut into lots, and footprints shaped to fill them. Lengths in metres, plan view."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import affinity

from eyas.engine.world.build.millimetres import snapped
from eyas.lanes import exact

BAY = 3.0  # Width of one window bay; walls are multiples of it where the lot allows [m]


@dataclass(frozen=True, slots=True)
class Lot:
    """A part of a block in the block's frame, whose x axis runs along its longest street."""

    shape: shapely.Polygon  # Ground of the lot
    street: tuple[bool, bool, bool, bool]
    """Whether the west, east, south and north side lies on the block's boundary."""
    area: float  # Ground area that the building should cover [m^2]


def frame_angle(block: shapely.Polygon) -> float:
    """Return the direction of the longer side of the block's tightest rectangle [rad].

    Within -22.5° to 157.5°, so that a side has one direction, however the corners of the rectangle
    are ordered.
    """
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(block))
    sides = np.diff(corners, axis=0)[:2]
    longest = sides[int(np.argmax(np.linalg.norm(sides, axis=1)))]
    angle = float(exact.atan2(longest[1], longest[0]))
    # Streets along an axis are common, so they must lie inside the range, not at its ends.
    return round((angle + math.pi / 8) % math.pi - math.pi / 8, 9)


def divide(ground: shapely.Polygon, wanted: Sequence[tuple[float, bool]]) -> list[tuple[Lot, bool]]:
    """Cut a block into lots, one for each building.

    Each cut crosses the longer side and divides the ground in proportion to the wanted areas.

    Args:
        ground: The block without its set-back, in its own frame.
        wanted: Ground area of each building [m^2], and a flag that is returned with its lot.
    """
    outline = shapely.boundary(ground)
    lots = []
    for shape, (area, mark) in _cut(ground, sorted(wanted, reverse=True)):
        west, south, east, north = shape.bounds
        middles = [
            (west, (south + north) / 2),
            (east, (south + north) / 2),
            ((west + east) / 2, south),
            ((west + east) / 2, north),
        ]
        near = [shapely.distance(outline, shapely.Point(m)) < 1.0 for m in middles]
        lots.append((Lot(shape, (near[0], near[1], near[2], near[3]), area), mark))
    return lots


def _cut(
    shape: shapely.Polygon, wanted: list[tuple[float, bool]]
) -> list[tuple[shapely.Polygon, tuple[float, bool]]]:
    if shape.area < 30:
        return []
    if len(wanted) == 1:
        return [(shape, wanted[0])]
    # Small buildings, too, need some ground around them.
    weights = np.array([area for area, _ in wanted]) + 150.0
    first = 1 + int(np.argmin(np.abs(np.cumsum(weights)[:-1] / weights.sum() - 0.5)))
    share = weights[:first].sum() / weights.sum()
    west, south, east, north = shape.bounds
    low, high = 0.0, 1.0
    wide = east - west >= north - south
    for _ in range(24):
        at = (low + high) / 2
        if wide:
            x = west + at * (east - west)
            sides = shapely.box(west, south, x, north), shapely.box(x, south, east, north)
        else:
            y = south + at * (north - south)
            sides = shapely.box(west, south, east, y), shapely.box(west, y, east, north)
        left = shapely.intersection(shape, sides[0])
        low, high = (at, high) if left.area < share * shape.area else (low, at)
    right = shapely.intersection(shape, sides[1])
    return _cut(largest(left), wanted[:first]) + _cut(largest(right), wanted[first:])


def footprint_in(lot: Lot, rng: np.random.Generator, *, plain: bool = False) -> shapely.Polygon:
    """Return a footprint within a lot, close to the street, in the lot's frame.

    Args:
        lot: Lot of the building.
        plain: Whether it must be a rectangle, as below a tower.
    """
    kind = "box" if plain or lot.area < 350 else str(rng.choice(_KINDS, p=_ODDS))
    fill = _FILL[kind]
    west, south, east, north = _free_box(lot, rng)
    width, depth = _size(lot, east - west, north - south, lot.area / fill)
    if kind == "octagon":
        width = depth = min(width, depth)
    x = _anchored(west, east, width, lot.street[0], lot.street[1])
    y = _anchored(south, north, depth, lot.street[2], lot.street[3])
    outline = _outline(kind, width, depth, rng) + np.array([x, y])
    room = shapely.buffer(lot.shape, -0.8, join_style="mitre")
    clipped = largest(shapely.intersection(shapely.Polygon(outline), room))
    return largest(shapely.simplify(clipped, 0.4))


_KINDS = ("box", "angle", "court", "notched", "comb", "octagon")
_ODDS = (0.46, 0.22, 0.12, 0.10, 0.06, 0.04)
_FILL = {"box": 1.0, "angle": 0.66, "court": 0.70, "notched": 0.93, "comb": 0.78, "octagon": 0.83}


def _free_box(lot: Lot, rng: np.random.Generator) -> tuple[float, float, float, float]:
    """Return the lot's box without front yards at streets and alleys beside neighbours."""
    yards = np.where(lot.street, rng.uniform(0.8, 4.0, 4), rng.uniform(1.5, 4.5, 4))
    west, south, east, north = lot.shape.bounds
    if east - west < 16 or north - south < 16:
        yards = np.minimum(yards, 1.0)
    return west + yards[0], south + yards[2], east - yards[1], north - yards[3]


def _size(lot: Lot, width: float, depth: float, area: float) -> tuple[float, float]:
    """Return the sides of a fitting box of about `area`, shortened away from the street."""
    if area < width * depth:
        facing_x = lot.street[0] or lot.street[1]
        facing_y = lot.street[2] or lot.street[3]
        if facing_y and not facing_x:
            depth = float(np.clip(area / width, min(depth, 13.0), depth))
            width = min(width, area / depth)
        elif facing_x and not facing_y:
            width = float(np.clip(area / depth, min(width, 13.0), width))
            depth = min(depth, area / width)
        else:
            shrink = math.sqrt(area / (width * depth))
            width, depth = width * shrink, depth * shrink
        if max(width, depth) > 3.2 * min(width, depth):
            long = min(1.9 * math.sqrt(area), max(width, depth))
            short = area / long
            width, depth = (long, short) if width > depth else (short, long)
    return _snapped(width), _snapped(depth)


def _snapped(length: float) -> float:
    """Return a length close to the given one: whole bays if it has at least four of them."""
    return BAY * float(np.floor(length / BAY + 0.3)) if length >= 4 * BAY else length


def _anchored(low: float, high: float, size: float, at_low: bool, at_high: bool) -> float:
    if at_low and not at_high:
        return low
    if at_high and not at_low:
        return high - size
    return (low + high - size) / 2


def _outline(
    kind: str, width: float, depth: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return counter-clockwise corners within (0, 0) to (width, depth), mirrored at random."""
    wing = [max(_snapped(0.4 * side), 0.3 * side) for side in (width, depth)]
    notch = [max(BAY, _snapped(0.2 * side)) for side in (width, depth)]
    across = (width - wing[0]) / 2
    cut = 0.29 * min(width, depth)
    w, d, a, b = width, depth, wing[0], wing[1]
    shapes: dict[str, list[tuple[float, float]]] = {
        "box": [(0, 0), (w, 0), (w, d), (0, d)],
        "angle": [(0, 0), (w, 0), (w, b), (a, b), (a, d), (0, d)],
        "court": [
            (0, 0), (w, 0), (w, d), (w - 0.75 * a, d), (w - 0.75 * a, b), (0.75 * a, b),
            (0.75 * a, d), (0, d),
        ],
        "notched": [
            (0, 0), (w, 0), (w, d - notch[1]), (w - notch[0], d - notch[1]), (w - notch[0], d),
            (0, d),
        ],
        "comb": [
            (0, 0), (w, 0), (w, 0.62 * d), (w - across, 0.62 * d), (w - across, d), (across, d),
            (across, 0.62 * d), (0, 0.62 * d),
        ],
        "octagon": [
            (cut, 0), (w - cut, 0), (w, cut), (w, d - cut), (w - cut, d), (cut, d), (0, d - cut),
            (0, cut),
        ],
    }  # fmt: skip
    corners = np.array(shapes[kind], np.float64)
    for axis, size in ((0, width), (1, depth)):
        if rng.random() < 0.5:
            corners[:, axis] = size - corners[:, axis]
            corners = corners[::-1]
    return corners


def largest(shape: shapely.Geometry) -> shapely.Polygon:
    """Return the largest polygon of a shape, empty if it has none."""
    parts = [p for p in shapely.get_parts(shape) if isinstance(p, shapely.Polygon)]
    return max(parts, key=lambda part: float(part.area), default=shapely.Polygon())


def turned(shape: shapely.Geometry, angle: float) -> shapely.Geometry:
    """Return a shape turned counter-clockwise about the origin [rad], in whole millimetres."""
    return snapped(affinity.rotate(shape, angle, origin=(0, 0), use_radians=True))

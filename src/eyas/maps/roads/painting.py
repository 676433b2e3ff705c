"""Paint on roads as triangles, slightly above the asphalt."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.ops import substring

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.flat import flat_polygons, quads
from eyas.engine.state.mesh import MARGIN, Material, Mesh, Surface
from eyas.engine.world.build.materials import TEXTURES, material
from eyas.engine.world.build.millimetres import length
from eyas.engine.world.roads.areas import GRID, split_on_grid
from eyas.maps.build.values import Line, Positive

PAINT_HEIGHT = 0.015
"""z of the paint: invisible, but enough to separate it from the asphalt at any distance [m]."""
MARGIN_HEIGHT = 0.012
"""z of the asphalt beside it, which hides the wear of the road but no other paint [m]."""

WHITE = material("paint", (0.99, 0.99, 0.98))
_WHITE_LINE = Material("asphalt_paint", (0.99, 0.985, 0.96), Surface.MARKING)
_YELLOW_LINE = Material("asphalt_paint", (0.99, 0.77, 0.27), Surface.MARKING)


@dataclass(frozen=True, slots=True)
class Stripe:
    """A painted line."""

    middle: Line
    """Points along its middle, shape (K, 2) [m]."""
    width: Positive
    """Width [m]."""

    @property
    def area(self) -> shapely.Polygon:
        """Return where paint is, in plan view."""
        return shapely.buffer(shapely.LineString(self.middle), self.width / 2, cap_style="flat")


@dataclass(frozen=True, slots=True)
class RoadPaint:
    """Paint on roads, in plan view."""

    lines: list[Stripe]
    """White lines."""
    arrows: list[shapely.Polygon]
    """White arrows."""
    zebras: list[list[Stripe]]
    """Yellow bars of each crossing, and pairs of yellow lines."""


def mesh_of(paint: RoadPaint) -> Mesh:
    """Return the paint as triangles."""
    return concatenate([painted(paint.arrows, WHITE), *_strips(paint, 0.0, PAINT_HEIGHT)])


def margins_of(paint: RoadPaint) -> Mesh:
    """Return the asphalt beside the lines.

    A pixel whose middle lies there may show some of the line, see `Surface.MARKING`: without
    margins, lines narrower than a pixel would break into pieces.
    """
    return concatenate(_strips(paint, MARGIN, MARGIN_HEIGHT))


def stripes(line: Line, width: float, dashes: tuple[float, float] | None = None) -> list[Stripe]:
    """Return a painted line.

    Args:
        line: Centre line, shape (K, 2) [m].
        width: Width [m].
        dashes: Length of a dash and of the gap between two; None: a solid line.
    """
    if not dashes:
        return [Stripe(line, width)]
    path = shapely.LineString(line)
    count = int((path.length + dashes[1]) // sum(dashes))
    spare = path.length - (count * sum(dashes) - dashes[1])
    starts = spare / 2 + np.arange(count) * sum(dashes)
    pieces = [substring(path, start, start + dashes[0]) for start in starts]
    return [Stripe(shapely.get_coordinates(piece), width) for piece in pieces]


def _strips(paint: RoadPaint, margin: float, z: float) -> list[Mesh]:
    """Return the lines as quadrilaterals, wider than the paint on both sides by a margin [m]."""
    bars = [bar for zebra in paint.zebras for bar in zebra]
    return [
        _together(some, margin, z, kind)
        for some, kind in ((paint.lines, _WHITE_LINE), (bars, _YELLOW_LINE))
    ]


def _together(some: Sequence[Stripe], margin: float, z: float, kind: Material) -> Mesh:
    """Return lines of one colour; u and v are in half widths, see `Surface.MARKING`."""
    if not some:
        return Mesh.none()
    short = [k for k, line in enumerate(some) if _is_short(line.middle)]  # most are dashes
    made = dict(zip(short, _short_strips([some[k] for k in short], margin), strict=True))
    made |= {k: _strip(line, margin) for k, line in enumerate(some) if k not in made}
    corners, uvs = zip(*(made[k] for k in range(len(some))), strict=True)
    flat = np.concatenate(corners)
    level = np.full((*flat.shape[:2], 1), z)
    return quads(np.concatenate([flat, level], axis=2), np.concatenate(uvs), kind)


def _strip(stripe: Stripe, margin: float) -> tuple[Line, Line]:
    """Return corners of the quadrilaterals of a line [m], and u and v, shapes (K, 4, 2)."""
    middle = _pieces(stripe.middle)
    along = np.gradient(middle, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    half = stripe.width / 2
    reach = 1.0 + margin / half
    across = reach * half * np.stack([-along[:, 1], along[:, 0]], axis=1)
    gone = np.append(0.0, np.linalg.norm(np.diff(middle, axis=0), axis=1).cumsum()) / half
    right, left = (np.stack([np.full(len(gone), 32.0 + u), gone], axis=1) for u in (-reach, reach))
    return _cells(middle - across, middle + across), _cells(right, left)


def _is_short(line: Line) -> bool:
    """Return whether a line is one straight piece within the side of a square."""
    return len(line) == 2 and length(line[1] - line[0]) <= GRID


def _short_strips(some: Sequence[Stripe], margin: float) -> Iterator[tuple[Line, Line]]:
    """Yield for short lines what `_strip` returns, computed for all at once."""
    ends = np.array([line.middle for line in some], np.float64).reshape(-1, 2, 2)
    half = np.array([line.width for line in some])[:, None, None] / 2
    along = ends[:, 1:] - ends[:, :1]
    size = np.linalg.norm(along, axis=2, keepdims=True)
    along = along / size
    reach = 1.0 + margin / half
    across = reach * half * np.concatenate([-along[..., 1:], along[..., :1]], axis=2)
    right, left = ends - across, ends + across
    corners = np.stack([right[:, 0], right[:, 1], left[:, 1], left[:, 0]], axis=1)
    u = np.concatenate([32.0 - reach, 32.0 - reach, 32.0 + reach, 32.0 + reach], axis=1)
    gone, start = size / half, np.zeros_like(size)
    uvs = np.concatenate([u, np.concatenate([start, gone, gone, start], axis=1)], axis=2)
    yield from zip(corners[:, None], uvs[:, None], strict=True)


def _pieces(line: Line) -> Line:
    """Return a line without needless points, in pieces no longer than the side of a square."""
    path = shapely.simplify(shapely.LineString(line), 1e-3)
    return np.asarray(shapely.get_coordinates(shapely.segmentize(path, GRID)), np.float64)


def _cells(right: Line, left: Line) -> Line:
    """Return the corners between two rows of points, counter-clockwise, shape (K - 1, 4, .)."""
    return np.stack([right[:-1], right[1:], left[1:], left[:-1]], axis=1)


def painted(shapes: Sequence[shapely.Polygon], paint: Material) -> Mesh:
    """Return painted shapes on a road at z = 0."""
    # Long lines are cut, so that each piece belongs to one square of the map only.
    pieces = [
        part
        for shape in shapes
        for part in (split_on_grid(shape) if shape.length > 60.0 else [shape])
    ]
    return flat_polygons(pieces, PAINT_HEIGHT, paint, TEXTURES["paint"])

"""What lies and grows in the desert, and where wheels have left the road."""

import numpy as np
import shapely

from eyas.engine.world.build.millimetres import rounded
from eyas.engine.world.build.placed import Placed
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.desert.layout import EXTENT, DesertLayout
from eyas.maps.land.relief import Points, Relief, heights_of
from eyas.maps.plants import gardens

_REACH = 100.0  # Distance from the roads as far as there are stones and plants of their own [m]
_BESIDE, _BESIDE_BOULDERS = 2.8, 9.0  # Their least distance from a road [m]
_GROUPS = (13.0, 0.008)
"""Least distance between groups [m], and number of attempts on a square metre."""
_HIGHEST, _SUNK = 9.0, 0.06
"""Height up to which plants grow on dunes, and how deep things stand in the sand [m]."""
_STONES, _SPREAD, _MEMBERS = 0.45, 6.0, (2, 9)
"""Share of the groups that are stones; standard deviation of a group [m]; its members."""
_BUSHES, _BOULDERS = 0.4, 0.12
"""Share of the plants that are bushes, and of the stones that are boulders."""

_TRACKS, _TRACK_LENGTH = 9, (70.0, 190.0)
_GAUGE, _RUT = 0.8, 0.25  # Half the distance of two ruts, and half the width of one [m]


def scattered_over(
    desert: DesertLayout,  # Where roads, houses and drifts are
    ground: Relief,
    taken: shapely.Geometry,  # Where nothing may lie [m]
    rng: np.random.Generator,
) -> list[Placed]:
    """Return stones and plants in groups, too low to hide anything."""
    sand = [drift.fringe for drift in desert.drifts]
    closed = shapely.buffer(shapely.union_all([taken, *sand, *desert.tongues]), _BESIDE)
    near = shapely.intersection(EXTENT, shapely.buffer(desert.roads, _REACH, quad_segs=2))
    room = shapely.difference(near, closed)
    shapely.prepare(room)
    far = shapely.buffer(desert.roads, _BESIDE_BOULDERS)
    shapely.prepare(far)
    centres = gardens.scattered(room, *_GROUPS, rng)
    centres = centres[heights_of(ground, centres) < _HIGHEST]
    stony = rng.random(len(centres)) < _STONES
    made: list[Placed] = []
    for some, large, small in (
        (centres[stony], ("boulder 0", "boulder 1"), ("stones 0", "stones 1")),
        (centres[~stony], _named("dry bush"), _named("dry tuft")),
    ):
        spots = rounded(gardens.clustered(some, _SPREAD, _MEMBERS, room, rng))
        high = heights_of(ground, spots)
        share = _BOULDERS if small[0] == "stones 0" else _BUSHES
        is_large = (rng.random(len(spots)) < share) & ~shapely.contains_xy(far, spots)
        for kinds, which in ((large, is_large), (small, ~is_large)):
            feet = FLOOR_HEIGHT + high[which] - _SUNK
            made += gardens.sown(spots[which], kinds, (0.6, 1.4), feet, rng)
    return made


def _named(make: str) -> tuple[str, ...]:
    return tuple(f"{make} {k}" for k in range(3))


def wheel_tracks(desert: DesertLayout, rng: np.random.Generator) -> shapely.Geometry:
    """Return where wheels have left the road and come back: pairs of ruts in the sand [m]."""
    made = []
    parts = [shapely.geometry.polygon.orient(part) for part in shapely.get_parts(desert.roads)]
    rings = [ring for part in parts for ring in (part.exterior, *part.interiors)]
    sizes = np.array([round(float(ring.length), 3) for ring in rings])
    for _ in range(_TRACKS):
        ring = rings[int(rng.choice(len(rings), p=sizes / sizes.sum()))]
        start, length = rng.uniform(0.0, ring.length), rng.uniform(*_TRACK_LENGTH)
        # Out to a few metres from the road and back.
        along = np.linspace(0.0, 1.0, 40)
        away = rng.uniform(4.0, 8.0) * np.minimum(1.0, 5.0 * np.minimum(along, 1.0 - along))
        away += rng.uniform(0.5, 1.2) * np.abs(along - 0.5) - 1.0
        line = _beside(ring, (start + length * along) % ring.length, away)
        ruts = [_aside(line, side) for side in (-_GAUGE, _GAUGE)]
        made += [shapely.buffer(rut, _RUT, cap_style="flat", quad_segs=2) for rut in ruts]
    houses = shapely.buffer(desert.walls, 2.0)
    drifts = shapely.union_all([drift.fringe for drift in desert.drifts] + desert.tongues)
    free = shapely.difference(shapely.union_all(made), shapely.union(houses, drifts))
    return shapely.difference(free, shapely.buffer(desert.roads, 0.3))


def _beside(ring: shapely.Geometry, along: Points, away: Points) -> Points:
    """Return points on the right of a ring, which has roads on its left."""
    here = shapely.get_coordinates(shapely.line_interpolate_point(ring, along))
    there = shapely.get_coordinates(
        shapely.line_interpolate_point(ring, (along + 0.5) % ring.length)
    )
    ahead = there - here
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-9)
    return rounded(here + away[:, None] * np.column_stack([ahead[:, 1], -ahead[:, 0]]))


def _aside(line: Points, away: float) -> shapely.LineString:
    ahead = np.gradient(line, axis=0)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-9)
    return shapely.LineString(rounded(line + away * np.column_stack([-ahead[:, 1], ahead[:, 0]])))

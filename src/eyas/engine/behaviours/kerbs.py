"""Ways along the kerbs of imported towns, whose pavements begin and end and are narrow."""

from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from eyas.engine.behaviours.obstacles import GroundObstacles
from eyas.engine.behaviours.pavements import Walkway, along, bridged, is_hard, paved_parts
from eyas.engine.behaviours.surface import WalkedSurface
from eyas.engine.state.motion import Motion
from eyas.engine.state.scene import Footways
from eyas.engine.targets.catalogue import KINDS, MODELS, models_of
from eyas.engine.world.roads.areas import polygons_of
from eyas.lanes import exact

_LANES: Final = (0.9, 1.45)
"""Distances from the kerb of those who have the road on their left, and on their right [m]."""

_BESIDE_CARS: Final = 0.6
"""Nearest to the kerb that one passes a wall or a tree; else it is passed on its other side [m]."""

_SPARE: Final = 0.15
"""How much wider obstacles are passed than need be, as corners of ways are rounded [m]."""

_ROUNDED: Final = 0.05  # How much nearer to obstacles ways may come where their corners are cut [m]

_APART: Final = 1.0  # Distance to such places that is kept [m]

_KERB_HEIGHT: Final = 0.05
"""Pavements are higher than this: paving at the foot of buildings is not [m]."""

_FROM_CARS: Final = 1.1
"""Nobody walks nearer to where vehicles come, at the points that are tested [m]."""

_GRAIN: Final = 0.1  # Places nearer to each other than half of this are one [m]

_TURN: Final = 0.03  # The same for headings [rad]


def kerb_ways(
    footways: Footways,  # The kerbs
    obstacles: GroundObstacles,  # What stands in the way, without the roads
    surface: WalkedSurface,  # The ground
    radius: float,  # Distance to obstacles that is kept [m]
    # Those that may come over kerbs, as in narrow corners; None: there are none
    vehicles: Motion | None = None,
) -> list[Walkway]:
    """Return the ways along all kerbs with pavements, round what stands on these."""
    swept = shapely.STRtree(_swept(vehicles) if vehicles is not None else [])
    place = _Place(obstacles, surface, swept, radius)
    found = []
    for first, last in pairwise(footways.kerb_first):
        kerb = shapely.LinearRing(footways.kerb_points[first:last])
        for lane, beyond in enumerate(_LANES):
            for ring in _rings(kerb, beyond, obstacles, radius):
                line = shapely.reverse(ring) if lane == 1 else ring
                found += _paved(line, place, lane)
    return found


class _Place(NamedTuple):
    """What decides where one walks along a kerb."""

    obstacles: GroundObstacles
    surface: WalkedSurface
    swept: shapely.STRtree  # Where vehicles come
    radius: float  # Distance to obstacles that is kept [m]


def _paved(ring: shapely.LinearRing, place: _Place, lane: int) -> list[Walkway]:
    """Return the parts of a ring that are on pavement, where no vehicle comes."""
    free, hard = _walked(ring, place)
    if not free.all():
        # It begins where nobody walks, so that no part of it is cut in two.
        ring = _from(ring, float(np.argmin(free)))
        free, hard = _walked(ring, place)
        free = bridged(free, hard)
    return paved_parts(ring, free, lane)


def _walked(ring: shapely.LinearRing, place: _Place) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which points along a ring are on pavement, and which are hard ground.

    Neither are those where cars come, or where obstacles leave no room on either side.
    """
    points = along(ring)
    under, clear = place.surface.at(points), np.ones(len(points), np.bool_)
    near = place.swept.query(shapely.points(points), predicate="dwithin", distance=_FROM_CARS)
    clear[near[0]] = False
    least = place.radius - _ROUNDED
    narrow = shapely.buffer(place.obstacles.near(ring, least), least, quad_segs=2)
    if len(narrow):
        met = shapely.intersection(ring, shapely.union_all(narrow))
        shapely.prepare(met)
        clear &= ~shapely.dwithin(shapely.points(points), met, _APART)
    raised = under.pavement & (under.height > _KERB_HEIGHT)
    return raised & clear, is_hard(under.height) & clear


def _swept(vehicles: Motion) -> NDArray[np.object_]:
    """Return where vehicles are, as boxes seen from above, each but once."""
    made = []
    for kind in np.unique(vehicles.kind).tolist():
        rows = vehicles.table[:, vehicles.kind == kind]
        rows = rows[rows["present"] > 0.0]
        # One number for each place and heading: unique rows would take five times as long.
        place = np.rint([rows["x"] / _GRAIN, rows["y"] / _GRAIN, rows["yaw"] / _TURN])
        _, first = np.unique((place[0] * 1e5 + place[1]) * 1e4 + place[2], return_index=True)
        x, y, yaw = place[:, first] * [[_GRAIN], [_GRAIN], [_TURN]]
        length, width, _ = np.array([MODELS[model].size for model in models_of(kind)]).max(axis=0)
        ahead = KINDS[kind].ahead + 0.5 * length * np.array([-1.0, 1.0, 1.0, -1.0])
        aside = 0.5 * width * np.array([-1.0, -1.0, 1.0, 1.0])
        cosine, sine = exact.cos(yaw)[:, None], exact.sin(yaw)[:, None]
        east = x[:, None] + ahead * cosine - aside * sine
        north = y[:, None] + ahead * sine + aside * cosine
        made.append(shapely.polygons(np.stack([east, north], axis=2)))
    return np.concatenate(made) if made else np.zeros(0, object)


def _from(ring: shapely.LinearRing, place: float) -> shapely.LinearRing:
    """Return a ring that begins at a place on it [m]."""
    parts = substring(ring, place, ring.length), substring(ring, 0.0, place)
    first, last = (shapely.get_coordinates(part) for part in parts)
    return shapely.LinearRing(np.concatenate([first[:-1], last]))


def _rings(
    kerb: shapely.LinearRing, beyond: float, obstacles: GroundObstacles, radius: float
) -> list[shapely.LinearRing]:
    """Return the ways at a distance from a kerb [m], with the road on their left."""
    around = shapely.is_ccw(kerb)  # the road lies within; otherwise it lies round a block
    plan = shapely.Polygon(kerb)
    aside = shapely.buffer(plan, beyond if around else -beyond, quad_segs=2)
    made = []
    for part in polygons_of(aside):
        inner = shapely.Polygon(part.exterior)
        near = obstacles.near(inner.exterior, radius + 0.1)
        kept = shapely.buffer(near, radius + _SPARE, quad_segs=2)
        at_kerb = shapely.distance(kept, kerb) < _BESIDE_CARS
        # What stands at the kerb is passed on the far side of it, all else on the near side.
        joined, cut = (at_kerb, ~at_kerb) if around else (~at_kerb, at_kerb)
        whole = shapely.union_all([inner, *kept[joined]])
        free = shapely.difference(whole, shapely.union_all(kept[cut]))
        parts = polygons_of(shapely.simplify(free, 0.04))
        if parts:
            ring = max(parts, key=shapely.area).exterior
            made.append(ring if shapely.is_ccw(ring) == around else shapely.reverse(ring))
    return made

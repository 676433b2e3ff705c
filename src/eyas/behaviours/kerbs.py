"""Ways along the kerbs of imported towns, whose pavements begin and end and are narrow."""

from itertools import pairwise
from typing import Final

import numpy as np
import shapely
from shapely.ops import substring

from eyas.behaviours.obstacles import Obstacles
from eyas.behaviours.pavements import Way, along, bridged, paved_parts
from eyas.behaviours.surface import Surface
from eyas.state.scene import Footways
from eyas.world.roads.areas import polygons_of

__all__ = ["kerb_ways"]

_LANES: Final = (0.7, 1.4)
"""Distances from the kerb of those who have the road on their left, and on their right [m]."""

_BESIDE_CARS: Final = 0.6
"""Nearest to the kerb that one passes a wall or a tree; else it is passed on its other side [m]."""

_SPARE: Final = 0.15
"""How much wider obstacles are passed than need be, as corners of ways are rounded [m]."""

_KERB_HEIGHT: Final = 0.05
"""Pavements are higher than this: paving at the foot of buildings is not [m]."""


def kerb_ways(
    footways: Footways, obstacles: Obstacles, surface: Surface, radius: float
) -> list[Way]:
    """Return the ways along all kerbs with pavements, round what stands on these.

    Args:
        footways: The kerbs.
        obstacles: What stands in the way, without the roads.
        surface: The ground.
        radius: Distance to obstacles that is kept [m].
    """
    found = []
    for first, last in pairwise(footways.kerb_first):
        kerb = shapely.LinearRing(footways.kerb_points[first:last])
        for lane, beyond in enumerate(_LANES):
            for ring in _rings(kerb, beyond, obstacles, radius):
                line = shapely.reverse(ring) if lane == 1 else ring
                found += _paved(line, surface, lane)
    return found


def _paved(ring: shapely.LinearRing, surface: Surface, lane: int) -> list[Way]:
    """Return the parts of a ring that are on pavement."""
    under = surface.at(along(ring))
    raised = under.pavement & (under.height > _KERB_HEIGHT)
    if not raised.all():
        # It begins where there is no pavement, so that no part of it is cut in two.
        ring = _from(ring, float(np.argmin(raised)))
        under = surface.at(along(ring))
        raised = bridged(under.pavement & (under.height > _KERB_HEIGHT), under.height)
    return paved_parts(ring, raised, lane)


def _from(ring: shapely.LinearRing, place: float) -> shapely.LinearRing:
    """Return a ring that begins at a place on it [m]."""
    parts = substring(ring, place, ring.length), substring(ring, 0.0, place)
    first, last = (shapely.get_coordinates(part) for part in parts)
    return shapely.LinearRing(np.concatenate([first[:-1], last]))


def _rings(
    kerb: shapely.LinearRing, beyond: float, obstacles: Obstacles, radius: float
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

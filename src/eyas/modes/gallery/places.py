"""Which cars are worth a look: each function rates all cars, 0 is unsuitable."""

from collections.abc import Callable

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.modes.gallery.solids import solids
from eyas.modes.gallery.still import StillScene
from eyas.modes.gallery.stops import POSES, Cars, drone_view
from eyas.state.scene import ObjectClass, Scene

__all__ = ["STOPS", "beside_most", "on_open_roads"]

_TREE = 12.0
"""Height of a street tree, whose mesh is 1 m high [m]."""
_TALL = 30.0
"""Height of a tower [m]."""
_SPAN = (4.0, 14.0)
"""Heights of the underside of a bridge [m]."""
_SOON = (4.0, 9.0)
"""No bridge is so far ahead, and one is so far [m]."""
_RATED = 240
"""Number of cars of which a small picture is drawn."""
_PLAIN = 0.225
"""Least rate of a place worth a stop; a road alone has an eighth."""

Points = NDArray[np.float64]


def near_trees(scene: Scene, cars: Cars) -> Points:
    """Return how many trunks stand within 14 m of each car, shape (K,)."""
    fixtures = scene.fixtures
    trees = scene.object_class[fixtures.object_id] == ObjectClass.TREE
    trees &= fixtures.pose[:, 2, 2] > _TREE  # shrubs and garden trees are too low
    trunks = fixtures.pose[trees, :2, 3].astype(np.float64)
    apart = np.linalg.norm(cars.position[:, None] - trunks[None], axis=2)
    count: Points = (apart < 14.0).sum(axis=1).astype(np.float64)
    return count


def on_crossings(scene: Scene, cars: Cars) -> Points:
    """Return the number of cars within 30 m of each car that is on a crossing, shape (K,)."""
    network = scene.network
    first = network.junction_first
    score = np.zeros(len(cars.time))
    for index, name in enumerate(network.junctions):
        corners = network.junction_points[first[index] : first[index + 1]]
        if len(corners) >= 3 and network.edge_end.count(name) >= 3:
            inside = shapely.contains_xy(shapely.Polygon(corners), *cars.position.T)
            for car in np.flatnonzero(inside):
                near = np.linalg.norm(cars.position - cars.position[car], axis=1) < 30.0
                score[car] = (near & (cars.time == cars.time[car])).sum()
    return score


def on_open_roads(scene: Scene, cars: Cars) -> Points:
    """Return how far each car is from the next junction, at most 100 m, shape (K,)."""
    network = scene.network
    rings = np.split(network.junction_points, network.junction_first[1:-1])
    # The outlines of some junctions of imported towns cross themselves.
    outlines = [shapely.make_valid(shapely.Polygon(ring)) for ring in rings if len(ring) >= 3]
    shapes = shapely.union_all(outlines)
    away: Points = np.minimum(shapely.distance(shapely.points(cars.position), shapes), 100.0)
    return np.round(away)


def between_towers(scene: Scene, cars: Cars) -> Points:
    """Return the number of towers within 30 m of each car, on the side with fewer, shape (K,)."""
    spots = shapely.points(cars.position)
    sides = np.zeros((2, len(cars.time)))
    for outline, bottom, top in solids(scene.colliders):
        if top - max(bottom, 0.0) > _TALL and bottom < 10.0:
            middle = np.array(outline.centroid.coords[0]) - cars.position
            left = np.cos(cars.yaw) * middle[:, 1] - np.sin(cars.yaw) * middle[:, 0] > 0
            near = shapely.distance(spots, outline) < 30.0
            sides += np.stack([near & left, near & ~left])
    poorer: Points = sides.min(axis=0)
    return poorer


def before_spans(scene: Scene, cars: Cars) -> Points:
    """Return 1 for each car that will soon be under a bridge or in a tunnel, shape (K,)."""
    onwards = np.stack([np.cos(cars.yaw), np.sin(cars.yaw)], axis=1)
    here, there = (cars.position + ahead * onwards for ahead in _SOON)
    soon = np.zeros(len(cars.time), np.bool_)
    already = np.zeros(len(cars.time), np.bool_)
    for outline, bottom, _ in solids(scene.colliders):
        if _SPAN[0] < bottom < _SPAN[1]:
            shapely.prepare(outline)
            soon |= shapely.contains_xy(outline, *there.T)
            already |= shapely.contains_xy(outline, *here.T)
    return (soon & ~already).astype(np.float64)


def beside_most(still: StillScene, cars: Cars) -> Points:
    """Return how much stands around each of some cars, as the drone sees it; shape (K,).

    See `StillScene.sights`.
    """
    rated = np.zeros(len(cars.time))
    pose = POSES[-1]
    some = np.unique(np.linspace(0, len(rated) - 1, min(_RATED, len(rated))).astype(int))
    for car in some.tolist():
        rated[car] = still.sights(drone_view(cars, car, "", "", pose))
    return np.where(rated > _PLAIN, rated, 0.0)


STOPS: tuple[tuple[str, str, Callable[[Scene, Cars], Points]], ...] = (
    ("trees", "beside trees", near_trees),
    ("crossing", "on a crossing", on_crossings),
    ("towers", "between towers", between_towers),
    ("span", "before a bridge or tunnel", before_spans),
)
"""Name, title, and the function that rates cars: higher is better."""

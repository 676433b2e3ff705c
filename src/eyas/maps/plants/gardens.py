"""Ground between buildings: paved feet of walls, paths to doors, hedges, shrubs, small trees."""

from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.world.build.millimetres import length, rounded, unit
from eyas.engine.world.build.placed import Placed
from eyas.lanes import exact
from eyas.maps.build.apart import SpacedPoints
from eyas.maps.plants.shrubs import PIECE

_APRON = 0.9  # Width of the paving at the foot of walls [m]
_PATH = 2.2  # Width of a path to a door [m]
_LONGEST_PATH = 16.0
_DOOR_WALL = 7.0  # Walls shorter than this have no door [m]

_BORDER = 1.85  # Distance of the plants along a wall from it [m]
_PLANTED = 0.45  # Share of the walls with plants along them
_CLIPPED = 0.4  # Share of those walls with a hedge instead of shrubs
_ROOM = 0.9  # Radius of the space that a plant needs [m]

# order: bytes of plans depend on it, which draw an index of it
BORDERS = ("border", "low border", "tall border")  # Kinds of borders of shrubs

Points = NDArray[np.float64]


def paved_yards(
    # Corners of the buildings that stand on the ground, counter-clockwise
    footprints: Sequence[Points],
    pavement: shapely.Geometry,  # Pavements, to which paths lead [m]
    keep_free: shapely.Geometry,  # Roads, pavements, car parks and pools [m]
) -> list[shapely.Geometry]:
    """Return the paving around each building, its own ground included [m]."""
    shapes = np.array([shapely.Polygon(corners) for corners in footprints], object)
    free = shapely.get_parts(keep_free)
    shapely.prepare(free)
    open_land = shapely.STRtree(free)
    # Yards and paths of buildings farther apart than this cannot meet.
    reach = shapely.buffer(shapely.envelope(shapes), 2 * _LONGEST_PATH, join_style="mitre")
    within = shapely.STRtree(reach)
    made: list[shapely.Geometry] = []
    done: list[shapely.Geometry] = []
    for index, (corners, shape) in enumerate(zip(footprints, shapes, strict=True)):
        near = np.sort(within.query(reach[index]))
        others = list(shapes[near[near != index]])
        paths = sorted(_paths(corners, pavement, others), key=lambda path: float(path.area))
        yard = shapely.union_all([shapely.buffer(shape, _APRON, join_style="mitre"), *paths[:2]])
        kept = [free[k] for k in np.sort(open_land.query(yard))]
        kept += others + [done[k] for k in near[near < index]]
        taken = [part for part in kept if shapely.intersects(part, yard)]
        yard = shapely.difference(yard, shapely.union_all(taken))
        done.append(yard)
        made.append(shapely.simplify(yard, 0.02))
    return made


def _paths(
    corners: Points, pavement: shapely.Geometry, others: Sequence[shapely.Geometry]
) -> Iterator[shapely.Polygon]:
    """Yield straight paths from the middle of walls to a pavement, where nothing is in the way."""
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if length(end - start) < _DOOR_WALL:
            continue
        along = unit(end - start)
        outwards = np.array([along[1], -along[0]])
        door = (start + end) / 2
        ray = shapely.LineString([door, door + _LONGEST_PATH * outwards])
        hit = shapely.intersection(ray, pavement)
        if not hit.is_empty and not shapely.intersects(ray, others).any():
            reach = shapely.distance(shapely.Point(door), hit) + 0.3
            side = _PATH / 2 * along
            far = door + reach * outwards
            yield shapely.Polygon([door - side, far - side, far + side, door + side])


def borders(
    footprints: Sequence[Points],  # Corners of buildings, counter-clockwise [m]
    room: shapely.Geometry,  # Lawn on which plants may stand [m]
    floor: float,  # z of the lawn [m]
    rng: np.random.Generator,
) -> list[Placed]:
    """Return hedges and shrubs along walls."""
    free = shapely.buffer(room, -_ROOM / 2)
    shapely.prepare(free)
    made: list[Placed] = []
    for corners in footprints:
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            if length(end - start) < 5.0 or rng.random() > _PLANTED:
                continue
            along = unit(end - start)
            line = np.stack([start, end]) + _BORDER * np.array([along[1], -along[0]])
            made += row(("hedge",) if rng.random() < _CLIPPED else BORDERS, line, free, floor, rng)
    return made


def row(
    plants: Sequence[str],  # Kinds; one is chosen for each piece
    line: Points,  # Both ends [m], shape (2, 2)
    room: shapely.Geometry,  # Area in which pieces must lie [m]
    floor: float,  # z of the lawn [m]
    rng: np.random.Generator,
) -> list[Placed]:
    """Return pieces of hedge or border along a line where there is room."""
    whole, along = length(line[1] - line[0]), unit(line[1] - line[0])
    turn = float(exact.atan2(along[1], along[0]))
    step = whole / max(round(whole / PIECE), 1)
    made = []
    for at in np.arange(step / 2, whole, step):
        middle = line[0] + at * along
        ends = middle + np.outer([-0.5, 0.5], PIECE * along)
        if shapely.contains(room, shapely.LineString(ends)):
            plant = plants[int(rng.integers(len(plants)))]
            way = turn + np.pi * float(rng.integers(2))
            size = rng.uniform(0.97, 1.06)
            made.append(Placed(plant, float(middle[0]), float(middle[1]), floor, way, size))
    return made


def scattered(
    room: shapely.Geometry,  # The shape [m]
    apart: float,  # Least distance between two points [m]
    density: float,
    rng: np.random.Generator,
) -> Points:
    """Return points within a shape.

    Returns:
        Shape (K, 2) [m].
    """
    chosen = SpacedPoints(apart)
    for part in shapely.get_parts(room):
        if part.is_empty:
            continue
        west, south, east, north = part.bounds
        tries = rng.poisson(density * (east - west) * (north - south))
        points = rng.uniform((west, south), (east, north), (tries, 2))
        for x, y in points[shapely.contains_xy(part, points)].tolist():
            chosen.add(x, y)
    return np.array(chosen.points, np.float64).reshape(-1, 2)


def sown(
    spots: Points,  # Places [m], shape (K, 2)
    kinds: Sequence[str],  # Kinds; one is chosen for each place
    sizes: tuple[float, float],  # Least and largest scale
    z: float | Points,  # Height of their feet [m], one or shape (K,)
    rng: np.random.Generator,
) -> list[Placed]:
    """Return a copy of one of some kinds at each place, turned at random."""
    spots, feet = rounded(spots), rounded(np.broadcast_to(np.asarray(z, np.float64), len(spots)))
    which = rng.integers(len(kinds), size=len(spots)).tolist()
    turns = np.round(rng.uniform(0.0, 2 * np.pi, len(spots)), 3).tolist()
    scales = np.round(rng.uniform(*sizes, len(spots)), 3).tolist()
    rows = zip(spots.tolist(), feet.tolist(), which, turns, scales, strict=True)
    return [Placed(kinds[k], x, y, foot, turn, size) for (x, y), foot, k, turn, size in rows]


def clustered(
    centres: Points,  # Centres of the groups [m], shape (C, 2)
    spread: float,  # Standard deviation about the centres [m]
    count: tuple[int, int],  # Least and largest number in a group
    room: shapely.Geometry,  # Area within which the points must lie [m]
    rng: np.random.Generator,
) -> Points:
    """Return points in groups, shape (K, 2) [m]."""
    groups = [c + exact.normal(rng, 0, spread, (int(rng.integers(*count)), 2)) for c in centres]
    points = np.concatenate([np.zeros((0, 2)), *groups])
    return np.asarray(points[shapely.contains_xy(room, points)], np.float64)


def small_trees(
    places: Points,  # Positions of the trunks, shape (K, 2) [m]
    heights: tuple[float, float],  # Least and largest height [m]
    floor: float,  # z of the ground [m]
    kinds: Sequence[str],  # Kinds; one is chosen for each tree
    rng: np.random.Generator,
) -> list[Placed]:
    """Return trees of random heights and kinds."""
    made = []
    for x, y in places.tolist():
        height, turn = float(rng.uniform(*heights)), float(rng.uniform(0, 2 * np.pi))
        kind = kinds[int(rng.integers(len(kinds)))]
        made.append(Placed(kind, x, y, floor, turn, height))
    return made

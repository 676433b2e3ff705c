"""Places worth a look: cars rated by where they are, and views from afar."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.targets.vehicles.pose import VEHICLE_AHEAD
from eyas.engine.task.spawn import StartValues, start_pose
from eyas.maps.gallery.still import StillScene, Viewpoint, is_inside, solids

CAMERA = 0.7854  # Horizontal field of view of the drone's camera [rad]
POSES = ((22.0, 1.37, "down"), (15.0, 0.6, "ahead"))
"""Height [m], pitch [rad] and name of the drone's starts."""

_TIMES = (60.0, 20.0)  # First time at which cars are looked for, and the step to the next [s]
_TRIES = 40  # Number of cars tried for each stop

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Cars:
    """K cars, each at one time."""

    time: Points  # [s], shape (K,)
    actor: NDArray[np.int64]  # Shape (K,)
    position: Points  # [m], shape (K, 2)
    yaw: Points  # [rad], shape (K,)


def all_cars(still: StillScene) -> Cars:
    """Return every car that is on the map at one of the times."""
    rows: list[tuple[float, int, float, float, float]] = []
    for time in np.arange(_TIMES[0], still.duration, _TIMES[1]):
        actors = still.actors(time)
        for actor in np.flatnonzero(actors.present[0]):
            x, y, _ = actors.position[0, actor]
            rows.append((time, int(actor), x, y, actors.yaw[0, actor]))
    table = np.array(rows, np.float64).reshape(-1, 5)
    return Cars(table[:, 0], table[:, 1].astype(np.int64), table[:, 2:4], table[:, 4])


def stop(
    still: StillScene, cars: Cars, name: str, where: str, score: Points
) -> Iterator[Viewpoint]:
    """Yield the drone's views at its starts, of the best car that is visible in all of them."""
    order = np.argsort(-score, kind="stable")[:_TRIES]
    for car in order[score[order] > 0]:
        views = [drone_view(cars, int(car), name, where, pose) for pose in POSES]
        if all(_in_sight(still, view) for view in views):
            yield from views
            return


def _in_sight(still: StillScene, view: Viewpoint) -> bool:
    depth, seen = still.probe(view)
    near = is_inside(still.scene.colliders, view.position) or float(depth.min()) < 4.0
    return seen > 0.7 and not near


def drone_view(
    cars: Cars, car: int, name: str, where: str, pose: tuple[float, float, str]
) -> Viewpoint:
    """Return the view of a car by a drone at one of its starts."""
    height, pitch, kind = pose
    start, spot = StartValues(pitch, height, 0.0, 0.0, 0.0), [*cars.position[car], 0.0]
    position, yaw = start_pose(start, spot, float(cars.yaw[car]), VEHICLE_AHEAD)
    time = float(cars.time[car])
    return Viewpoint(
        name=f"{name}-{kind}",
        title=f"Drone, {height:g} m, {where}",
        caption=f"As the drone sees it: {height:g} m high, camera {pitch:g} rad down, at "
        f"{time:g} s of the traffic; in the middle a car {where}.",
        time=time,
        position=(float(position[0]), float(position[1]), float(position[2])),
        yaw=yaw,
        pitch=pitch,
        field_of_view=CAMERA,
        actor=int(cars.actor[car]),
    )


_TREE = 12.0  # Height of a street tree, whose mesh is 1 m high [m]
_TALL = 30.0  # Height of a tower [m]
_SPAN = (4.0, 14.0)  # Heights of the underside of a bridge [m]
_SOON = (4.0, 9.0)  # No bridge is so far ahead, and one is so far [m]
_RATED = 240  # Number of cars of which a small picture is drawn
_PLAIN = 0.225  # Least rate of a place worth a stop; a road alone has an eighth


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


_WIDE = 1.2  # Field of view of the horizon view; the drone camera's would end at the horizon [rad]
_BROAD = 700.0  # Distance from the middle to the farthest street of a wide map [m]
_BEHIND, _OVER = 90.0, 120
"""Distance from a car to the overview behind it [m], and the number of cars that are tried."""
_RING, _LIT = 24, 9  # Number of views around the streets, and of those on the lit side
_ALONG = (26.0, 21.0, 0.36)
"""Distance from a drone back to the view along its road [m], height [m] and pitch [rad]."""


def overview(still: StillScene, side: float, cars: Cars) -> Viewpoint:
    """Return a view of a part of the map from 60 m.

    It is one on a ring around the streets, behind which the sun stands, or over a road of wide
    maps, whose rings show little: the one without a wall in front in which most stands.

    Args:
        side: Direction to the sun [rad].
        cars: Cars on the roads.
    """
    centre, reach = _streets(still.scene)
    if reach > _BROAD:
        some = np.linspace(0, len(cars.time) - 1, _OVER).astype(int)
        views = [_over(cars.position[car], float(cars.yaw[car])) for car in some.tolist()]
        return max(views, key=still.sights)
    ring = []
    for turn in range(_RING):
        # From the lit side away, left and right.
        angle = side + (turn + 1) // 2 * (-1) ** turn * math.tau / _RING
        out = reach * np.array([math.cos(angle), math.sin(angle)])
        ring.append(_from(centre + out, angle + math.pi, 0.25))
    free = [view for view in ring if not is_inside(still.scene.colliders, view.position)] or ring
    depths = {view: still.probe(view)[0] for view in free}
    far = [v for v in free if np.median(depths[v]) > 100.0 and np.quantile(depths[v], 0.1) > 70.0]
    if not far:
        return max(free, key=lambda view: float(np.median(depths[view])))
    lit = [view for view in far if view in ring[:_LIT]]
    return max(lit, key=still.sights) if lit else far[0]


def along(still: StillScene, drone: Viewpoint) -> list[Viewpoint]:
    """Return a view along the road from behind a drone, or none if something is in the way."""
    back, height, pitch = _ALONG
    onwards = np.array([math.cos(drone.yaw), math.sin(drone.yaw)])
    view = replace(
        drone,
        name=f"{drone.name.split('-')[0]}-along",
        title="The same place from farther away",
        caption=f"From {height:g} m, {pitch:g} rad down, at {drone.time:g} s of the traffic.",
        position=_at(np.array(drone.position[:2]) - back * onwards, height),
        pitch=pitch,
        actor=-1,
    )
    depth, _ = still.probe(view)
    blocked = is_inside(still.scene.colliders, view.position) or depth.min() < 8.0
    return [] if blocked or np.median(depth) < 25.0 else [view]


def _over(place: Points, yaw: float) -> Viewpoint:
    back = _BEHIND * np.array([math.cos(yaw), math.sin(yaw)])
    return _from(place - back, yaw, 0.5)


def _from(place: Points, yaw: float, pitch: float) -> Viewpoint:
    height = 60.0
    return Viewpoint(
        name="overview",
        title=f"Overview, {height:g} m",
        caption=f"Into the map from {height:g} m, {pitch:g} rad down, at 300 s of the traffic.",
        time=300.0,
        position=_at(place, height),
        yaw=yaw,
        pitch=pitch,
        field_of_view=CAMERA,
    )


def horizon(scene: Scene, side: float) -> Viewpoint:
    """Return a view from outside that shows all streets."""
    pitch = 0.3
    centre, reach = _streets(scene)
    away = reach / math.sin(0.5 * _WIDE)
    out = away * np.array([math.cos(side), math.sin(side)])
    height = away * math.tan(pitch)
    return Viewpoint(
        name="horizon",
        title="The whole map, to the horizon",
        caption=f"All streets from {height:.0f} m, {away:.0f} m from their middle, {pitch:g} rad "
        f"down, {_WIDE:g} rad wide, at 300 s of the traffic.",
        time=300.0,
        position=_at(centre + out, height),
        yaw=side + math.pi,
        pitch=pitch,
        field_of_view=_WIDE,
    )


def _streets(scene: Scene) -> tuple[Points, float]:
    """Return the middle of all streets [m], shape (2,), and the distance to their farthest [m]."""
    points = scene.network.lane_points
    centre: Points = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return centre, float(np.linalg.norm(points - centre, axis=1).max())


def _at(plan: Points, height: float) -> tuple[float, float, float]:
    return float(plan[0]), float(plan[1]), height

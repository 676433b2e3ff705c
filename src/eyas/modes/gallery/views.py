"""The viewpoints of the gallery: chosen from the map and its traffic, the same ones every time."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.modes.gallery.still import StillScene, Viewpoint
from eyas.state.scene import Colliders, ObjectClass, Scene
from eyas.targets.vehicles.models import VEHICLE_AHEAD
from eyas.task.spawn import Start, start_pose

__all__ = ["choose_viewpoints"]

_CAMERA = 0.7854
"""Horizontal field of view of the drone's camera [rad]."""
_WIDE = 1.2
"""Field of view of the horizon view; the drone camera's would end at the horizon [rad]."""
_POSES = ((22.0, 1.37, "down"), (15.0, 0.6, "ahead"))
"""Height [m], pitch [rad] and name of the drone's starts."""
_TIMES = (60.0, 20.0)
"""First time at which cars are looked for, and the step to the next [s]."""
_TRIES = 40
"""Number of cars tried for each stop."""
_TREE = 12.0
"""Height of a street tree, whose mesh is 1 m high [m]."""
_TALL = 30.0
"""Height of a tower [m]."""

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class _Cars:
    """K cars, each at one time."""

    time: Points
    """[s], shape (K,)."""
    actor: NDArray[np.int64]
    """Shape (K,)."""
    position: Points
    """[m], shape (K, 2)."""
    yaw: Points
    """[rad], shape (K,)."""


def choose_viewpoints(still: StillScene, sun: tuple[float, float, float]) -> list[Viewpoint]:
    """Return the viewpoints of a map, without those for which it has no suitable place.

    Args:
        still: The world.
        sun: Direction to the sun; distant views have it behind the camera, so that walls are lit.
    """
    cars = _all_cars(still)
    chosen: list[Viewpoint] = []
    for name, where, score in _STOPS:
        chosen += _stop(still, cars, name, where, score(still.scene, cars))
    if len(chosen) < 2 * len(_POSES):
        chosen += _stop(still, cars, "road", "on an open road", _on_open_roads(still.scene, cars))
    side = math.atan2(sun[1], sun[0]) + math.radians(15.0)
    chosen += [_overview(still, side), _horizon(still.scene, side)]
    first = chosen[0]
    small = replace(
        first,
        name="observation",
        title="84 x 84 pixels, enlarged",
        caption=f"{first.caption} As the 84 x 84 observation: 4:3 squeezed into a square, one "
        "sample a pixel, each pixel shown as 4 x 4.",
        size=(84, 84),
        samples=1,
        enlarged=4,
    )
    return [*chosen, small]


def _all_cars(still: StillScene) -> _Cars:
    """Return every car that is on the map at one of the times."""
    rows: list[tuple[float, int, float, float, float]] = []
    for time in np.arange(_TIMES[0], still.duration, _TIMES[1]):
        actors = still.actors(time)
        for actor in np.flatnonzero(actors.present[0]):
            x, y, _ = actors.position[0, actor]
            rows.append((time, int(actor), x, y, actors.yaw[0, actor]))
    table = np.array(rows, np.float64).reshape(-1, 5)
    return _Cars(table[:, 0], table[:, 1].astype(np.int64), table[:, 2:4], table[:, 4])


def _stop(
    still: StillScene, cars: _Cars, name: str, where: str, score: Points
) -> Iterator[Viewpoint]:
    """Yield the drone's views at its starts, of the best car that is visible in all of them."""
    order = np.argsort(-score, kind="stable")[:_TRIES]
    for car in order[score[order] > 0]:
        views = [_drone_view(cars, int(car), name, where, pose) for pose in _POSES]
        if all(_in_sight(still, view) for view in views):
            yield from views
            return


def _in_sight(still: StillScene, view: Viewpoint) -> bool:
    depth, seen = still.probe(view)
    near = _is_inside(still.scene.colliders, view.position) or float(depth.min()) < 4.0
    return seen > 0.7 and not near


def _drone_view(
    cars: _Cars, car: int, name: str, where: str, pose: tuple[float, float, str]
) -> Viewpoint:
    height, pitch, kind = pose
    start, spot = Start(pitch, height, 0.0, 0.0, 0.0), [*cars.position[car], 0.0]
    position, yaw = start_pose(start, spot, float(cars.yaw[car]), VEHICLE_AHEAD)
    time = float(cars.time[car])
    return Viewpoint(
        name=f"{name}-{kind}",
        title=f"Drone, {height:g} m, {where}",
        caption=f"As the drone sees it: {height:g} m high, camera {pitch:g} rad down, at "
        f"{time:g} s of the traffic; in the middle a car {where}.",
        time=time,
        position=_at(position[:2], float(position[2])),
        yaw=yaw,
        pitch=pitch,
        field_of_view=_CAMERA,
        actor=int(cars.actor[car]),
    )


def _near_trees(scene: Scene, cars: _Cars) -> Points:
    """Return how many trunks stand within 14 m of each car, shape (K,)."""
    fixtures = scene.fixtures
    trees = scene.object_class[fixtures.object_id] == ObjectClass.TREE
    trees &= fixtures.pose[:, 2, 2] > _TREE  # shrubs and garden trees are too low
    trunks = fixtures.pose[trees, :2, 3].astype(np.float64)
    apart = np.linalg.norm(cars.position[:, None] - trunks[None], axis=2)
    count: Points = (apart < 14.0).sum(axis=1).astype(np.float64)
    return count


def _on_crossings(scene: Scene, cars: _Cars) -> Points:
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


def _on_open_roads(scene: Scene, cars: _Cars) -> Points:
    """Return how far each car is from the next junction, at most 100 m, shape (K,)."""
    network = scene.network
    rings = np.split(network.junction_points, network.junction_first[1:-1])
    shapes = shapely.union_all([shapely.Polygon(ring) for ring in rings if len(ring) >= 3])
    away: Points = np.minimum(shapely.distance(shapely.points(cars.position), shapes), 100.0)
    return np.round(away)


def _between_towers(scene: Scene, cars: _Cars) -> Points:
    """Return the number of towers within 30 m of each car, on the side with fewer, shape (K,)."""
    spots = shapely.points(cars.position)
    sides = np.zeros((2, len(cars.time)))
    for outline, bottom, top in _solids(scene.colliders):
        if top - max(bottom, 0.0) > _TALL and bottom < 10.0:
            middle = np.array(outline.centroid.coords[0]) - cars.position
            left = np.cos(cars.yaw) * middle[:, 1] - np.sin(cars.yaw) * middle[:, 0] > 0
            near = shapely.distance(spots, outline) < 30.0
            sides += np.stack([near & left, near & ~left])
    poorer: Points = sides.min(axis=0)
    return poorer


_STOPS: tuple[tuple[str, str, Callable[[Scene, _Cars], Points]], ...] = (
    ("trees", "beside trees", _near_trees),
    ("crossing", "on a crossing", _on_crossings),
    ("towers", "between towers", _between_towers),
)
"""Name, title, and the function that rates cars: higher is better, 0 is unsuitable."""


def _solids(colliders: Colliders) -> Iterator[tuple[shapely.Polygon, float, float]]:
    """Yield outline, bottom and top of each solid prism [m]."""
    first = colliders.prism_first
    for index, bottom in enumerate(colliders.prism_bottom):
        corners = colliders.prism_points[first[index] : first[index + 1]]
        yield shapely.Polygon(corners), float(bottom), float(colliders.prism_top[index])


def _overview(still: StillScene, side: float) -> Viewpoint:
    """Return the first view on a ring at 60 m height that no wall blocks, else the farthest."""
    height, pitch = 60.0, 0.25
    centre, reach = _streets(still.scene)
    best, farthest = None, -1.0
    for turn in range(24):
        # Start at the lit side and move away step by step, left and right.
        angle = side + (turn + 1) // 2 * (-1) ** turn * math.tau / 24
        out = reach * np.array([math.cos(angle), math.sin(angle)])
        view = Viewpoint(
            name="overview",
            title=f"Overview, {height:g} m",
            caption=f"Into the map from {height:g} m, {pitch:g} rad down, at 300 s of the traffic.",
            time=300.0,
            position=_at(centre + out, height),
            yaw=angle + math.pi,
            pitch=pitch,
            field_of_view=_CAMERA,
        )
        depth, _ = still.probe(view)
        median = float(np.median(depth))
        if not _is_inside(still.scene.colliders, view.position):
            if median > 100.0 and float(np.quantile(depth, 0.1)) > 70.0:
                return view
            if median > farthest:
                best, farthest = view, median
    return best or view


def _horizon(scene: Scene, side: float) -> Viewpoint:
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


def _is_inside(colliders: Colliders, position: tuple[float, float, float]) -> bool:
    x, y, z = position
    return any(
        bottom <= z <= top and bool(shapely.contains_xy(outline, x, y))
        for outline, bottom, top in _solids(colliders)
    )

"""Views from afar: into the map, over it, and of all of it."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.scene import Scene
from eyas.maps.gallery.places import CAMERA, Cars
from eyas.maps.gallery.still import StillScene, Viewpoint, is_inside

__all__ = ["along", "horizon", "overview"]

_WIDE = 1.2  # Field of view of the horizon view; the drone camera's would end at the horizon [rad]
_BROAD = 700.0  # Distance from the middle to the farthest street of a wide map [m]
_BEHIND, _OVER = 90.0, 120
"""From a car to the overview behind it [m], and the number of cars that are tried."""
_RING, _LIT = 24, 9  # Number of views around the streets, and of those on the lit side
_ALONG = (26.0, 21.0, 0.36)
"""From a drone back to the view along its road [m], height [m] and pitch [rad]."""

Points = NDArray[np.float64]


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

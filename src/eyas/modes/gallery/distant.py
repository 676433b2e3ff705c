"""Views from afar: into the map, over it, and of all of it."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.modes.gallery.solids import is_inside
from eyas.modes.gallery.still import StillScene, Viewpoint
from eyas.modes.gallery.stops import CAMERA
from eyas.state.scene import Scene

__all__ = ["horizon", "overview", "streets"]

_WIDE = 1.2
"""Field of view of the horizon view; the drone camera's would end at the horizon [rad]."""
_BROAD = 700.0
"""Distance from the middle to the farthest street of a wide map [m]."""
_BEHIND = 70.0
"""From a drone to the overview behind it [m]."""

Points = NDArray[np.float64]


def overview(still: StillScene, side: float, above: Viewpoint) -> Viewpoint:
    """Return a view of a part of the map from 60 m.

    It is the first one on a ring around the streets that no wall blocks, else the farthest; on
    wide maps, of which that would show little, it is one along a road.

    Args:
        still: The world.
        side: Where to begin on the ring [rad].
        above: View of the road.
    """
    height, pitch = 60.0, 0.25
    centre, reach = streets(still.scene)
    if reach > _BROAD:
        back = _BEHIND * np.array([math.cos(above.yaw), math.sin(above.yaw)])
        return _from(np.array(above.position[:2]) - back, height, above.yaw, 2 * pitch)
    best, farthest = None, -1.0
    for turn in range(24):
        # Start at the lit side and move away step by step, left and right.
        angle = side + (turn + 1) // 2 * (-1) ** turn * math.tau / 24
        out = reach * np.array([math.cos(angle), math.sin(angle)])
        view = _from(centre + out, height, angle + math.pi, pitch)
        depth, _ = still.probe(view)
        median = float(np.median(depth))
        if not is_inside(still.scene.colliders, view.position):
            if median > 100.0 and float(np.quantile(depth, 0.1)) > 70.0:
                return view
            if median > farthest:
                best, farthest = view, median
    return best or view


def _from(place: Points, height: float, yaw: float, pitch: float) -> Viewpoint:
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
    centre, reach = streets(scene)
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


def streets(scene: Scene) -> tuple[Points, float]:
    """Return the middle of all streets [m], shape (2,), and the distance to their farthest [m]."""
    points = scene.network.lane_points
    centre: Points = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return centre, float(np.linalg.norm(points - centre, axis=1).max())


def _at(plan: Points, height: float) -> tuple[float, float, float]:
    return float(plan[0]), float(plan[1]), height

"""Traffic lights: a pole at the kerb with an arm over the lanes.

They are decoration. All shine amber, as signals do that leave drivers to give way to each other:
so cars drive here, and a fixed red or green would show cars running red lights in every film.
"""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.mesh.assembly import concatenate
from eyas.mesh.solids import box, tube
from eyas.state.mesh import Material, Mesh, Surface
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import material
from eyas.world.build.millimetres import unit
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.roads.areas import joints, road_area, streets

__all__ = ["POLE_HEIGHT", "POLE_RADIUS", "add_signals", "signal_levels", "signal_places"]

POLE_HEIGHT = 6.6
"""Height of the top of a pole above the road [m]."""

POLE_RADIUS = 0.13
"""Radius at the foot [m]."""

_ARM = 5.6
_ARM_HEIGHT = 6.1
_HEADS = (2.6, 5.3)
"""Distances of the heads along the arm [m]."""
_BEYOND_KERB = 0.9
_BEFORE_LINE = 0.6
"""From the stop line back to the pole [m]."""
_STEEL = material("plain", (0.55, 0.56, 0.57))
_CASE = material("plain", (0.13, 0.14, 0.14))
_LENSES = (
    material("plain", (0.34, 0.09, 0.08)),
    Material(tint=(1.0, 0.55, 0.06), surface=Surface.SIGNAL, emission=1.9),
    material("plain", (0.08, 0.26, 0.16)),
)


def signal_places(network: RoadNetwork) -> list[tuple[NDArray[np.float64], float]]:
    """Return the foot [m] and the direction of the arm [rad] of the pole at each stop line."""
    meeting = joints(network)
    road = road_area(network)
    places = []
    for street in streets(network):
        if meeting[street.end] < 3:
            continue
        onwards = unit(street.right[-1] - street.right[-2])
        leftwards = np.array([-onwards[1], onwards[0]])
        foot = street.right[-1] - _BEYOND_KERB * leftwards - _BEFORE_LINE * onwards
        if shapely.distance(road, shapely.Point(foot)) > POLE_RADIUS:
            places.append((foot, float(np.arctan2(leftwards[1], leftwards[0]))))
    return places


def add_signals(builder: SceneBuilder, network: RoadNetwork) -> None:
    """Add a pole with an arm over the lanes on each road into each junction."""
    prototype = builder.prototype("traffic light", signal_levels)
    for place, turn in signal_places(network):
        owner = builder.add_copy(ObjectClass.POLE, prototype, (*place, 0.0), turn, 1.0)
        builder.add_cylinder((place[0], place[1]), POLE_RADIUS, FLOOR_HEIGHT, POLE_HEIGHT, owner)


def signal_levels() -> tuple[Mesh, ...]:
    """Return a traffic light, the finest level of detail first.

    The foot is at the origin, the arm along x; the lights face along y.
    """
    heads = [_head((x, 0.16, _ARM_HEIGHT - 0.35)) for x in _HEADS]
    low = _head((0.0, 0.24, 3.1))
    return concatenate([_steel(8), *heads, low]), concatenate([_steel(3), *heads])


def _steel(sides: int) -> Mesh:
    pole = np.array([[0, 0, -0.15], [0, 0, 3.0], [0, 0, POLE_HEIGHT]])
    arm = np.array([[0, 0, _ARM_HEIGHT], [_ARM, 0, _ARM_HEIGHT + 0.25]])
    return concatenate(
        [
            tube(pole, [POLE_RADIUS, 0.1, 0.08], sides, _STEEL),
            tube(arm, [0.07, 0.05], sides, _STEEL),
            box((0.3, 0.3, 0.12), (0, 0, POLE_HEIGHT), _STEEL, 1.0),
        ]
    )


def _head(centre: tuple[float, float, float]) -> Mesh:
    x, y, z = centre
    parts = [box((0.36, 0.22, 1.05), centre, _CASE, 1.0)]
    for lens, rise in zip(_LENSES, (0.33, 0.0, -0.33), strict=True):
        parts.append(box((0.24, 0.04, 0.24), (x, y + 0.12, z + rise), lens, 1.0))
    return concatenate(parts)

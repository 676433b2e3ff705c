"""Traffic lights: a pole at the kerb with an arm over the lanes.

Where a network has programs for them (imported towns), their lenses are dark here, and
`eyas.engine.sim.views.additions` draws the one that shines. Elsewhere they are decoration and shine
amber, as signals do that leave drivers to give way to each other: so cars drive there, and a fixed
red or green would show cars running red lights in every film. If they are to work there
(`traffic.signals`), what is drawn over them hides the amber.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.solids import box, tube
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.placed import Placed
from eyas.lanes import exact

if TYPE_CHECKING:
    from eyas.engine.world.roads.areas import Street

POLE_HEIGHT = 6.6  # Height of the top of a pole above the road [m]
POLE_RADIUS = 0.13  # Radius at the foot [m]
_ARM = 5.6  # Length of the arm over the road [m]
_ARM_HEIGHT = 6.1  # Height of the arm [m]
_HEADS = (2.6, 5.3)  # Distances of the heads along the arm [m]
_CENTRES = (*((x, 0.16, _ARM_HEIGHT - 0.35) for x in _HEADS), (0.0, 0.24, 3.1))
"""Middles of the heads; the last is on the pole [m]."""
_BEYOND_KERB = 0.9  # Distance of the pole from the kerb [m]
_BEFORE_LINE = 0.6  # Distance of the pole before the stop line [m]
_STEEL = material("plain", (0.55, 0.56, 0.57))
_CASE = material("plain", (0.13, 0.14, 0.14))
_DARK = (
    material("plain", (0.34, 0.09, 0.08)),
    material("plain", (0.36, 0.26, 0.08)),
    material("plain", (0.08, 0.26, 0.16)),
)
_SHINING = tuple(
    Material(tint=tint, surface=Surface.SIGNAL, emission=1.9)
    for tint in ((1.0, 0.10, 0.06), (1.0, 0.55, 0.06), (0.10, 0.95, 0.45))
)
_RISES = (0.33, 0.0, -0.33)
"""Heights of the red, amber and green lens over the middle of a head [m]."""
_RED, _AMBER, _GREEN = range(3)  # Lenses from the top down
_ASPECTS = ((_RED,), (_RED, _AMBER), (_AMBER,), (_GREEN,))
"""Lenses that shine, by `eyas.engine.traffic.signals.Aspect`."""


def signal_places(network: RoadNetwork) -> list[tuple[NDArray[np.float64], float]]:
    """Return the foot [m] and the direction of the arm [rad] of the pole at each stop line."""
    # Each start draws lenses, but places none, and shapely takes long to import.
    import shapely

    from eyas.engine.world.roads.areas import joints, road_area, streets

    meeting = joints(network)
    road = road_area(network)
    places = []
    for street in streets(network):
        if meeting[street.end] < 3:
            continue
        foot, turn = pole_at(street)
        if shapely.distance(road, shapely.Point(foot)) > POLE_RADIUS:
            places.append((np.array(foot), turn))
    return places


def pole_at(street: "Street") -> tuple[tuple[float, float], float]:
    """Return the foot [m] of the pole at the end of a street and the direction of its arm [rad]."""
    from eyas.engine.world.build.millimetres import unit

    onwards = unit(street.right[-1] - street.right[-2])
    inwards = street.inwards(onwards)
    foot = street.right[-1] - _BEYOND_KERB * inwards - _BEFORE_LINE * onwards
    return (float(foot[0]), float(foot[1])), float(exact.atan2(inwards[1], inwards[0]))


def signals_along(network: RoadNetwork) -> list[Placed]:
    """Return a traffic light on each road into each junction."""
    return [Placed.at("traffic light", at, 0.0, turn) for at, turn in signal_places(network)]


def signal_levels(*, amber: bool = True) -> tuple[Mesh, ...]:
    """Return a traffic light, the finest level of detail first.

    The foot is at the origin, the arm along x; the lights face along y, and mirrored against it
    where traffic keeps left.
    """
    lenses = (_DARK[_RED], _SHINING[_AMBER] if amber else _DARK[_AMBER], _DARK[_GREEN])
    heads = [_head(centre, lenses) for centre in _CENTRES]
    return concatenate([_steel(8), *heads]), concatenate([_steel(3), *heads[:-1]])


def lens_levels(
    *,
    covers: bool = False,  # Whether they hide amber that shines there and should not
) -> tuple[tuple[Mesh, ...], ...]:
    """Return the lenses that shine, over those of `signal_levels`, for each aspect."""
    levels = []
    for shining in _ASPECTS:
        stuffs = {lens: _SHINING[lens] for lens in shining}
        if covers:
            stuffs.setdefault(_AMBER, _DARK[_AMBER])
        heads = [
            concatenate([_lens(centre, *one) for one in stuffs.items()]) for centre in _CENTRES
        ]
        levels.append((concatenate(heads), concatenate(heads[:-1])))
    return tuple(levels)


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


def _head(centre: tuple[float, float, float], lenses: tuple[Material, ...]) -> Mesh:
    x, y, z = centre
    parts = [box((0.36, 0.22, 1.05), (x, y, z), _CASE, 1.0)]
    for lens, rise in zip(lenses, _RISES, strict=True):
        parts.append(box((0.24, 0.04, 0.24), (x, y + 0.12, z + rise), lens, 1.0))
    return concatenate(parts)


def _lens(centre: tuple[float, float, float], lens: int, stuff: Material) -> Mesh:
    """Return a lens over another, which bulges so that it is seen from above, too."""
    x, y, z = centre
    return box((0.27, 0.16, 0.27), (x, y + 0.19, z + _RISES[lens]), stuff, 1.0)

"""Street furniture: small things such as benches and shelters, and where they stand."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.mesh.solids import box, cylinder, sphere
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.millimetres import unit
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.build.scene_builder import Levels
from eyas.engine.world.roads.areas import streets
from eyas.lanes import exact

BALE_RADIUS, _BALE_LENGTH = 0.75, 1.3  # Size of a bale of hay [m]

_HAY = material("crops_tan", (0.98, 0.9, 0.66))
_JET = material("plain", (0.93, 0.95, 0.97))
_WOOD = material("bark", (0.70, 0.54, 0.42))
_IRON = material("plain", (0.22, 0.23, 0.24))
_STEEL = material("plain", (0.58, 0.60, 0.62))
_GREEN = material("plain", (0.20, 0.34, 0.25))
_RED = material("plain", (0.72, 0.16, 0.12))
_BLUE = material("plain", (0.13, 0.26, 0.50))
_PANE = Material(tint=(0.42, 0.50, 0.52), surface=Surface.GLASS)
_STONE = material("concrete", (0.92, 0.9, 0.88))
_LEAVES = material("foliage", (0.8, 0.9, 0.6))


def _part(
    size: tuple[float, float, float], centre: tuple[float, float, float], cover: Material
) -> Mesh:
    return box(size, centre, cover, 1.0)


def _bench() -> Mesh:
    """Return a seat and a back of slats on two iron feet; a person on it looks along y."""
    seat = [_part((1.8, 0.11, 0.04), (0, y, 0.45), _WOOD) for y in (-0.13, 0.01, 0.15)]
    back = [_part((1.8, 0.04, 0.1), (0, -0.24, z), _WOOD) for z in (0.62, 0.78)]
    feet = [_part((0.06, 0.45, 0.43), (x, 0, 0.21), _IRON) for x in (-0.75, 0.75)]
    arms = [_part((0.05, 0.05, 0.38), (x, -0.22, 0.60), _IRON) for x in (-0.75, 0.75)]
    return concatenate([*seat, *back, *feet, *arms])


def _bin(sides: int) -> Mesh:
    drum = cylinder((0.24, 0.27), (0.0, 0.82), sides, _GREEN, tile=1.0)
    lid = cylinder((0.29, 0.22), (0.82, 0.96), sides, _IRON, cap=True)
    return concatenate([drum, lid])


def _hydrant(sides: int) -> Mesh:
    return concatenate(
        [
            cylinder((0.16, 0.16), (0.0, 0.06), sides, _RED, cap=True),
            cylinder((0.11, 0.11), (0.06, 0.6), sides, _RED),
            cylinder((0.14, 0.05), (0.6, 0.78), sides, _RED, cap=True),
            _part((0.42, 0.1, 0.1), (0, 0, 0.46), _STEEL),
            _part((0.12, 0.3, 0.12), (0, 0.05, 0.42), _STEEL),
        ]
    )


def _shelter() -> Mesh:
    """Return a bus shelter: posts, glass behind and at one side, a roof, a bench, a poster."""
    posts = [
        _part((0.08, 0.08, 2.35), (x, y, 1.17), _IRON)
        for x in (-1.9, 0.0, 1.9)
        for y in (-0.55, 0.5)
        if x or y < 0
    ]
    panes = [_part((1.8, 0.03, 1.9), (x, -0.55, 1.25), _PANE) for x in (-0.95, 0.95)]
    side = _part((0.03, 0.95, 1.9), (1.9, -0.03, 1.25), _PANE)
    poster = _part((0.14, 0.9, 1.8), (-1.9, -0.03, 1.2), _STONE)
    roof = _part((4.2, 1.6, 0.1), (0, 0, 2.4), _STEEL)
    edge = _part((4.3, 0.06, 0.2), (0, 0.8, 2.4), _IRON)
    seat = _part((2.4, 0.4, 0.05), (0.4, -0.28, 0.47), _WOOD)
    return concatenate([*posts, *panes, side, poster, roof, edge, seat])


def _far_shelter() -> Mesh:
    roof = _part((4.2, 1.6, 0.1), (0, 0, 2.4), _STEEL)
    return concatenate([roof, _part((3.8, 0.08, 2.35), (0, -0.55, 1.17), _PANE)])


def _post_box() -> Mesh:
    legs = [_part((0.06, 0.36, 0.3), (x, 0, 0.15), _IRON) for x in (-0.2, 0.2)]
    body = _part((0.5, 0.45, 0.9), (0, 0, 0.75), _BLUE)
    return concatenate([*legs, body, _part((0.5, 0.3, 0.14), (0, 0.02, 1.25), _BLUE)])


def _tub(sides: int, subdivisions: int) -> Mesh:
    """Return a round concrete tub with a clipped bush."""
    tub = cylinder((0.5, 0.62), (0.0, 0.6), sides, _STONE, cap=True, tile=3.0)
    ball = sphere(subdivisions, _LEAVES)
    pose = np.array([[0.55, 0, 0, 0], [0, 0.55, 0, 0], [0, 0, 0.55, 0.95]])
    return concatenate([tub, transformed(ball, pose)])


# order: bytes of plans depend on it, whose library lists these names in turn
FURNITURE: dict[str, Callable[[], Levels]] = {
    "bench": lambda: (_bench(), _part((1.8, 0.5, 0.45), (0, 0, 0.22), _WOOD)),
    "bin": lambda: (_bin(10), _bin(4)),
    "hydrant": lambda: (_hydrant(8), _part((0.24, 0.24, 0.75), (0, 0, 0.37), _RED)),
    "shelter": lambda: (_shelter(), _far_shelter()),
    "post_box": lambda: (_post_box(), _part((0.5, 0.45, 1.3), (0, 0, 0.65), _BLUE)),
    "tub": lambda: (_tub(10, 1), _tub(5, 0)),
}
"""Maker of each kind."""


def fountain_levels() -> Levels:
    """Return a fountain of two bowls, with a jet of water."""
    return _fountain(20), _fountain(8)


def _fountain(sides: int) -> Mesh:
    stone = material("stone", (0.9, 0.88, 0.84))
    return concatenate(
        [
            cylinder((0.9, 0.6), (-0.1, 2.2), sides, stone),
            cylinder((1.0, 3.0), (1.5, 2.3), sides, stone, cap=True),
            cylinder((0.35, 0.3), (2.3, 3.6), sides, stone),
            cylinder((0.5, 1.5), (3.2, 3.7), sides, stone, cap=True),
            cylinder((0.12, 0.03), (3.7, 6.2), 6, _JET),
        ]
    )


def bale_levels() -> Levels:
    """Return a round bale of hay that lies along x."""
    return tuple(_lying(sides) for sides in (14, 7))


def _lying(sides: int) -> Mesh:
    half = _BALE_LENGTH / 2
    drum = cylinder((BALE_RADIUS, BALE_RADIUS), (-half, half), sides, _HAY, cap=True, tile=1.6)
    onto_side = np.array(
        [[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, BALE_RADIUS]]
    )
    return transformed(drum, onto_side)


_CLEAR = 0.5  # Room around each thing [m]


@dataclass(frozen=True, slots=True)
class _Rule:
    """Spacing of one kind of furniture along a kerb."""

    beyond_kerb: float  # Distance from the kerb to its centre [m]
    every: float  # Mean distance to the next [m]
    room: float  # Radius of the space that it needs [m]
    from_end: float  # Least distance to the end of the street [m]


# order: bytes of plans depend on it, since all rules draw from one stream in turn
_RULES = {
    "shelter": _Rule(1.75, 190.0, 2.4, 24.0),
    "bench": _Rule(2.05, 42.0, 1.1, 9.0),
    "tub": _Rule(2.0, 60.0, 0.8, 9.0),
    "post_box": _Rule(0.75, 170.0, 0.5, 8.0),
    "bin": _Rule(0.65, 55.0, 0.4, 6.0),
    "hydrant": _Rule(0.6, 85.0, 0.4, 6.0),
}
"""The kinds of furniture, the largest first, because small ones find room more easily."""


def furniture_along(
    network: RoadNetwork,
    pavement: shapely.Geometry,  # Area where furniture may stand [m]
    keep_free: shapely.Geometry,  # Area where something else stands, people walk or cars drive [m]
    height: float,  # z of the pavement [m]
    rng: np.random.Generator,
) -> list[Placed]:
    """Return what furnishes the pavements beside kerbs."""
    room = shapely.difference(pavement, shapely.buffer(keep_free, _CLEAR))
    shapely.prepare(room)
    taken, made = np.zeros((0, 3)), []
    for kind, rule in _RULES.items():
        for place, turn in _places(network, rule, rng):
            apart = np.linalg.norm(taken[:, :2] - place, axis=1) - taken[:, 2]
            # Legs may reach over the back edge of the pavement, on to the lawn.
            if apart.min(initial=np.inf) > rule.room and shapely.contains_xy(room, *place):
                taken = np.concatenate([taken, [[*place, rule.room + _CLEAR]]])
                made.append(Placed(kind, float(place[0]), float(place[1]), height, turn))
    return made


def _places(
    network: RoadNetwork, rule: _Rule, rng: np.random.Generator
) -> list[tuple[NDArray[np.float64], float]]:
    """Return positions beside all kerbs [m], and angles that make y face the road [rad]."""
    made = []
    for street in streets(network):
        kerb = shapely.LineString(street.right)
        low, high = rule.from_end, kerb.length - rule.from_end
        count = rng.poisson(max(high - low, 0.0) / rule.every)
        for along in np.sort(rng.uniform(low, max(high, low), count)):
            here, there = (
                shapely.get_coordinates(kerb.interpolate(s))[0] for s in (along, along + 0.1)
            )
            onwards = unit(there - here)
            inwards = street.inwards(onwards)
            turn = float(exact.atan2(inwards[1], inwards[0]) - np.pi / 2)
            made.append((here - rule.beyond_kerb * inwards, turn))
    return made

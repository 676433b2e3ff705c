"""Street lamps: a dark pole beyond the kerb, and an arm with the light over the road."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.solids import box, tube
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.roads.areas import streets
from eyas.lanes import exact
from eyas.maps.build.apart import SpacedPoints

POLE_HEIGHT = 7.35  # Height of the poles, as in the original [m]

POLE_RADIUS = 0.12  # Radius at the foot [m]

BEYOND_KERB = 2.0  # Distance from the kerb to the poles; the median of the original [m]

LIGHT = (3.1, 0.0, 7.2)
"""Position of the light relative to the foot of its pole, as in the original [m]."""


_APART = (53.0, 44.0, 35.0)
"""Least distances from one lamp to the next [m]; the original's median is 58.

The smaller ones are for cities in which the first leaves room for too few lamps.
"""
_STEP = 3.0  # Distance between the candidate positions along a kerb [m]
_FROM_CROSSING = 7.0  # Least distance from the end of a street [m]
_CLEAR = 1.2  # Room around a pole [m]
_STEEL = material("plain", (0.20, 0.21, 0.22))
_LENS = Material(tint=(1.0, 0.90, 0.72), surface=Surface.LAMP, emission=6.0)


def lamps_along(
    network: RoadNetwork,
    count: int,  # Number of lamps, if there is room
    keep_free: shapely.Geometry,  # Area where no pole may stand
    rng: np.random.Generator,
) -> list[Placed]:
    """Return street lamps on both sides of the roads, their arms over the road."""
    feet, turns = _candidates(network)
    blocked = shapely.buffer(keep_free, _CLEAR)
    shapely.prepare(blocked)
    free = ~shapely.intersects(blocked, shapely.points(feet))
    order = rng.permutation(np.flatnonzero(free))
    chosen: list[int] = []
    for least in _APART:
        near = SpacedPoints(least)
        for index in chosen:
            near.add(*feet[index].tolist())
        for index in order.tolist():
            if len(chosen) >= count:
                break
            if near.add(*feet[index].tolist()):
                chosen.append(index)
    return [
        Placed.at("street lamp", feet[index], 0.0, float(turns[index])) for index in sorted(chosen)
    ]


def lit_by(lamps: Sequence[Placed]) -> NDArray[np.float64]:
    """Return the places below the lights of lamps [m], shape (K, 2), as exact as a scene's."""
    feet = np.array([lamp[1:3] for lamp in lamps], np.float64).reshape(-1, 2)
    turn = np.array([lamp.turn for lamp in lamps], np.float64)
    along = np.stack([exact.cos(turn), exact.sin(turn)], axis=1)
    return (feet + LIGHT[0] * along).astype(np.float32).astype(np.float64)


def _candidates(network: RoadNetwork) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return positions beside kerbs [m], shape (K, 2), and directions to the road, shape (K,)."""
    feet, turns = [np.zeros((0, 2))], [np.zeros(0)]
    for street in streets(network):
        kerb = shapely.LineString(street.right)
        along = np.arange(_FROM_CROSSING, kerb.length - _FROM_CROSSING, _STEP)
        here = shapely.get_coordinates(shapely.line_interpolate_point(kerb, along))
        there = shapely.get_coordinates(shapely.line_interpolate_point(kerb, along + 0.1))
        onwards = (there - here) / 0.1
        inwards = street.inwards(onwards.T).T
        feet.append(here - BEYOND_KERB * inwards)
        turns.append(exact.atan2(inwards[:, 1], inwards[:, 0]))
    return np.concatenate(feet), np.concatenate(turns)


def lamp_levels() -> tuple[Mesh, ...]:
    """Return a street lamp, the finest level of detail first.

    The foot is at the origin, the arm along x.
    """
    return tuple(_lamp(sides, bends) for sides, bends in ((8, 5), (4, 3), (3, 2)))


def _lamp(sides: int, bends: int) -> Mesh:
    x, _, z = LIGHT
    pole = np.array([[0, 0, -0.15], [0, 0, 3.5], [0, 0, POLE_HEIGHT - 0.55]])
    # The arm rises from the pole and ends level: a quarter of an ellipse.
    angle = np.linspace(0.0, np.pi / 2, bends)
    top = POLE_HEIGHT - 0.6
    arm = np.stack(
        [(x - 0.3) * (1 - exact.cos(angle)), 0 * angle, top + 0.5 * exact.sin(angle)], axis=1
    )
    return concatenate(
        [
            tube(pole, [POLE_RADIUS, 0.09, 0.07], sides, _STEEL),
            tube(arm, [0.05] * bends, sides, _STEEL),
            box((0.85, 0.28, 0.12), (x, 0.0, z + 0.06), _STEEL, 1.0),
            box((0.62, 0.20, 0.03), (x, 0.0, z - 0.01), _LENS, 1.0),
        ]
    )
